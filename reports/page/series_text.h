// SPDX-License-Identifier: BSD-3-Clause
/// Compact text encoding of time series for embedding in a page.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint::report {

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::span<const unsigned char> bytes);

/// {"low", "step", "data"}: value = low + step * (16-bit little-endian number), 65535 = missing. The
/// quantization error is at most 1/131068 of the range.
[[nodiscard]] nlohmann::ordered_json packed_series(std::span<const double> values);

}  // namespace stillpoint::report
