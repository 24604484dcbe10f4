// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/rpe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "eval/metrics/ate.h"

namespace stillpoint::eval {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Yaw of R_w_e E R_w_e^T, where yaw is that of Rz(yaw) Ry(pitch) Rx(roll).
double yaw_in_world(const Eigen::Matrix3d& R_w_e, const Eigen::Quaterniond& E) {
  const Eigen::Vector3d column = E * R_w_e.row(0).transpose();
  return std::atan2(R_w_e.row(1).dot(column), R_w_e.row(0).dot(column));
}

}  // namespace

// Inlined as a whole: calls for each product of quaternions took an eighth of the time of `eval`.
[[gnu::flatten]] RelativeErrors relative_errors(MatchView matches, std::span<const PosePair> pairs,
                                                bool with_yaw, RelativeErrors recycled) {
  RelativeErrors errors = std::move(recycled);
  errors.translation_m.clear();
  errors.rotation_deg.clear();
  errors.yaw_deg.clear();
  errors.translation_m.reserve(pairs.size());
  errors.rotation_deg.reserve(pairs.size());
  if (with_yaw) errors.yaw_deg.reserve(pairs.size());
  for (const auto& [begin, end] : pairs) {
    const MatchedPose from = matches[begin];
    const MatchedPose to = matches[end];
    const Pose gt_motion = from.gt.inverse() * to.gt;
    const Pose est_motion = from.est.inverse() * to.est;
    const Pose error = gt_motion.inverse() * est_motion;
    errors.translation_m.push_back(error.p.norm());
    errors.rotation_deg.push_back(kDegrees * rotation_angle(error.q));
    if (with_yaw) errors.yaw_deg.push_back(kDegrees * std::abs(yaw_in_world(to.est.R(), error.q)));
  }
  return errors;
}

std::vector<double> point_distance_errors(MatchView matches, std::span<const PosePair> pairs) {
  std::vector<double> errors_m;
  errors_m.reserve(pairs.size());
  for (const auto& [begin, end] : pairs) {
    const MatchedPose from = matches[begin];
    const MatchedPose to = matches[end];
    errors_m.push_back(std::abs((to.gt.p - from.gt.p).norm() - (to.est.p - from.est.p).norm()));
  }
  return errors_m;
}

double whole_transformation_error(double translation_m, double rotation_deg) {
  return std::hypot(translation_m, std::sqrt(8.0) * std::sin(0.5 * rotation_deg * std::numbers::pi / 180.0));
}

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

/// Finds the closest of increasing stamps to times that increase from call to call.
class NearestStamps {
 public:
  explicit NearestStamps(std::span<const double> stamps) : stamps_(stamps) {}

  /// The result of `nearest_by_bisection`, which decides among equally close stamps.
  [[nodiscard]] std::size_t nearest(double t) {
    const std::size_t count = stamps_.size();
    while (last_ + 1 < count && stamps_[last_ + 1] <= t) ++last_;
    const std::size_t next = last_ + 1;
    if (!(stamps_[last_] <= t) || next == count) return nearest_by_bisection(stamps_, t);
    const double below = t - stamps_[last_];
    const double above = stamps_[next] - t;
    if (below < above && (last_ == 0 || stamps_[last_ - 1] < stamps_[last_])) return last_;
    if (above < below && (next + 1 == count || stamps_[next] < stamps_[next + 1])) return next;
    return nearest_by_bisection(stamps_, t);
  }

 private:
  std::span<const double> stamps_;
  std::size_t last_ = 0;  ///< the last stamp until the last time
};

double median_interval(std::span<const double> stamps) {
  std::vector<double> intervals;
  intervals.reserve(stamps.size());
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  return percentile(intervals, 0.5).value_or(0.0);
}

/// Length of a step between consecutive poses in a unit that is not the time.
double step_of(const Pose& from, const Pose& to, RpeUnit unit) {
  if (unit == RpeUnit::kFrames) return 1.0;
  if (unit == RpeUnit::kMeters) return (to.p - from.p).norm();
  return kDegrees * rotation_angle(from.q.conjugate() * to.q);
}

/// Per pose, the coordinate in which delta is measured.
std::vector<double> axis_of(const Trajectory& est, RpeUnit unit) {
  if (unit == RpeUnit::kSeconds) return stamps_of(est);
  std::vector<double> axis;
  axis.reserve(est.poses.size());
  for (std::size_t i = 0; i < est.poses.size(); ++i) {
    axis.push_back(i == 0 ? 0.0 : axis.back() + step_of(est.poses[i - 1].T_w_f, est.poses[i].T_w_f, unit));
  }
  return axis;
}

constexpr PoseIndex kNoPose = static_cast<PoseIndex>(-1);

/// Index of the ground-truth stamp closest to each estimated one; `kNoPose` without a stamp within the limit
/// of the TUM tools, twice the median interval.
std::vector<PoseIndex> nearest_truth(const Trajectory& gt, const Trajectory& est, double offset_s) {
  const std::vector<double> stamps = stamps_of(gt);
  const double max_difference_s = 2.0 * median_interval(stamps);
  NearestStamps lookup(stamps);
  std::vector<PoseIndex> nearest;
  nearest.reserve(est.poses.size());
  for (const StampedPose& pose : est.poses) {
    const double t = stamp_as_double(pose.t) + offset_s;
    const std::size_t index = lookup.nearest(t);
    nearest.push_back(std::abs(stamps[index] - t) > max_difference_s ? kNoPose
                                                                     : static_cast<PoseIndex>(index));
  }
  return nearest;
}

}  // namespace

std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est, const RpeOptions& options) {
  if (gt.poses.size() < 2 || est.poses.size() < 2) return std::nullopt;
  const std::vector<PoseIndex> nearest = nearest_truth(gt, est, options.offset_s);
  const std::vector<double> axis = axis_of(est, options.unit);
  NearestStamps ends(axis);
  RpeResult result;
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  translation_m.reserve(axis.size());
  rotation_deg.reserve(axis.size());
  for (std::size_t i = 0; i < axis.size(); ++i) {
    const std::size_t j = ends.nearest(axis[i] + options.delta);
    if (j + 1 == axis.size()) continue;
    const PoseIndex gt_i = nearest[i];
    const PoseIndex gt_j = nearest[j];
    if (gt_i == kNoPose || gt_j == kNoPose) {
      ++result.dropped_gt;
      continue;
    }
    if (i == j) ++result.self_pairs;
    const Pose est_motion = est.poses[j].T_w_f.inverse() * est.poses[i].T_w_f;
    const Pose gt_motion = gt.poses[gt_j].T_w_f.inverse() * gt.poses[gt_i].T_w_f;
    const Pose error = est_motion.inverse() * gt_motion;
    translation_m.push_back(error.p.norm());
    rotation_deg.push_back(rotation_angle(error.q) * 180.0 / std::numbers::pi);
  }
  if (translation_m.size() == result.self_pairs) return std::nullopt;
  result.translation_m = *statistics(translation_m);
  result.rotation_deg = *statistics(rotation_deg);
  return result;
}

StrictRpeResult strict_rpe(MatchView matches, double delta_s) {
  StrictRpeResult result;
  result.tolerance_s = strict_tolerance_s(matches, delta_s);
  const PosePairs found = pairs_over_seconds(matches, delta_s, result.tolerance_s);
  RelativeErrors errors = relative_errors(matches, found.pairs, false);
  result.dropped = found.dropped;
  if (!found.pairs.empty()) {
    result.errors = StrictRpe{*statistics(errors.translation_m), *statistics(errors.rotation_deg)};
  }
  return result;
}

std::vector<MatchedPose> strict_matches(const Trajectory& gt, const Trajectory& est, double offset_s) {
  return matched_poses(gt, est, associate_interpolated(gt, est, kStrictMaxGap, offset_s));
}

double median_pose_interval_s(const Trajectory& path) {
  constexpr std::size_t kIntervals = 20000;
  const std::size_t step = path.poses.size() / kIntervals + 1;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < path.poses.size(); i += step)
    intervals.push_back(seconds_between(path.poses[i - 1].t, path.poses[i].t));
  return percentile(intervals, 0.5).value_or(0.0);
}

std::string sparse_truth_note(const Trajectory& gt) {
  const double interval_s = median_pose_interval_s(gt);
  if (interval_s <= kStrictMaxGap) return "";
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "the ground truth has one pose per %.3g s: RPE compares poses with one up to %.3g s away",
                interval_s, 0.5 * interval_s);
  return text.data();
}

namespace {

constexpr std::array<double, 5> kPathFractions{0.1, 0.2, 0.3, 0.4, 0.5};

std::vector<double> lengths_for(std::span<const double> path_m, const SegmentOptions& options) {
  if (!options.lengths_m.empty() || path_m.empty() || path_m.back() <= 0.0) return options.lengths_m;
  std::vector<double> lengths;
  lengths.reserve(kPathFractions.size());
  for (const double fraction : kPathFractions) lengths.push_back(fraction * path_m.back());
  return lengths;
}

}  // namespace

std::vector<SegmentErrors> segment_errors(MatchView matches, const SegmentOptions& options) {
  const std::vector<double> path_m = path_lengths(matches, PathOf::kGroundTruth);
  std::vector<SegmentErrors> segments;
  RelativeErrors errors;
  for (const double length_m : lengths_for(path_m, options)) {
    PosePairs found = pairs_over_meters(path_m, length_m, options.tolerance * length_m);
    if (found.pairs.empty()) continue;
    if (options.shift_starts) {
      for (std::size_t k = 0; k < found.pairs.size(); ++k) found.pairs[k].from = static_cast<PoseIndex>(k);
    }
    errors = relative_errors(matches, found.pairs, true, std::move(errors));
    const Statistics translation_m = *statistics(errors.translation_m);
    static_assert(kPercentiles.front() == 75);
    segments.push_back({.length_m = length_m,
                        .translation_m = translation_m,
                        .rotation_deg = *statistics(errors.rotation_deg),
                        .yaw_deg = *statistics(errors.yaw_deg),
                        .translation_lower_quartile_m = *percentile(errors.translation_m, 0.25),
                        .translation_upper_quartile_m = translation_m.percentiles.front(),
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
