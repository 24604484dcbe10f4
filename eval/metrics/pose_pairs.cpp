// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/pose_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::eval {
namespace {

PosePair pair_of(std::size_t from, std::size_t to) {
  return {static_cast<PoseIndex>(from), static_cast<PoseIndex>(to)};
}

/// First index >= `begin` with the path length of `index`; several poses have it where the camera rests.
std::size_t first_with_length(std::span<const double> lengths_m, std::size_t begin, std::size_t index) {
  const auto first = lengths_m.begin();
  const auto last = first + static_cast<std::ptrdiff_t>(index);
  const auto found = std::lower_bound(first + static_cast<std::ptrdiff_t>(begin), last, lengths_m[index]);
  return static_cast<std::size_t>(found - first);
}

}  // namespace

std::vector<PosePair> pairs_over_frames(std::size_t poses, std::size_t step, bool every_start) {
  STILLPOINT_CHECK(step > 0);
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i + step < poses; i += every_start ? 1 : step)
    pairs.push_back(pair_of(i, i + step));
  return pairs;
}

PosePairs pairs_over_seconds(MatchView matches, double delta_s, double tolerance_s) {
  PosePairs result;
  result.pairs.reserve(matches.size());
  std::size_t j = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Timestamp target = after(matches.time(i), delta_s);
    const auto difference = [&](std::size_t k) { return std::abs(seconds_between(target, matches.time(k))); };
    j = std::max(j, i);
    while (j + 1 < matches.size() && difference(j + 1) < difference(j)) ++j;
    if (j > i && difference(j) <= tolerance_s) {
      result.pairs.push_back(pair_of(i, j));
    } else {
      ++result.dropped;
    }
  }
  return result;
}

std::vector<double> path_lengths(MatchView matches, PathOf of) {
  std::vector<double> lengths;
  lengths.reserve(matches.size());
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) {
    const Eigen::Vector3d& p = of == PathOf::kGroundTruth ? match.gt.p : match.est.p;
    lengths.push_back(lengths.empty() ? 0.0 : lengths.back() + (p - previous).norm());
    previous = p;
  }
  return lengths;
}

std::vector<double> path_angles_deg(MatchView matches) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::vector<double> angles;
  angles.reserve(matches.size());
  Eigen::Quaterniond previous = Eigen::Quaterniond::Identity();
  for (const MatchedPose& match : matches) {
    const double step = kDegrees * rotation_angle(previous.conjugate() * match.gt.q);
    angles.push_back(angles.empty() ? 0.0 : angles.back() + step);
    previous = match.gt.q;
  }
  return angles;
}

PosePairs pairs_over_meters(std::span<const double> lengths_m, double delta_m, double tolerance_m) {
  PosePairs result;
  result.pairs.reserve(lengths_m.size());
  std::size_t j = 0;
  for (std::size_t i = 0; i + 1 < lengths_m.size(); ++i) {
    const auto difference = [&](std::size_t k) { return std::abs(lengths_m[k] - lengths_m[i] - delta_m); };
    j = std::max(j, i + 1);
    // The closest is the first pose at or beyond the target length, or the last position before it.
    while (j + 1 < lengths_m.size() && lengths_m[j] - lengths_m[i] < delta_m) ++j;
    std::size_t best = j;
    if (lengths_m[j] - lengths_m[i] < delta_m) {
      best = first_with_length(lengths_m, i + 1, j);
    } else if (j > i + 1 && difference(j - 1) <= difference(j)) {
      best = first_with_length(lengths_m, i + 1, j - 1);
    }
    if (difference(best) <= tolerance_m) {
      result.pairs.push_back(pair_of(i, best));
    } else {
      ++result.dropped;
    }
  }
  return result;
}

double strict_tolerance_s(MatchView matches, double delta_s) {
  constexpr double kMaxDeltaFraction = 0.1;
  std::vector<double> intervals;
  intervals.reserve(matches.size());
  for (std::size_t i = 1; i < matches.size(); ++i)
    intervals.push_back(seconds_between(matches.time(i - 1), matches.time(i)));
  return std::min(0.5 * percentile(intervals, 0.5).value_or(0.0), kMaxDeltaFraction * delta_s);
}

PosePairs strict_pairs(MatchView matches, double delta, RpeUnit unit) {
  constexpr double kAngleTolerance = 0.1;  // relative to delta
  switch (unit) {
    case RpeUnit::kSeconds:
      return pairs_over_seconds(matches, delta, strict_tolerance_s(matches, delta));
    case RpeUnit::kFrames:
      return {.pairs = pairs_over_frames(matches.size(),
                                         static_cast<std::size_t>(std::max(1L, std::lround(delta))), true)};
    case RpeUnit::kMeters:
      return pairs_over_meters(path_lengths(matches, PathOf::kGroundTruth), delta, kSegmentTolerance * delta);
    case RpeUnit::kDegrees:
      break;
  }
  return pairs_over_meters(path_angles_deg(matches), delta, kAngleTolerance * delta);
}

}  // namespace stillpoint::eval
