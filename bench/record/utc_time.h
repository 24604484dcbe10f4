// SPDX-License-Identifier: BSD-3-Clause
/// The present moment as records have it.
#pragma once

#include <string>

namespace stillpoint {

/// Now: UTC, ISO 8601, e.g. "2025-01-31T12:00:00Z".
[[nodiscard]] std::string utc_now();

}  // namespace stillpoint
