// SPDX-License-Identifier: BSD-3-Clause
/// Files of the sources, carried inside the program so that it works anywhere.
#pragma once

#include <span>
#include <string_view>

namespace stillpoint {

struct EmbeddedFile {
  std::string_view path;  ///< from the root of the sources, e.g. "bench/configs/vo.toml"
  std::string_view text;
};

/// The TOML files of configs, plans, systems and published tables, in order of their paths.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files();

/// The files of reports/web; defined in the library of the reports.
[[nodiscard]] std::span<const EmbeddedFile> web_files();

}  // namespace stillpoint
