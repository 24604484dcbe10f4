// SPDX-License-Identifier: BSD-3-Clause
/// The files of reports/web embedded in the binary: templates, style sheets, scripts, libraries and licenses.
#pragma once

#include <string_view>

namespace stillpoint::report {

/// @param name relative to reports/web, e.g. "page.css"; must be listed in reports/CMakeLists.txt
[[nodiscard]] std::string_view web_file(std::string_view name);

}  // namespace stillpoint::report
