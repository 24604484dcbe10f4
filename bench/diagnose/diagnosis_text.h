// SPDX-License-Identifier: BSD-3-Clause
/// A diagnosis as text of at most 15 lines, and as JSON.
#pragma once

#include <string>

#include "bench/diagnose/diagnosis.h"

namespace stillpoint::bench {

/// Whether the effect of a cause is unknown.
[[nodiscard]] bool has_unmeasured(const Diagnosis& diagnosis);

/// Ends with a line break.
[[nodiscard]] std::string diagnosis_text(const Diagnosis& diagnosis);

/// The same and all candidates, with full precision.
[[nodiscard]] std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace stillpoint::bench
