// SPDX-License-Identifier: BSD-3-Clause
/// The page that shows the runs of a store while a bench executes them, and the messages that it receives.
#pragma once

#include <cstddef>
#include <string>

#include "bench/store/store_progress.h"

namespace stillpoint::report {

/// HTML of the page.
/// @param store  name of the store
/// @param events address of the stream of `progress_json` messages (server-sent events)
[[nodiscard]] std::string live_html(const std::string& store, const std::string& events);

/// The state of a store as one line of JSON.
/// @param rendered number of runs that the report and the dashboard beside the page contain; 0: there are
/// none
[[nodiscard]] std::string progress_json(const bench::StoreProgress& progress, std::size_t rendered);

}  // namespace stillpoint::report
