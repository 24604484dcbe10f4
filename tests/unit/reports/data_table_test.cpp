// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/data_table.h"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace stillpoint::report {
namespace {

DataTable one_row(DataRow row) {
  DataTable table{.kind = "example", .columns = {}, .rows = {row}, .notes = {"a \"note\""}, .version = 3};
  for (std::size_t i = 0; i < row.size(); ++i) table.columns.push_back("c" + std::to_string(i));
  return table;
}

TEST(DataTable, NumbersHaveAllDigits) {
  const DataTable table = one_row({0.1 + 0.2, std::int64_t{9007199254740993}});
  EXPECT_EQ(data_csv(table), "c0,c1\n0.30000000000000004,9007199254740993\n");
  const nlohmann::json row = nlohmann::json::parse(data_json(table)).at("rows").at(0);
  EXPECT_EQ(row.at("c0").get<double>(), 0.1 + 0.2);
  EXPECT_EQ(row.at("c1").get<std::int64_t>(), 9007199254740993);
}

TEST(DataTable, MissingValuesAreEmptyOrNull) {
  const DataTable table = one_row({{}, data_value(std::string()), data_value(std::optional<double>())});
  EXPECT_EQ(data_csv(table), "c0,c1,c2\n,,\n");
  const nlohmann::json row = nlohmann::json::parse(data_json(table)).at("rows").at(0);
  ASSERT_EQ(row.size(), 3U);
  for (const nlohmann::json& value : row) EXPECT_TRUE(value.is_null());
}

/// JSON has no such numbers.
TEST(DataTable, NumbersThatAreNotFiniteAreNullInJson) {
  const double infinity = std::numeric_limits<double>::infinity();
  const DataTable table = one_row({-infinity, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(data_csv(table), "c0,c1\n-inf,nan\n");
  const nlohmann::json row = nlohmann::json::parse(data_json(table)).at("rows").at(0);
  EXPECT_TRUE(row.at("c0").is_null() && row.at("c1").is_null());
}

TEST(DataTable, TextsAreQuotedInCsvAndValidInJson) {
  const DataTable table = one_row({"a,\"b\"\n\xFF", true});
  EXPECT_EQ(data_csv(table), "c0,c1\n\"a,\"\"b\"\" \xEF\xBF\xBD\",true\n");
  const nlohmann::json document = nlohmann::json::parse(data_json(table));
  EXPECT_EQ(document.at("rows").at(0).at("c0"), "a,\"b\" \xEF\xBF\xBD");
  EXPECT_EQ(document.at("rows").at(0).at("c1"), true);
  EXPECT_EQ(document.at("kind"), "example");
  EXPECT_EQ(document.at("schema"), 3);
  EXPECT_EQ(document.at("notes").at(0), "a \"note\"");
}

}  // namespace
}  // namespace stillpoint::report
