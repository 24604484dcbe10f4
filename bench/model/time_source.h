// SPDX-License-Identifier: BSD-3-Clause
/// How far the times of a run are its own: a run that shares the machine lends its times to nothing but
/// hints.
#pragma once

#include <string>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// The best first.
enum class TimeSource {
  kUndisturbed,  ///< timing run on an idle machine
  kBusy,         ///< timing run while other processes used the machine, see the metric "quiet"
  kShared,       ///< no timing run: other runs may have executed at the same time
};

[[nodiscard]] TimeSource time_source(const StoredRun& run);

/// Restriction of times from this source and its remedy, as a footnote; empty for undisturbed times.
[[nodiscard]] std::string time_source_note(TimeSource source);

}  // namespace stillpoint::bench
