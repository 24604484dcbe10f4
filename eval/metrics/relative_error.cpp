// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/relative_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "eval/metrics/ate.h"

namespace stillpoint::eval {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Yaw of R = Rz(yaw) Ry(pitch) Rx(roll).
double yaw_of(const Eigen::Matrix3d& R) { return std::atan2(R(1, 0), R(0, 0)); }

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
  for (std::size_t i = 0; i + step < poses; i += every_start ? 1 : step) pairs.push_back({i, i + step});
  return pairs;
}

PosePairs pairs_over_seconds(std::span<const MatchedPose> matches, double delta_s, double tolerance_s) {
  PosePairs result;
  std::size_t j = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Timestamp target = after(matches[i].t, delta_s);
    const auto difference = [&](std::size_t k) { return std::abs(seconds_between(target, matches[k].t)); };
    j = std::max(j, i);
    while (j + 1 < matches.size() && difference(j + 1) < difference(j)) ++j;
    if (j > i && difference(j) <= tolerance_s) {
      result.pairs.push_back({i, j});
    } else {
      ++result.dropped;
    }
  }
  return result;
}

std::vector<double> path_lengths(std::span<const MatchedPose> matches, PathOf of) {
  const auto position = [of](const MatchedPose& match) -> const Eigen::Vector3d& {
    return of == PathOf::kGroundTruth ? match.gt.p : match.est.p;
  };
  std::vector<double> lengths;
  lengths.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    lengths.push_back(i == 0 ? 0.0
                             : lengths.back() + (position(matches[i]) - position(matches[i - 1])).norm());
  }
  return lengths;
}

PosePairs pairs_over_meters(std::span<const double> lengths_m, double delta_m, double tolerance_m) {
  PosePairs result;
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
      result.pairs.push_back({i, best});
    } else {
      ++result.dropped;
    }
  }
  return result;
}

RelativeErrors relative_errors(std::span<const MatchedPose> matches, std::span<const PosePair> pairs) {
  RelativeErrors errors;
  for (const auto& [from, to] : pairs) {
    const Pose gt_motion = matches[from].gt.inverse() * matches[to].gt;
    const Pose est_motion = matches[from].est.inverse() * matches[to].est;
    const Pose error = gt_motion.inverse() * est_motion;
    const Eigen::Matrix3d R_w_e = matches[to].est.R();
    errors.translation_m.push_back(error.p.norm());
    errors.rotation_deg.push_back(kDegrees * rotation_angle(error.q));
    errors.yaw_deg.push_back(kDegrees * std::abs(yaw_of(R_w_e * error.R() * R_w_e.transpose())));
  }
  return errors;
}

}  // namespace stillpoint::eval
