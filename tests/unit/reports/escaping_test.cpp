// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/text_format.h"

#include <gtest/gtest.h>

namespace stillpoint::report {
namespace {

TEST(Escaping, RemovesMarkupFromHtml) {
  EXPECT_EQ(escape_html("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
}

TEST(Escaping, RemovesCommandsFromLatex) {
  EXPECT_EQ(escape_latex("a_b\\c{d}$50%#&~^"),
            "a\\_b\\textbackslash{}c\\{d\\}\\$50\\%\\#\\&\\textasciitilde{}\\textasciicircum{}");
}

TEST(Escaping, WritesCharactersMissingInLatexFontsAsCodePoints) {
  EXPECT_EQ(escape_latex("\xC3\xBC"), "\xC3\xBC");                   // u umlaut: available in every font
  EXPECT_EQ(escape_latex("\xF0\x9F\x98\x80"), "\\texttt{U+1F600}");  // an emoji
  EXPECT_EQ(escape_latex("\xC3\xB0"), "\\texttt{U+00F0}");           // eth: missing in the default font
}

TEST(Escaping, KeepsMarkdownTablesIntact) {
  EXPECT_EQ(escape_markdown("a|b\n*c*<d>"), "a\\|b \\*c\\*\\<d\\>");
}

TEST(Escaping, BarsOfNamesDoNotEndCellsOfMarkdown) {
  EXPECT_EQ(
      format_table({{"name", "n"}, {"a|b", "1"}, {escape_markdown("c|d|"), "||"}}, TableStyle::kMarkdown),
      "| name   | n |\n|--------|------|\n| a\\|b   | 1 |\n| c\\|d\\| | \\|\\| |\n");
  EXPECT_EQ(format_table({{"a|b", "n"}}, TableStyle::kText), "a|b  n\n");
}

TEST(Escaping, QuotesCsvFieldsAndNeutralizesFormulas) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("=1+1"), "\"'=1+1\"");
}

TEST(Escaping, NeutralizesFormulasInTablesButKeepsSignsOfNumbers) {
  EXPECT_EQ(format_table({{"=cmd|'/C calc'!A0", "-1+1", "@a"}, {"-0.5", "+2.0", "n/a"}}, TableStyle::kCsv),
            "\"'=cmd|'/C calc'!A0\",\"'-1+1\",\"'@a\"\n-0.5,+2.0,n/a\n");
}

TEST(Escaping, ReplacesInvalidUtf8) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(clean_line("a\xFF"), "a" + replacement);
  EXPECT_EQ(clean_line("\xC0\x80"), replacement + replacement);                    // overlong encoding of NUL
  EXPECT_EQ(clean_line("\xED\xA0\x80"), replacement + replacement + replacement);  // half a surrogate pair
  EXPECT_EQ(clean_line("\xE2\x82"), replacement + replacement);                    // truncated
  EXPECT_EQ(clean_line(std::string("a\0b\x7F", 4)), "a b ");
}

TEST(Escaping, JsonCannotCloseAScriptElement) {
  EXPECT_EQ(json_for_script("{\"a\":\"</script><!--\"}"), "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

}  // namespace
}  // namespace stillpoint::report
