// SPDX-License-Identifier: BSD-3-Clause
/// Current time as recorded in stores and manifests.
#pragma once

#include <string>

namespace stillpoint::bench {

/// Current time, UTC, ISO 8601, e.g. "2025-01-31T12:00:00Z".
[[nodiscard]] std::string utc_now();

}  // namespace stillpoint::bench
