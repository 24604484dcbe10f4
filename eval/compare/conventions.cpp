// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>

#include "core/geometry/so3.h"
#include "eval/compare/time_offset.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/orientations.h"

namespace stillpoint::eval {
namespace {

constexpr double kMinImprovement = 3.0;  // minimum factor by which correcting a violation reduces the error
constexpr double kMinAte = 0.01;         // [m]; smaller errors need no explanation
constexpr double kMinRotation = 5.0;     // [deg]
constexpr std::size_t kMinMatches = 10;
constexpr std::size_t kCheckedPoses = 20000;  // a convention holds for all; limits the run time

/// Every n-th pose, so that at most `kCheckedPoses` remain.
Trajectory thinned(const Trajectory& path) {
  const std::size_t step = path.poses.size() / kCheckedPoses + 1;
  Trajectory result{.frame = path.frame, .poses = {}};
  for (std::size_t i = 0; i < path.poses.size(); i += step) result.poses.push_back(path.poses[i]);
  return result;
}

/// The poses between which those of the estimate lie: those that its matches are interpolated from.
Trajectory around(const Trajectory& gt, const Trajectory& est) {
  Trajectory part{.frame = gt.frame, .poses = {}};
  std::size_t next = 0;  // index of the first pose that is not copied
  for (const InterpolatedPair& pair :
       associate_interpolated(gt, est, std::numeric_limits<double>::infinity())) {
    const std::size_t end = std::min<std::size_t>(pair.gt + 2, gt.poses.size());
    for (std::size_t i = std::max<std::size_t>(next, pair.gt); i < end; ++i)
      part.poses.push_back(gt.poses[i]);
    next = end;
  }
  return part;
}

/// Errors before or after the correction of a suspected violation.
struct Errors {
  double ate_m = 0.0;
  double ate_deg = 0.0;
  double rpe_deg_per_s = 0.0;  ///< strict R.RPE; 0 without pairs
};

std::optional<Errors> errors_of(const Trajectory& gt, const Trajectory& est) {
  const std::vector<MatchedPose> matches = strict_matches(gt, est);
  if (matches.size() < kMinMatches) return std::nullopt;
  Errors errors;
  const Similarity S_w_v = align(matches, Alignment::kSe3).S_w_v;
  const AteErrors ate = ate_errors(matches, complete_rotation(matches, S_w_v).S_w_v);
  errors.ate_m = statistics(ate.translation_m)->rmse;
  errors.ate_deg = statistics(ate.rotation_deg)->rmse;
  if (const StrictRpeResult rpe = strict_rpe(matches, 1.0); rpe.errors) {
    errors.rpe_deg_per_s = rpe.errors->rotation_deg.rmse;
  }
  return errors;
}

template <class Function>
Trajectory transformed(const Trajectory& est, const Function& function) {
  Trajectory result = est;
  for (StampedPose& pose : result.poses) pose.T_w_f = function(pose.T_w_f);
  return result;
}

constexpr double kMinOrderRpe = 0.5;    // [deg/s]; slower rotation does not tell the order of quaternions
constexpr double kBothOrderGain = 1.5;  // of the R.RPE, if the ATE in degrees falls by kMinImprovement, too

}  // namespace

std::optional<OrderFinding> find_quaternion_order(const LoadedTrajectory& gt, const LoadedTrajectory& est,
                                                  double offset_s) {
  Trajectory shifted = thinned(est.trajectory);
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, offset_s);
  const Trajectory truth = around(gt.trajectory, shifted);
  const std::optional<Errors> current = errors_of(truth, shifted);
  if (!current || current->rpe_deg_per_s < kMinOrderRpe) return std::nullopt;
  std::optional<OrderFinding> best;
  for (const auto& [other_gt, other_est] : {std::pair(false, true), {true, false}, {true, true}}) {
    if (other_gt && gt.order_source == OrderSource::kNone) continue;
    if (other_est && est.order_source == OrderSource::kNone) continue;
    const std::optional<Errors> errors =
        errors_of(other_gt ? with_other_order(truth, gt.order) : truth,
                  other_est ? with_other_order(shifted, est.order) : shifted);
    if (!errors) continue;
    // Reading both in the other order exchanges a rotation of the world for one of the body: it also removes
    // the R.RPE of a body frame that differs. Then the rotation error after alignment remains.
    const bool both = other_gt && other_est;
    const double gain = both ? kBothOrderGain : kMinImprovement;
    if (gain * errors->rpe_deg_per_s >= current->rpe_deg_per_s) continue;
    if (both && kMinImprovement * errors->ate_deg >= current->ate_deg) continue;
    if (best && best->corrected_rpe_deg_per_s <= errors->rpe_deg_per_s) continue;
    best = OrderFinding{other_gt, other_est, current->rpe_deg_per_s, errors->rpe_deg_per_s};
  }
  return best;
}

namespace {

template <class... Values>
std::string format_message(const char* format, Values... values) {
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

double span_s(const Trajectory& path) { return seconds_between(path.poses.front().t, path.poses.back().t); }

double interval_s(const Trajectory& path) {
  return span_s(path) / static_cast<double>(path.poses.size() - 1);
}

/// Whether all stamps are whole numbers, as frame numbers are, and no seconds since 1970.
bool has_small_whole_numbers(const Trajectory& path) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::int64_t kMaxNumber = 100'000'000;  // of 30 frames/s in 38 days
  return path.poses.back().t.ns / kSecond < kMaxNumber &&
         std::ranges::all_of(path.poses, [](const StampedPose& pose) { return pose.t.ns % kSecond == 0; });
}

bool is_slow(const Trajectory& path) {
  constexpr double kMinInterval = 5.0;  // [s]
  return path.poses.size() > 1 && interval_s(path) >= kMinInterval;
}

bool is_counted(const Trajectory& path) {
  return path.poses.size() >= kMinMatches && has_small_whole_numbers(path);
}

/// @param subject what has the stamps
ConventionFinding stamp_finding(const char* subject, const Trajectory& path) {
  return {
      Convention::kStampUnit,
      format_message("%s, one pose per %.3g s: if these are %s, convert them to seconds, since validity and "
                     "intervals of poses are in seconds",
                     subject, interval_s(path),
                     is_counted(path) ? "frame numbers or milliseconds" : "milliseconds")};
}

/// As `find_implausible_stamps`: whole numbers in the estimate, or few poses in both files.
std::optional<ConventionFinding> slow_stamps(const Trajectory& gt, const Trajectory& est) {
  if (is_counted(est)) return stamp_finding("the estimate has whole numbers as stamps", est);
  if (is_slow(gt) && is_slow(est)) return stamp_finding("the stamps of both files are sparse", est);
  return std::nullopt;
}

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
          format_message(
              "the estimate is %.3g times as long as the ground truth: its stamps seem to be in %s, not "
              "seconds",
              ratio, unit.name)};
    }
  }
  if (est.poses.front().t > gt.poses.back().t || est.poses.back().t < gt.poses.front().t) {
    return ConventionFinding{
        Convention::kStampUnit,
        format_message(
            "the files do not overlap in time: the estimate starts %.3f s after the ground truth; check the "
            "epoch and the sequence",
            seconds_between(gt.poses.front().t, est.poses.front().t))};
  }
  return slow_stamps(gt, est);
}

double position_rmse(MatchView matches, Alignment kind) {
  return position_rmse(matches, align(matches, kind).S_w_v);
}

/// RMS distance of the true positions from their mean.
double extent_m(MatchView matches) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) mean += match.gt.p;
  mean /= static_cast<double>(matches.size());
  double squared = 0.0;
  for (const MatchedPose& match : matches) squared += (match.gt.p - mean).squaredNorm();
  return std::sqrt(squared / static_cast<double>(matches.size()));
}

bool is_scaled(const Similarity& S_w_v) {
  constexpr double kMinDeviation = 0.1;  // of the scale from 1
  return S_w_v.scale > 0.0 && std::abs(std::log(S_w_v.scale)) >= kMinDeviation;
}

std::optional<ConventionFinding> mirrored(const Trajectory& gt, const Trajectory& est) {
  std::vector<MatchedPose> matches = strict_matches(gt, est);
  if (matches.size() < kMinMatches) return std::nullopt;
  const double read_m = position_rmse(matches, Alignment::kSe3);
  const double scaled_m = position_rmse(matches, Alignment::kSim3);
  for (MatchedPose& match : matches) match.est.p.z() *= -1.0;
  const Similarity fit = align(matches, Alignment::kSim3).S_w_v;
  const double mirrored_m = position_rmse(matches, fit);
  if (read_m < kMinAte || mirrored_m * kMinImprovement > std::min(read_m, scaled_m)) return std::nullopt;
  return ConventionFinding{
      Convention::kMirrored,
      format_message(
          "the estimate is mirrored: with one axis reversed%s, the ATE is %.4f instead of %.4f m; its "
          "coordinate system seems to be left-handed",
          is_scaled(fit) ? format_message(" and scaled by %.4g", fit.scale).c_str() : "", mirrored_m,
          read_m)};
}

std::optional<ConventionFinding> time_offset(const Trajectory& gt, const Trajectory& est) {
  constexpr double kMinOffset = 0.005;  // [s]
  const std::optional<TimeOffset> found = find_time_offset(gt, est);
  if (!found || !found->undetermined.empty() || std::abs(found->offset_s) < kMinOffset ||
      found->ate_rmse_at_zero_m < kMinAte ||
      found->ate_rmse_m * kMinImprovement > found->ate_rmse_at_zero_m) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kTimeOffset,
      format_message(
          "time offset of %.4f s: adding it to the stamps of the estimate (--offset) reduces the ATE "
          "from %.4f to %.4f m",
          found->offset_s, found->ate_rmse_at_zero_m, found->ate_rmse_m)};
}

std::optional<ConventionFinding> quaternion_order(const Trajectory& gt, const Trajectory& est,
                                                  const Errors& current) {
  const Trajectory reordered = transformed(est, [](const Pose& pose) {
    const Eigen::Vector4d read = pose.q.coeffs();  // x y z w, in the order of the file's columns
    return Pose{Eigen::Quaterniond(read(0), read(1), read(2), read(3)), pose.p};
  });
  const std::optional<Errors> corrected = errors_of(gt, reordered);
  if (!corrected || current.rpe_deg_per_s < kMinRotation ||
      corrected->rpe_deg_per_s * kMinImprovement > current.rpe_deg_per_s) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kQuaternionOrder,
      format_message(
          "the quaternions seem to be in the order qw qx qy qz: reading them so reduces the R.RPE from "
          "%.2f to %.2f deg/s; the format requires qx qy qz qw",
          current.rpe_deg_per_s, corrected->rpe_deg_per_s)};
}

std::optional<ConventionFinding> inverted_poses(const Trajectory& gt, const Trajectory& est,
                                                const Errors& current) {
  const std::optional<Errors> corrected =
      errors_of(gt, transformed(est, [](const Pose& pose) { return pose.inverse(); }));
  if (!corrected || current.ate_m < kMinAte || corrected->ate_m * kMinImprovement > current.ate_m) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kInvertedPoses,
      format_message("the poses seem to be inverted (T_f_w instead of T_w_f): inverting them "
                     "reduces the ATE from %.4f to %.4f m",
                     current.ate_m, corrected->ate_m)};
}

/// Positions in the world with the rotation from the world to the body, as some tools store poses.
std::optional<ConventionFinding> inverted_rotations(const Trajectory& gt, const Trajectory& est,
                                                    const Errors& current) {
  if (current.rpe_deg_per_s < kMinRotation || current.ate_deg < kMinRotation) return std::nullopt;
  const std::optional<Errors> corrected = errors_of(gt, transformed(est, [](const Pose& pose) {
                                                      return Pose{pose.q.conjugate(), pose.p};
                                                    }));
  if (!corrected || corrected->rpe_deg_per_s * kMinImprovement > current.rpe_deg_per_s ||
      corrected->ate_deg * kMinImprovement > current.ate_deg) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kInvertedPoses,
      format_message(
          "the orientations seem to be inverted (of the world in the body): inverting them reduces "
          "the R.RPE from %.2f to %.2f deg/s",
          current.rpe_deg_per_s, corrected->rpe_deg_per_s)};
}

/// Rotation [deg] of an alignment by positions that their errors explain: their RMSE relative to the extent.
double alignment_error_deg(MatchView matches, const Similarity& S_w_v) {
  return std::atan2(position_rmse(matches, S_w_v), extent_m(matches)) * 180.0 / std::numbers::pi;
}

/// A time offset that the positions do not tell, as those of a circle at constant speed: aligned, they are
/// turned along it, and the orientations are off by that rotation and late.
std::optional<ConventionFinding> offset_of_orientations(const Trajectory& gt, const Trajectory& est,
                                                        const Errors& current) {
  constexpr int kMaxSteps = 40;
  constexpr double kStep = 0.025;  // [s]
  if (current.ate_deg < kMinRotation) return std::nullopt;
  double best_s = 0.0;
  Errors best = current;
  for (int step = -kMaxSteps; step <= kMaxSteps; ++step) {
    Trajectory shifted = est;
    for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, step * kStep);
    const std::optional<Errors> errors = errors_of(gt, shifted);
    if (!errors || errors->ate_deg >= best.ate_deg || errors->ate_m > current.ate_m + kMinAte) continue;
    best_s = step * kStep;
    best = *errors;
  }
  if (best.ate_deg * kMinImprovement > current.ate_deg) return std::nullopt;
  return ConventionFinding{
      Convention::kTimeOffset,
      format_message(
          "time offset of about %.2f s: adding it to the stamps of the estimate (--offset) reduces the ATE "
          "from %.2f to %.2f deg",
          best_s, current.ate_deg, best.ate_deg)};
}

/// Another body frame results in rotation errors that are large and nearly constant.
std::optional<ConventionFinding> body_frame(const Trajectory& gt, const Trajectory& est) {
  constexpr double kMaxSpread = 0.2;  // relative to the mean rotation error
  const std::vector<MatchedPose> matches = strict_matches(gt, est);
  if (matches.size() < kMinMatches) return std::nullopt;
  const CompletedAlignment fit = complete_rotation(matches, align(matches, Alignment::kSe3).S_w_v);
  if (!fit.determined) return std::nullopt;
  Eigen::Quaterniond mean = (fit.S_w_v * matches.front().est).q.conjugate() * matches.front().gt.q;
  const auto rotation_error = [&](const MatchedPose& match) {
    return (fit.S_w_v * match.est).q.conjugate() * match.gt.q;
  };
  Eigen::Vector3d correction = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) correction += log_so3(mean.conjugate() * rotation_error(match));
  mean = mean * exp_so3(correction / static_cast<double>(matches.size()));
  double squared = 0.0;
  for (const MatchedPose& match : matches)
    squared += log_so3(mean.conjugate() * rotation_error(match)).squaredNorm();
  const double spread_deg =
      std::sqrt(squared / static_cast<double>(matches.size())) * 180.0 / std::numbers::pi;
  const double rotation_deg = rotation_angle(mean) * 180.0 / std::numbers::pi;
  const double min_rotation_deg = std::max(kMinRotation, alignment_error_deg(matches, fit.S_w_v));
  if (rotation_deg < min_rotation_deg || spread_deg > kMaxSpread * rotation_deg) return std::nullopt;
  if (!missing_orientations(gt, est).empty()) return std::nullopt;
  return ConventionFinding{
      Convention::kBodyFrame,
      format_message(
          "the body frames of estimate and ground truth seem to differ by a rotation of %.1f deg (standard "
          "deviation %.1f deg); check which frame the poses refer to (camera, IMU, base)",
          rotation_deg, spread_deg)};
}

std::optional<ConventionFinding> swapped_arguments(const Trajectory& gt, const Trajectory& est) {
  const auto starts_at_identity = [](const Trajectory& path) {
    const Pose& first = path.poses.front().T_w_f;
    return first.p.norm() < 1e-6 && rotation_angle(first.q) < 1e-6;
  };
  const auto rate_hz = [](const Trajectory& path) {
    return static_cast<double>(path.poses.size() - 1) / std::max(span_s(path), 1e-9);
  };
  constexpr double kCameraRate = 5.0;  // [Hz]; GNSS receivers are slower
  const bool surrounds = est.poses.front().t < gt.poses.front().t && est.poses.back().t > gt.poses.back().t;
  if (surrounds && rate_hz(gt) >= kCameraRate && rate_hz(est) > 3.0 * rate_hz(gt)) {
    return ConventionFinding{
        Convention::kSwappedArguments,
        format_message(
            "the estimate starts before the ground truth, ends after it, and has %.1f poses/s instead of "
            "%.1f; check the order of the files: GT EST",
            rate_hz(est), rate_hz(gt))};
  }
  if (!starts_at_identity(gt) || starts_at_identity(est) || rate_hz(est) < 1.5 * rate_hz(gt)) {
    return std::nullopt;
  }
  return ConventionFinding{
      Convention::kSwappedArguments,
      format_message(
          "the ground truth starts at the identity and has %.1f poses/s, the estimate does not and has "
          "%.1f; check the order of the files",
          rate_hz(gt), rate_hz(est))};
}

/// The first ground-truth pose at or after a time, or the last one.
const Pose& pose_near(const Trajectory& gt, Timestamp t) {
  const auto found =
      std::ranges::lower_bound(gt.poses, t.ns, {}, [](const StampedPose& p) { return p.t.ns; });
  return (found == gt.poses.end() ? gt.poses.back() : *found).T_w_f;
}

std::optional<ConventionFinding> repeated_poses(const Trajectory& gt, const Trajectory& est) {
  constexpr double kMinDuration = 1.0;  // [s]; a pose that is repeated for less may be that of a slow system
  constexpr double kMinMotion = 0.1;    // [m] of the ground truth meanwhile
  const auto is_equal = [](const Pose& a, const Pose& b) {
    return a.p == b.p && a.q.coeffs() == b.q.coeffs();
  };
  double repeated_s = 0.0;
  double longest_s = 0.0;
  std::size_t longest = 0;  // its first pose
  for (std::size_t first = 0, last = 0; first < est.poses.size(); first = ++last) {
    const StampedPose& pose = est.poses[first];
    while (last + 1 < est.poses.size() && is_equal(est.poses[last + 1].T_w_f, pose.T_w_f)) ++last;
    const double duration_s = seconds_between(pose.t, est.poses[last].t);
    if (duration_s < kMinDuration) continue;
    if ((pose_near(gt, est.poses[last].t).p - pose_near(gt, pose.t).p).norm() < kMinMotion) continue;
    repeated_s += duration_s;
    if (duration_s > longest_s) longest = first;
    longest_s = std::max(longest_s, duration_s);
  }
  if (repeated_s == 0.0) return std::nullopt;
  return ConventionFinding{
      Convention::kRepeatedPoses,
      format_message(
          "the estimate repeats its last pose for %.1f of %.1f s while the body moves (longest for %.1f s, "
          "%.1f s after its start): a system that is lost should give no pose; coverage and CR count these",
          repeated_s, span_s(est), longest_s, seconds_between(est.poses.front().t, est.poses[longest].t))};
}

}  // namespace

std::optional<ConventionFinding> find_implausible_stamps(const Trajectory& path) {
  if (is_counted(path)) return stamp_finding("the stamps are whole numbers", path);
  if (is_slow(path)) return stamp_finding("the stamps are sparse", path);
  return std::nullopt;
}

std::optional<ConventionFinding> find_wrong_scale(const Trajectory& gt, const Trajectory& whole) {
  const std::vector<MatchedPose> matches = strict_matches(gt, thinned(whole));
  if (matches.size() < kMinMatches) return std::nullopt;
  const double rigid_m = position_rmse(matches, Alignment::kSe3);
  const Similarity fit = align(matches, Alignment::kSim3).S_w_v;
  const double scaled_m = position_rmse(matches, fit);
  if (rigid_m < kMinAte || scaled_m * kMinImprovement > rigid_m || !is_scaled(fit)) return std::nullopt;
  // An estimate that jumps or is noise fits best if it is shrunk to a point, which does not follow the path.
  if (scaled_m * kMinImprovement > extent_m(matches)) return std::nullopt;
  return ConventionFinding{
      Convention::kScale,
      format_message(
          "the estimate is %.4g times as large as the ground truth: scaling it reduces the ATE from %.4f "
          "to %.4f m; check the factor of the depth images, or use --align sim3 for a system without "
          "scale",
          1.0 / fit.scale, rigid_m, scaled_m)};
}

std::vector<ConventionFinding> find_convention_violations(const Trajectory& gt, const Trajectory& whole) {
  std::vector<ConventionFinding> findings;
  if (gt.poses.size() < 2 || whole.poses.size() < 2) return findings;
  const Trajectory est = thinned(whole);
  const auto add = [&findings](std::optional<ConventionFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
  };
  add(stamp_unit(gt, whole));
  const std::optional<ConventionFinding> mirror = mirrored(gt, est);  // tells the scale, too
  if (!mirror) add(find_wrong_scale(gt, whole));
  add(mirror);
  if (findings.empty()) add(time_offset(gt, whole));
  if (const std::optional<Errors> current = errors_of(gt, est)) {
    add(quaternion_order(gt, est, *current));
    add(inverted_poses(gt, est, *current));
    if (findings.empty()) add(inverted_rotations(gt, est, *current));
    if (findings.empty()) add(offset_of_orientations(gt, est, *current));
    if (findings.empty()) add(body_frame(gt, est));
  }
  add(swapped_arguments(gt, whole));
  add(repeated_poses(gt, whole));
  return findings;
}

}  // namespace stillpoint::eval
