// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/segments.h"

#include <array>

#include "eval/metrics/relative_error.h"

namespace stillpoint::eval {
namespace {

constexpr std::array<double, 5> kPathFractions{0.1, 0.2, 0.3, 0.4, 0.5};

std::vector<double> lengths_for(std::span<const double> path_m, const SegmentOptions& options) {
  if (!options.lengths_m.empty() || path_m.empty() || path_m.back() <= 0.0) return options.lengths_m;
  std::vector<double> lengths;
  for (const double fraction : kPathFractions) lengths.push_back(fraction * path_m.back());
  return lengths;
}

}  // namespace

std::vector<SegmentErrors> segment_errors(std::span<const MatchedPose> matches,
                                          const SegmentOptions& options) {
  const std::vector<double> path_m = path_lengths(matches, PathOf::kGroundTruth);
  std::vector<SegmentErrors> segments;
  for (const double length_m : lengths_for(path_m, options)) {
    PosePairs found = pairs_over_meters(path_m, length_m, options.tolerance * length_m);
    if (found.pairs.empty()) continue;
    if (options.shift_starts) {
      for (std::size_t k = 0; k < found.pairs.size(); ++k) found.pairs[k].from = k;
    }
    const RelativeErrors errors = relative_errors(matches, found.pairs);
    segments.push_back({.length_m = length_m,
                        .translation_m = *statistics(errors.translation_m),
                        .rotation_deg = *statistics(errors.rotation_deg),
                        .yaw_deg = *statistics(errors.yaw_deg),
                        .translation_lower_quartile_m = *percentile(errors.translation_m, 0.25),
                        .translation_upper_quartile_m = *percentile(errors.translation_m, 0.75),
                        .dropped = found.dropped});
  }
  return segments;
}

std::optional<double> drift_percent(std::span<const SegmentErrors> segments) {
  double sum = 0.0;
  double count = 0.0;
  for (const SegmentErrors& segment : segments) {
    const double segment_count = static_cast<double>(segment.translation_m.count);
    sum += segment_count * segment.translation_m.mean / segment.length_m;
    count += segment_count;
  }
  if (count == 0.0) return std::nullopt;
  return 100.0 * sum / count;
}

}  // namespace stillpoint::eval
