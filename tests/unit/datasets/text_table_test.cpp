// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/text_table.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

TEST(ParseSeconds, IsExactToTheNanosecondForUnixTimestamps) {
  // As a double, 1560000000.123456789 would be off by up to 120 ns.
  EXPECT_EQ(parse_seconds("1560000000.123456789"), Timestamp{1'560'000'000'123'456'789});
  EXPECT_EQ(parse_seconds("1700000000.00130010"), Timestamp{1'700'000'000'001'300'100});
}

TEST(ParseSeconds, AcceptsAllDecimalNotations) {
  EXPECT_EQ(parse_seconds("7"), Timestamp{7'000'000'000});
  EXPECT_EQ(parse_seconds(".5"), Timestamp{500'000'000});
  EXPECT_EQ(parse_seconds("0.000000001"), Timestamp{1});
  EXPECT_EQ(parse_seconds("-1.25"), Timestamp{-1'250'000'000});
  EXPECT_EQ(parse_seconds("1.305031102175304e+09"), Timestamp{1'305'031'102'175'304'000});
  EXPECT_EQ(parse_seconds("25e-1"), Timestamp{2'500'000'000});
  EXPECT_EQ(parse_seconds("0"), Timestamp{0});
}

TEST(ParseSeconds, RoundsBelowTheNanosecond) {
  EXPECT_EQ(parse_seconds("1.0000000004"), Timestamp{1'000'000'000});
  EXPECT_EQ(parse_seconds("1.0000000005"), Timestamp{1'000'000'001});
  EXPECT_EQ(parse_seconds("0.0000000006"), Timestamp{1});
}

TEST(ParseSeconds, RejectsInvalidTimes) {
  for (const char* const text :
       {"", "-", ".", "abc", "1.2.3", "1e", "1 2", "nan", "inf", "9300000000", "1e99"}) {
    EXPECT_FALSE(parse_seconds(text).has_value()) << text;
  }
}

TEST(TextTable, SkipsCommentsAndBlankLinesButCountsThem) {
  const TemporaryFolder folder;
  const TextTable table(folder.write("a.txt", "# header\n\n 1, 2\t3 \r\n#4\n5"));
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(table.rows()[0].line, 3);
  EXPECT_EQ(table.rows()[0].fields, (std::vector<std::string>{"1", "2", "3"}));
  EXPECT_EQ(table.rows()[1].line, 5);
}

TEST(TextTable, ErrorsNameFileAndLine) {
  const TemporaryFolder folder;
  const TextTable table(folder.write("a.txt", "1 x\n2 nan\n3 inf\n"));
  const auto number = [&](std::size_t row, std::size_t field) {
    return [&table, row, field] { static_cast<void>(table.number(table.rows()[row], field)); };
  };
  expect_input_error(number(0, 1), {"a.txt:1", "\"x\" is not a number"});
  expect_input_error(number(1, 1), {"a.txt:2", "\"nan\" is not finite"});
  expect_input_error(number(2, 1), {"a.txt:3", "\"inf\" is not finite"});
  expect_input_error(number(2, 2), {"a.txt:3", "2 field(s), expected at least 3"});
}

TEST(TextTable, DistinguishesRepeatedFromDecreasingTimestamps) {
  const TemporaryFolder folder;
  const TextTable table(folder.write("a.txt", "2\n1\n"));
  const TextRow& row = table.rows()[1];
  expect_input_error([&] { table.require_increasing(row, Timestamp{5}, Timestamp{5}); },
                     {"a.txt:2", "repeats"});
  expect_input_error(
      [&] { table.require_increasing(row, Timestamp{2'000'000'000}, Timestamp{1'500'000'000}); },
      {"a.txt:2", "0.500000 s earlier"});
  EXPECT_NO_THROW(table.require_increasing(row, Timestamp{5}, Timestamp{6}));
}

TEST(TextTable, AMissingFileIsAnError) {
  expect_input_error([] { const TextTable table("/nonexistent/a.txt"); },
                     {"/nonexistent/a.txt", "cannot be opened"});
}

}  // namespace
}  // namespace stillpoint::datasets
