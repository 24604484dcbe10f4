// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/text_format.h"

#include <gtest/gtest.h>

namespace stillpoint::report {
namespace {

const TableRows kRows{{"name", "ATE"}, {"a, \"b\"", "0.5"}};

TEST(FormatTable, AlignsTheColumnsOfText) {
  EXPECT_EQ(format_table(kRows, TableStyle::kText), "name    ATE\na, \"b\"  0.5\n");
}

TEST(FormatTable, PutsARuleUnderTheHeaderOfMarkdown) {
  EXPECT_EQ(format_table(kRows, TableStyle::kMarkdown),
            "| name   | ATE |\n|--------|-----|\n| a, \"b\" | 0.5 |\n");
}

TEST(FormatTable, QuotesTheCellsOfCsvThatNeedIt) {
  EXPECT_EQ(format_table(kRows, TableStyle::kCsv), "name,ATE\n\"a, \"\"b\"\"\",0.5\n");
}

TEST(FormatTable, IsEmptyWithoutRows) { EXPECT_EQ(format_table({}, TableStyle::kText), ""); }

}  // namespace
}  // namespace stillpoint::report
