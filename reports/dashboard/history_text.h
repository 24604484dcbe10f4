// SPDX-License-Identifier: BSD-3-Clause
/// How a history of commits is put into words.
#pragma once

#include <string>

#include "bench/compare/history_changes.h"

namespace stillpoint {

/// A commit as short as readers know it: ten digits of its hash, and what follows a "+"; at most 24 letters.
[[nodiscard]] std::string commit_label(const std::string& name);

/// "vo on office", and what else sets it apart: point of a sweep, seed, mode, kind, cores.
[[nodiscard]] std::string subject_label(const HistorySubject& subject);

/// "+5.2 %", or "new" where there was nothing before.
[[nodiscard]] std::string change_label(const LevelShift& shift);

/// "+4.1 to +6.0 %", the 95 % interval; empty if there is none.
[[nodiscard]] std::string interval_label(const LevelShift& shift);

/// Four digits and the unit.
[[nodiscard]] std::string number_label(double value, const std::string& unit);

}  // namespace stillpoint
