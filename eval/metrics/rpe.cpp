// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/rpe.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "eval/metrics/ate.h"

namespace stillpoint::eval {
namespace {

std::vector<double> stamps_of(const Trajectory& trajectory) {
  std::vector<double> stamps;
  stamps.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) stamps.push_back(stamp_as_double(pose.t));
  return stamps;
}

/// Index of the stamp closest to t by binary search. Of two equally close ones it returns the first one
/// probed, as the TUM tools do: ties are common (ground truth on a 10 ms grid). `stamps` is not empty.
std::size_t nearest_by_bisection(std::span<const double> stamps, double t) {
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

/// Per pose, the coordinate in which delta is measured.
std::vector<double> axis_of(const Trajectory& est, RpeUnit unit) {
  if (unit == RpeUnit::kSeconds) return stamps_of(est);
  std::vector<double> axis;
  axis.reserve(est.poses.size());
  for (std::size_t i = 0; i < est.poses.size(); ++i) {
    const double step = i == 0                     ? 0.0
                        : unit == RpeUnit::kFrames ? 1.0
                                                   : (est.poses[i].T_w_f.p - est.poses[i - 1].T_w_f.p).norm();
    axis.push_back(i == 0 ? 0.0 : axis.back() + step);
  }
  return axis;
}

/// Nearest-neighbor lookup of ground-truth stamps; the limit is that of the TUM tools.
class GroundTruthLookup {
 public:
  explicit GroundTruthLookup(const Trajectory& gt)
      : stamps_(stamps_of(gt)), max_difference_s_(2.0 * median_interval(stamps_)) {}

  [[nodiscard]] std::optional<std::size_t> nearest(double t) const {
    const std::size_t index = nearest_by_bisection(stamps_, t);
    if (std::abs(stamps_[index] - t) > max_difference_s_) return std::nullopt;
    return index;
  }

 private:
  std::vector<double> stamps_;
  double max_difference_s_;
};

}  // namespace

std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est, const RpeOptions& options) {
  if (gt.poses.size() < 2 || est.poses.size() < 2) return std::nullopt;
  const GroundTruthLookup lookup(gt);
  const std::vector<double> stamps = stamps_of(est);
  const std::vector<double> axis = axis_of(est, options.unit);
  RpeResult result;
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  for (std::size_t i = 0; i < axis.size(); ++i) {
    const std::size_t j = nearest_by_bisection(axis, axis[i] + options.delta);
    if (j + 1 == axis.size()) continue;
    const std::optional<std::size_t> gt_i = lookup.nearest(stamps[i] + options.offset_s);
    const std::optional<std::size_t> gt_j = lookup.nearest(stamps[j] + options.offset_s);
    if (!gt_i || !gt_j) {
      ++result.dropped_gt;
      continue;
    }
    if (i == j) ++result.self_pairs;
    const Pose est_motion = est.poses[j].T_w_f.inverse() * est.poses[i].T_w_f;
    const Pose gt_motion = gt.poses[*gt_j].T_w_f.inverse() * gt.poses[*gt_i].T_w_f;
    const Pose error = est_motion.inverse() * gt_motion;
    translation_m.push_back(error.p.norm());
    rotation_deg.push_back(rotation_angle(error.q) * 180.0 / std::numbers::pi);
  }
  if (translation_m.empty()) return std::nullopt;
  result.translation_m = *statistics(translation_m);
  result.rotation_deg = *statistics(rotation_deg);
  return result;
}

}  // namespace stillpoint::eval
