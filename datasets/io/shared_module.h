// SPDX-License-Identifier: BSD-3-Clause
/// Shared libraries of this project that are loaded at their first use: OpenImageIO and OpenCV's video
/// encoders load more than 200 libraries each, which takes 0.2 s, and most commands use neither.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint::datasets {

/// Paths of a module, the most specific first: `lib` beside the program or beside its folder, as in a build
/// folder and an installation; then the bare name, which the loader searches in the run path of the program,
/// LD_LIBRARY_PATH and the folders of the system.
/// @param program absolute path of the running program
[[nodiscard]] std::vector<std::string> module_paths(const std::filesystem::path& program,
                                                    const std::string& name);

/// Loads a module for the lifetime of the process. Thread-safe.
/// @param name   "imageio" for libstillpoint_imageio.so
/// @param symbol a variable of the module with C linkage
/// @return its address
/// @throws InputError if the module or a library that it requires is not installed
[[nodiscard]] const void* module_symbol(const std::string& name, const std::string& symbol);

}  // namespace stillpoint::datasets
