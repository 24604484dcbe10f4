// SPDX-License-Identifier: BSD-3-Clause
/// The TOML files of bench/configs and bench/plans, carried inside the program so that it works anywhere.
#pragma once

#include <span>
#include <string_view>

namespace stillpoint {

struct EmbeddedFile {
  std::string_view path;  ///< from the root of the sources, e.g. "bench/configs/vo.toml"
  std::string_view text;
};

/// In order of their paths.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files();

}  // namespace stillpoint
