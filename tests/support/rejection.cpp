// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/rejection.h"

#include <gtest/gtest.h>

#include <fstream>

namespace stillpoint {

void expect_rejected(const ProgramResult& result, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.exit_code, 2);
  const std::size_t error = result.err.find("stillpoint: error: ");
  ASSERT_NE(error, std::string::npos) << result.err;
  const std::string line = result.err.substr(error);
  EXPECT_EQ(line.find('\n'), line.size() - 1) << "more than one line: " << line;
  for (const std::string& part : parts)
    EXPECT_NE(line.find(part), std::string::npos) << part << " / " << line;
}

void expect_rejected(const ProgramResult& result, const std::filesystem::path& out,
                     const std::vector<std::string>& parts) {
  expect_rejected(result, parts);
  EXPECT_FALSE(std::filesystem::exists(out)) << out;
}

void replace_file(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::remove(file);
  std::ofstream(file) << text;
}

}  // namespace stillpoint
