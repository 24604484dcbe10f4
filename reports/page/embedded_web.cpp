// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/embedded_web.h"

#include "bench/config/embedded_files.h"
#include "core/base/error.h"

namespace stillpoint::report {

std::string_view web_file(std::string_view name) {
  constexpr std::string_view kRoot = "reports/web/";
  for (const bench::EmbeddedFile& file : bench::web_files()) {
    if (file.path.substr(kRoot.size()) == name) return file.text;
  }
  STILLPOINT_CHECK(!"every requested file is listed in reports/CMakeLists.txt");
  return {};
}

}  // namespace stillpoint::report
