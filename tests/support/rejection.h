// SPDX-License-Identifier: BSD-3-Clause
/// Expectations for rejected input, and replacement of input files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace stillpoint {

/// Expects exit code 2 and one error line that contains all of `parts`.
void expect_rejected(const ProgramResult& result, const std::vector<std::string>& parts);

/// Expects in addition that the output folder was not created.
void expect_rejected(const ProgramResult& result, const std::filesystem::path& out,
                     const std::vector<std::string>& parts);

/// Replaces a file by a new one; does not write through hard links.
void replace_file(const std::filesystem::path& file, const std::string& text);

}  // namespace stillpoint
