// SPDX-License-Identifier: BSD-3-Clause
/// Where files of the user are kept between runs, by environment variables.
#pragma once

#include <filesystem>

namespace stillpoint::datasets {

/// The value of an environment variable; empty if it is not set.
[[nodiscard]] std::filesystem::path variable_or_empty(const char* name);

/// The folder "stillpoint" in that of a variable of the XDG base directory specification, else below HOME;
/// empty if neither variable is set. Variables that are set to nothing count as not set.
/// @param xdg such as "XDG_CACHE_HOME"
/// @param below_home its default, such as ".cache"
[[nodiscard]] std::filesystem::path user_folder(const char* xdg, const std::filesystem::path& below_home);

}  // namespace stillpoint::datasets
