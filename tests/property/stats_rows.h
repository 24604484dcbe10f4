// SPDX-License-Identifier: BSD-3-Clause
/// Reads the CSV output of `stillpoint stats`.
#pragma once

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace stillpoint::bench {

/// Cells of a line of CSV; quotes are removed.
inline std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char letter : line) {
    if (letter == '"') {
      is_quoted = !is_quoted;
    } else if (letter == ',' && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += letter;
    }
  }
  return cells;
}

/// Rows of `stillpoint stats COMMAND --format csv` by column name.
inline std::vector<std::map<std::string, std::string>> stats_rows(const std::string& command,
                                                                  const std::filesystem::path& file) {
  const ProgramResult result = run_program({"stats", command, "--format", "csv", "--store", file.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream lines(result.out);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = csv_cells(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[names[i]] = cells.at(i);
    }
  }
  EXPECT_FALSE(rows.empty()) << result.out;
  return rows;
}

}  // namespace stillpoint::bench
