// SPDX-License-Identifier: BSD-3-Clause
/// What a refusal looks like, and how files are spoiled to provoke one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace stillpoint {

/// Expects one error line that contains all of `parts`, and exit code 2.
void expect_refused(const ProgramResult& result, const std::vector<std::string>& parts);

/// And no folder of results.
void expect_refused(const ProgramResult& result, const std::filesystem::path& out,
                    const std::vector<std::string>& parts);

/// A new file in the place of the old one, of which there may be hard links.
void replace_file(const std::filesystem::path& file, const std::string& text);

}  // namespace stillpoint
