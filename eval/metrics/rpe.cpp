// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/rpe.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "eval/metrics/ate.h"

namespace stillpoint {
namespace {

std::vector<double> stamps_of(const Trajectory& trajectory) {
  std::vector<double> stamps;
  stamps.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) stamps.push_back(stamp_as_double(pose.t));
  return stamps;
}

/// Index of the stamp nearest to t by halving, and of two equally near ones the one met first: ties are
/// common (ground truth on a 10 ms grid) and the TUM tools decide them so. `stamps` is not empty.
std::size_t nearest_by_halving(std::span<const double> stamps, double t) {
  std::size_t begin = 0;
  std::size_t end = stamps.size();
  std::size_t best = 0;
  double difference = std::abs(stamps[0] - t);
  while (begin < end) {
    const std::size_t middle = (begin + end) / 2;
    if (std::abs(stamps[middle] - t) < difference) {
      difference = std::abs(stamps[middle] - t);
      best = middle;
    }
    if (stamps[middle] == t) return middle;
    if (stamps[middle] > t) {
      end = middle;
    } else {
      begin = middle + 1;
    }
  }
  return best;
}

double median_interval(std::span<const double> stamps) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  return percentile(intervals, 0.5).value_or(0.0);
}

}  // namespace

std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est, const RpeOptions& options) {
  if (gt.poses.size() < 2 || est.poses.size() < 2) return std::nullopt;
  const std::vector<double> gt_stamps = stamps_of(gt);
  const std::vector<double> est_stamps = stamps_of(est);
  const double max_gt_difference = 2.0 * median_interval(gt_stamps);
  RpeResult result;
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  for (std::size_t i = 0; i < est_stamps.size(); ++i) {
    const std::size_t j = nearest_by_halving(est_stamps, est_stamps[i] + options.delta_s);
    if (j + 1 == est_stamps.size()) continue;
    if (std::abs(est_stamps[j] - est_stamps[i] - options.delta_s) > options.max_span_error_s) {
      ++result.dropped_span;
      continue;
    }
    const double t_i = est_stamps[i] + options.offset_s;
    const double t_j = est_stamps[j] + options.offset_s;
    const std::size_t k = nearest_by_halving(gt_stamps, t_i);
    const std::size_t m = nearest_by_halving(gt_stamps, t_j);
    if (std::abs(gt_stamps[k] - t_i) > max_gt_difference ||
        std::abs(gt_stamps[m] - t_j) > max_gt_difference) {
      ++result.dropped_gt;
      continue;
    }
    const Pose est_motion = est.poses[j].T_w_f.inverse() * est.poses[i].T_w_f;
    const Pose gt_motion = gt.poses[m].T_w_f.inverse() * gt.poses[k].T_w_f;
    const Pose error = est_motion.inverse() * gt_motion;
    translation_m.push_back(error.p.norm());
    rotation_deg.push_back(rotation_angle(error.q) * 180.0 / std::numbers::pi);
  }
  if (translation_m.empty()) return std::nullopt;
  result.pairs = translation_m.size();
  result.translation_m = *statistics(translation_m);
  result.rotation_deg = *statistics(rotation_deg);
  return result;
}

}  // namespace stillpoint
