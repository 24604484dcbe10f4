// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/series_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

namespace stillpoint::report {
namespace {

constexpr std::uint16_t kNoValue = 0xFFFF;
constexpr double kSteps = 65534.0;

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kAlphabet[group >> (18 - 6 * k) & 0x3F] : '=';
  }
  return text;
}

nlohmann::ordered_json packed_series(std::span<const double> values) {
  double low = 0.0;
  double high = 0.0;
  bool is_first = true;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = is_first ? value : std::min(low, value);
    high = is_first ? value : std::max(high, value);
    is_first = false;
  }
  const double step = high > low ? (high - low) / kSteps : 1.0;
  std::vector<unsigned char> bytes;
  for (const double value : values) {
    const auto number =
        std::isfinite(value) ? static_cast<std::uint16_t>(std::lround((value - low) / step)) : kNoValue;
    bytes.push_back(static_cast<unsigned char>(number & 0xFF));
    bytes.push_back(static_cast<unsigned char>(number >> 8));
  }
  return {{"low", low}, {"step", step}, {"data", base64(bytes)}};
}

}  // namespace stillpoint::report
