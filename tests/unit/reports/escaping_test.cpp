// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/escaping.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

TEST(Escaping, LeavesNoMarkupInHtml) {
  EXPECT_EQ(escape_html("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
}

TEST(Escaping, LeavesNoCommandInLatex) {
  EXPECT_EQ(escape_latex("a_b\\c{d}$50%#&~^"),
            "a\\_b\\textbackslash{}c\\{d\\}\\$50\\%\\#\\&\\textasciitilde{}\\textasciicircum{}");
}

TEST(Escaping, SpellsLettersThatLatexFontsLackAsCodePoints) {
  EXPECT_EQ(escape_latex("\xC3\xBC"), "\xC3\xBC");                   // u with two dots: every font has it
  EXPECT_EQ(escape_latex("\xF0\x9F\x98\x80"), "\\texttt{U+1F600}");  // a face
  EXPECT_EQ(escape_latex("\xC3\xB0"), "\\texttt{U+00F0}");           // eth: the default font lacks it
}

TEST(Escaping, KeepsTablesOfMarkdownWhole) {
  EXPECT_EQ(escape_markdown("a|b\n*c*<d>"), "a\\|b \\*c\\*\\<d\\>");
}

TEST(Escaping, QuotesCsvFieldsAndDisarmsFormulas) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("=1+1"), "\"'=1+1\"");
}

TEST(Escaping, ReplacesWhatIsNoUtf8) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(clean_line("a\xFF"), "a" + replacement);
  EXPECT_EQ(clean_line("\xC0\x80"), replacement + replacement);                    // a NUL spelled too long
  EXPECT_EQ(clean_line("\xED\xA0\x80"), replacement + replacement + replacement);  // half a surrogate pair
  EXPECT_EQ(clean_line("\xE2\x82"), replacement + replacement);                    // cut off
  EXPECT_EQ(clean_line(std::string("a\0b\x7F", 4)), "a b ");
}

TEST(Escaping, LetsNoJsonEndAScript) {
  EXPECT_EQ(json_for_script("{\"a\":\"</script><!--\"}"), "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

}  // namespace
}  // namespace stillpoint
