// SPDX-License-Identifier: BSD-3-Clause
/// Source files embedded in the executable, so that it does not depend on installed data files.
#pragma once

#include <span>
#include <string_view>

namespace stillpoint::bench {

struct EmbeddedFile {
  std::string_view path;  ///< relative to the source root, e.g. "bench/configs/vo.toml"
  std::string_view text;
};

/// The TOML files of configs, plans, systems, devices, published tables and catalogues, sorted by path.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files();

/// The files of reports/web; defined in the reports library.
[[nodiscard]] std::span<const EmbeddedFile> web_files();

}  // namespace stillpoint::bench
