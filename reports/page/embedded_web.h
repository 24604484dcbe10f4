// SPDX-License-Identifier: BSD-3-Clause
/// The files of reports/web, carried inside the program: template, styles, scripts, libraries and their
/// licences.
#pragma once

#include <string_view>

namespace stillpoint {

/// @param name below reports/web, e.g. "page.css"; a name that is not there is a fault of the program
[[nodiscard]] std::string_view web_file(std::string_view name);

}  // namespace stillpoint
