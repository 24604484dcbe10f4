// SPDX-License-Identifier: BSD-3-Clause
/// Labels of commits, subjects and changes.
#pragma once

#include <string>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// Short commit name: ten digits of the hash, plus a suffix that starts with "+"; at most 24 characters.
[[nodiscard]] std::string commit_label(const std::string& name);

/// "vo on office", followed by non-default sweep point, seed, mode, kind and cores.
[[nodiscard]] std::string subject_label(const bench::HistorySubject& subject);

/// "+5.2 %", or "new" if there is no earlier level.
[[nodiscard]] std::string change_label(const bench::LevelShift& shift);

/// "n = 8, +4.1 to +6.0 %", the 95 % interval, or "n = 3, no interval"; n: commits of the shorter level.
/// Empty without a relative change.
[[nodiscard]] std::string interval_label(const bench::LevelShift& shift);

/// Four significant digits and the unit.
[[nodiscard]] std::string value_label(double value, const std::string& unit);

}  // namespace stillpoint::report
