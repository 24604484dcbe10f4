// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/text_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

/// Calls `visit` with the only row of `text`.
template <class Visit>
void with_row(const std::string& text, const Visit& visit) {
  RowReader rows(text, "a.txt");
  const std::optional<TextRow> row = rows.next();
  ASSERT_TRUE(row.has_value());
  visit(*row);
}

TEST(RowReader, SkipsCommentsAndBlankLinesButCountsThem) {
  RowReader rows("# header\n\n 1, 2\t3 \r\n#4\n5", "a.txt");
  const std::optional<TextRow> first = rows.next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->line, 3);
  EXPECT_EQ(first->content, " 1, 2\t3 ");
  EXPECT_EQ(std::vector<std::string_view>(first->fields.begin(), first->fields.end()),
            (std::vector<std::string_view>{"1", "2", "3"}));
  EXPECT_EQ(rows.next()->line, 5);
  EXPECT_FALSE(rows.next().has_value());
}

TEST(RowReader, KeepsAnEmptyFieldInItsPlace) {
  for (const std::string line : {"1,,3,", "1;;3;", "1 , , 3", "1,\t,3\r"}) {
    with_row(line + "\n", [](const TextRow& row) {
      ASSERT_EQ(row.fields.size(), 3U) << row.content;
      EXPECT_EQ(row.number(2), 3.0);
      expect_input_error([&] { static_cast<void>(row.number(1)); }, {"a.txt:1", "field 2 is empty"});
      expect_input_error([&] { static_cast<void>(row.time(1, TimeUnit::kSeconds)); }, {"field 2 is empty"});
    });
  }
  with_row(",2,3\n", [](const TextRow& row) {
    ASSERT_EQ(row.fields.size(), 3U);
    EXPECT_EQ(row.number(1), 2.0);
  });
}

TEST(TextRow, NamesDecimalCommas) {
  for (const std::string line :
       {"1,5 0,1 0,2 3", "1,5;0,1;0,2;3", "1403636579763555584;0,1;-0,2", "0,500000", "1,305031e+09",
        "1.5;2,66;-0,09", "1700000000,05 rgb/1700000000.05.png", "1,5 a,b.png"}) {
    with_row(line + "\n", [](const TextRow& row) {
      expect_input_error([&] { static_cast<void>(row.time(0, TimeUnit::kSeconds)); },
                         {"a.txt:1", "decimal commas"});
    });
  }
  for (const std::string line :
       {"1,5,0,1", "1,5 ,0 ,1", "1, 5,0, 1", "1,5.png", "1,rgb/5.png", "1,2.5 3,4"}) {
    with_row(line + "\n", [](const TextRow& row) {  // commas between fields
      EXPECT_EQ(row.time(0, TimeUnit::kSeconds), Timestamp{1'000'000'000}) << row.content;
    });
  }
}

TEST(TextRow, NanosecondsMayHaveDecimalsThatAreZero) {
  with_row("1403636579763555584.000000 10.5\n", [](const TextRow& row) {
    EXPECT_EQ(row.time(0, TimeUnit::kNanoseconds), Timestamp{1403636579763555584});
    expect_input_error([&] { static_cast<void>(row.time(1, TimeUnit::kNanoseconds)); }, {"is the file in"});
  });
}

TEST(TextRow, ErrorsNameFileAndLine) {
  with_row("1 x\n", [](const TextRow& row) {
    expect_input_error([&] { static_cast<void>(row.number(1)); }, {"a.txt:1", "\"x\" is not a number"});
    expect_input_error([&] { static_cast<void>(row.number(2)); },
                       {"a.txt:1", "2 field(s), expected at least 3"});
  });
  with_row("#\n2 nan -inf\n", [](const TextRow& row) {
    EXPECT_TRUE(std::isnan(row.number(1)));
    expect_input_error([&] { static_cast<void>(row.finite_number(1)); },
                       {"a.txt:2", "\"nan\" is not finite"});
    expect_input_error([&] { static_cast<void>(row.finite_number(2)); },
                       {"a.txt:2", "\"-inf\" is not finite"});
  });
}

TEST(TextRow, TimesInTheWrongUnitAreErrorsWithAHint) {
  with_row("1403636579763555584 1.5\n", [](const TextRow& row) {
    EXPECT_EQ(row.time(0, TimeUnit::kNanoseconds), Timestamp{1403636579763555584});
    EXPECT_EQ(row.time(1, TimeUnit::kSeconds), Timestamp{1'500'000'000});
    expect_input_error([&] { static_cast<void>(row.time(0, TimeUnit::kSeconds)); },
                       {"a.txt:1", "is it in nanoseconds? convert it to seconds"});
    expect_input_error([&] { static_cast<void>(row.time(1, TimeUnit::kNanoseconds)); },
                       {"a.txt:1", "is the file in seconds"});
  });
}

TEST(TextRow, TheUnitOfALargeStampFollowsFromItsSize) {
  for (const auto& [stamp, unit] : {std::pair("9250000000", "nano"),
                                    {"1700000000000", "milli"},
                                    {"20000000000000", "nano"},
                                    {"1700000000000000", "micro"},
                                    {"20000000000000000", "nano"},
                                    {"1700000000000000000", "nano"}}) {
    with_row(std::string(stamp) + "\n", [unit = unit](const TextRow& row) {
      expect_input_error([&] { static_cast<void>(row.time(0, TimeUnit::kSeconds)); },
                         {std::string("is it in ") + unit + "seconds"});
    });
  }
}

TEST(TextRow, DistinguishesRepeatedFromDecreasingTimestamps) {
  with_row("2\n", [](const TextRow& row) {
    expect_input_error([&] { row.require_increasing(Timestamp{5}, Timestamp{5}); }, {"a.txt:1", "repeats"});
    expect_input_error([&] { row.require_increasing(Timestamp{2'000'000'000}, Timestamp{1'500'000'000}); },
                       {"a.txt:1", "stamp 1.500000000 s", "0.500000 s earlier", "sort the file"});
    EXPECT_NO_THROW(row.require_increasing(Timestamp{5}, Timestamp{6}));
  });
}

TEST(ForEachRow, ACollectingLogRecordsTheFaultOfEachRow) {
  FaultLog faults(FaultLog::Mode::kCollect);
  double sum = 0.0;
  for_each_row("1\nx\n3\ny\n", "a.txt", faults, [&](const TextRow& row) { sum += row.number(0); });
  EXPECT_EQ(sum, 4.0);
  EXPECT_EQ(faults.messages(),
            (std::vector<std::string>{"a.txt:2: \"x\" is not a number", "a.txt:4: \"y\" is not a number"}));
}

TEST(ReadTextFile, AMissingFileIsAnError) {
  expect_input_error([] { static_cast<void>(read_text_file("/nonexistent/a.txt")); },
                     {"/nonexistent/a.txt", "cannot be opened"});
}

}  // namespace
}  // namespace stillpoint::eval
