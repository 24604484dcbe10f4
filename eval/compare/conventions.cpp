// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/conventions.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "core/geometry/so3.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/trajectory/time_offset.h"

namespace stillpoint {
namespace {

constexpr double kClearGain = 3.0;  // a mistake is named when undoing it makes an error this much smaller
constexpr double kMinAte = 0.01;    // [m]; below it nothing is wrong
constexpr double kMinTurn = 5.0;    // [deg]
constexpr std::size_t kMinMatches = 10;

/// What undoing a mistake is judged by.
struct Fit {
  double ate_m = 0.0;
  double turn_deg_per_s = 0.0;  ///< strict R.RPE; 0 when there is none
};

std::optional<Fit> fit_of(const Trajectory& gt, const Trajectory& est) {
  const std::vector<MatchedPose> matches = strict_matches(gt, est);
  if (matches.size() < kMinMatches) return std::nullopt;
  Fit fit;
  fit.ate_m = statistics(ate_errors(matches, align(matches, Alignment::kSe3).S_w_v).translation_m)->rmse;
  if (const StrictRpeResult rpe = strict_rpe(matches, 1.0); rpe.errors) {
    fit.turn_deg_per_s = rpe.errors->rotation_deg.rmse;
  }
  return fit;
}

template <class Change>
Trajectory changed(const Trajectory& est, const Change& change) {
  Trajectory result = est;
  for (StampedPose& pose : result.poses) pose.T_w_f = change(pose.T_w_f);
  return result;
}

template <class... Values>
std::string sentence(const char* format, Values... values) {
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

double span_s(const Trajectory& path) { return seconds_between(path.poses.front().t, path.poses.back().t); }

std::optional<ConventionFinding> stamp_unit(const Trajectory& gt, const Trajectory& est) {
  struct Unit {
    double ratio;
    const char* name;
  };
  constexpr std::array<Unit, 3> kUnits{{{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
  const double ratio = span_s(est) / std::max(span_s(gt), 1e-9);
  for (const Unit& unit : kUnits) {
    if (ratio > 0.2 * unit.ratio && ratio < 5.0 * unit.ratio) {
      return ConventionFinding{
          Convention::kStampUnit,
          sentence("the estimate lasts %.3g times as long as the ground truth: its stamps "
                   "look like %s, not seconds",
                   ratio, unit.name)};
    }
  }
  if (est.poses.front().t > gt.poses.back().t || est.poses.back().t < gt.poses.front().t) {
    return ConventionFinding{
        Convention::kStampUnit,
        sentence(
            "the files do not overlap in time: the estimate begins %.3f s from the ground truth's begin; "
            "another epoch, or another sequence",
            seconds_between(gt.poses.front().t, est.poses.front().t))};
  }
  return std::nullopt;
}

std::optional<ConventionFinding> time_offset(const Trajectory& gt, const Trajectory& est) {
  constexpr double kMinOffset = 0.005;  // [s]
  const std::optional<TimeOffset> found = find_time_offset(gt, est);
  if (!found || std::abs(found->offset_s) < kMinOffset || found->ate_rmse_at_zero_m < kMinAte ||
      found->ate_rmse_m * kClearGain > found->ate_rmse_at_zero_m) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kTimeOffset,
      sentence("the clocks look %.4f s apart: the ATE falls from %.4f to %.4f m when that is added to the "
               "estimate's stamps (--offset)",
               found->offset_s, found->ate_rmse_at_zero_m, found->ate_rmse_m)};
}

std::optional<ConventionFinding> quaternion_order(const Trajectory& gt, const Trajectory& est,
                                                  const Fit& now) {
  const Trajectory reordered = changed(est, [](const Pose& pose) {
    const Eigen::Vector4d read = pose.q.coeffs();  // x y z w, in the order of the file's columns
    return Pose{Eigen::Quaterniond(read(0), read(1), read(2), read(3)), pose.p};
  });
  const std::optional<Fit> then = fit_of(gt, reordered);
  if (!then || now.turn_deg_per_s < kMinTurn || then->turn_deg_per_s * kClearGain > now.turn_deg_per_s) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kQuaternionOrder,
      sentence("the quaternions look as if qw stood first: read so, R.RPE falls from %.2f to %.2f deg/s; the "
               "format wants qx qy qz qw",
               now.turn_deg_per_s, then->turn_deg_per_s)};
}

std::optional<ConventionFinding> inverted_poses(const Trajectory& gt, const Trajectory& est, const Fit& now) {
  const std::optional<Fit> then = fit_of(gt, changed(est, [](const Pose& pose) { return pose.inverse(); }));
  if (!then || now.ate_m < kMinAte || then->ate_m * kClearGain > now.ate_m) return std::nullopt;
  return ConventionFinding{
      Convention::kInvertedPoses,
      sentence(
          "the poses look inverted (world in frame, not frame in world): inverted back, the ATE falls from "
          "%.4f to %.4f m",
          now.ate_m, then->ate_m)};
}

/// A constant turn between the frames shows as rotation errors that are large and all the same.
std::optional<ConventionFinding> body_frame(const Trajectory& gt, const Trajectory& est) {
  constexpr double kMaxSpread = 0.2;  // of the mean turn
  const std::vector<MatchedPose> matches = strict_matches(gt, est);
  if (matches.size() < kMinMatches) return std::nullopt;
  const AlignmentResult fit = align(matches, Alignment::kSe3);
  if (!fit.determined) return std::nullopt;
  Eigen::Quaterniond mean = (fit.S_w_v * matches.front().est).q.conjugate() * matches.front().gt.q;
  const auto turn_of = [&](const MatchedPose& match) {
    return (fit.S_w_v * match.est).q.conjugate() * match.gt.q;
  };
  Eigen::Vector3d correction = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) correction += log_so3(mean.conjugate() * turn_of(match));
  mean = mean * exp_so3(correction / static_cast<double>(matches.size()));
  double squared = 0.0;
  for (const MatchedPose& match : matches)
    squared += log_so3(mean.conjugate() * turn_of(match)).squaredNorm();
  const double spread_deg =
      std::sqrt(squared / static_cast<double>(matches.size())) * 180.0 / std::numbers::pi;
  const double turn_deg = rotation_angle(mean) * 180.0 / std::numbers::pi;
  if (turn_deg < kMinTurn || spread_deg > kMaxSpread * turn_deg) return std::nullopt;
  return ConventionFinding{
      Convention::kBodyFrame,
      sentence(
          "the estimate's frame looks turned by %.1f deg against the ground truth's, with a spread of %.1f "
          "deg: poses of another frame of the robot (camera, IMU, base)?",
          turn_deg, spread_deg)};
}

std::optional<ConventionFinding> swapped_arguments(const Trajectory& gt, const Trajectory& est) {
  const auto starts_at_identity = [](const Trajectory& path) {
    const Pose& first = path.poses.front().T_w_f;
    return first.p.norm() < 1e-6 && rotation_angle(first.q) < 1e-6;
  };
  const auto rate_hz = [](const Trajectory& path) {
    return static_cast<double>(path.poses.size() - 1) / std::max(span_s(path), 1e-9);
  };
  if (!starts_at_identity(gt) || starts_at_identity(est) || rate_hz(est) < 1.5 * rate_hz(gt)) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kSwappedArguments,
      sentence("the ground truth begins at the identity and has %.1f poses/s, the estimate does not and has "
               "%.1f: are the two files swapped?",
               rate_hz(gt), rate_hz(est))};
}

}  // namespace

std::vector<ConventionFinding> find_convention_mistakes(const Trajectory& gt, const Trajectory& est) {
  std::vector<ConventionFinding> findings;
  if (gt.poses.size() < 2 || est.poses.size() < 2) return findings;
  const auto add = [&findings](std::optional<ConventionFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
  };
  add(stamp_unit(gt, est));
  add(time_offset(gt, est));
  if (const std::optional<Fit> now = fit_of(gt, est)) {
    add(quaternion_order(gt, est, *now));
    add(inverted_poses(gt, est, *now));
    if (findings.empty()) add(body_frame(gt, est));
  }
  add(swapped_arguments(gt, est));
  return findings;
}

}  // namespace stillpoint
