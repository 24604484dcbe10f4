// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/truth_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::bench {
namespace {

constexpr double kTruthLagRange_s = 0.2;
constexpr double kMotion_s = 0.5;
constexpr double kMaxTruthGap_s = 0.1;
constexpr double kClear = 4.0;              ///< standard deviations
constexpr double kLeastTruthLag_s = 0.003;  ///< between frames the camera moves by less than its errors
constexpr double kLeastTurn_rad = 0.035;    ///< 2 degrees
constexpr double kLeastDistance_m = 0.01;
constexpr double kLeastScale = 0.02;
constexpr double kMostScaleSigma = 0.25;  ///< relative; above only a factor of e would be clear
constexpr double kMostTurnSigma_rad = 0.17;
constexpr double kMostPositionSigma_m = 0.1;
constexpr double kLeastMotions = 30.0;
constexpr double kForward = 0.9;  ///< part of a motion along the optical axis that tells its bearing
constexpr double kLeastForward_m = 0.05;
constexpr double kBearingBlock_s = 1.0;
constexpr std::size_t kLeastBearingBlocks = 5;
constexpr double kLeastBearing_rad = 0.0175;  ///< 1 degree
constexpr double kLeastNoise_m = 0.002;
constexpr double kLeastJump_m = 0.03;
constexpr double kJumpRatio = 8.0;  ///< to the median difference of neighboring steps
constexpr double kLeastCoverage = 0.95;

double middle_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The pose at a time; nullopt beyond the ends and in gaps.
std::optional<Pose> pose_at(const Trajectory& trajectory, Timestamp t) {
  const auto next = std::ranges::lower_bound(trajectory.poses, t, {}, &StampedPose::t);
  if (next == trajectory.poses.end()) return std::nullopt;
  if (next->t == t) return next->T_w_f;
  if (next == trajectory.poses.begin()) return std::nullopt;
  const auto last = std::prev(next);
  const double interval_s = seconds_between(last->t, next->t);
  if (interval_s > kMaxTruthGap_s) return std::nullopt;
  return interpolate(last->T_w_f, next->T_w_f, seconds_between(last->t, t) / interval_s);
}

/// The poses between the first and the last frame, with a margin for a wrong clock.
Trajectory part_of_truth(const datasets::SequenceInfo& info) {
  Trajectory part = info.ground_truth.trajectory;
  const Timestamp first = after(info.frame_times.front(), -kTruthLagRange_s),
                  last = after(info.frame_times.back(), kTruthLagRange_s);
  std::erase_if(part.poses, [&](const StampedPose& pose) { return pose.t < first || pose.t > last; });
  return part;
}

double noise_of(const std::vector<StampedPose>& poses) {
  std::vector<double> differences;
  for (std::size_t i = 4; i < poses.size(); ++i) {
    const Eigen::Vector3d fourth = poses[i].T_w_f.p - 4.0 * poses[i - 1].T_w_f.p +
                                   6.0 * poses[i - 2].T_w_f.p - 4.0 * poses[i - 3].T_w_f.p +
                                   poses[i - 4].T_w_f.p;
    for (int axis = 0; axis < 3; ++axis) differences.push_back(std::abs(fourth[axis]));
  }
  constexpr double kMedianOfNormal = 0.6745, kSumOfSquares = 70.0;  // 1 + 16 + 36 + 16 + 1
  return middle_of(differences) / kMedianOfNormal / std::sqrt(kSumOfSquares);
}

std::vector<Timestamp> jumps_of(const std::vector<StampedPose>& poses) {
  std::vector<double> excesses;
  for (std::size_t i = 1; i + 2 < poses.size(); ++i) {
    const Eigen::Vector3d before = poses[i].T_w_f.p - poses[i - 1].T_w_f.p,
                          step = poses[i + 1].T_w_f.p - poses[i].T_w_f.p,
                          behind = poses[i + 2].T_w_f.p - poses[i + 1].T_w_f.p;
    excesses.push_back((step - 0.5 * (before + behind)).norm());
  }
  const double limit_m = std::max(kLeastJump_m, kJumpRatio * middle_of(excesses));
  std::vector<Timestamp> jumps;
  for (std::size_t i = 0; i < excesses.size(); ++i) {
    const bool largest = (i == 0 || excesses[i] >= excesses[i - 1]) &&
                         (i + 1 == excesses.size() || excesses[i] >= excesses[i + 1]);
    if (excesses[i] > limit_m && largest) jumps.push_back(poses[i + 2].t);
  }
  return jumps;
}

/// Linear least squares y = J x over motions whose overlap repeats their errors.
class MotionFit {
 public:
  struct Solution {
    Eigen::Vector4d x, sigma;
  };

  void add(const Eigen::Matrix<double, 3, 4>& J, const Eigen::Vector3d& y) {
    H_ += J.transpose() * J;
    g_ += J.transpose() * y;
    squares_ += y.squaredNorm();
    count_ += 1.0;
  }

  /// @return nullopt for too few motions, or those that do not determine x
  [[nodiscard]] std::optional<Solution> solve() const {
    if (count_ < kLeastMotions) return std::nullopt;
    const Eigen::Vector4d x = solve_symmetric(H_, g_);
    const double independent = count_ / (kMotion_s * 30.0) + 1.0;
    const double variance = std::max(0.0, squares_ - g_.dot(x)) / (3.0 * independent);
    const Eigen::Vector4d sigma = (variance * H_.inverse().diagonal().cwiseMax(0.0)).cwiseSqrt();
    if (!x.allFinite() || !sigma.allFinite()) return std::nullopt;
    return Solution{x, sigma};
  }

 private:
  Eigen::Matrix4d H_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d g_ = Eigen::Vector4d::Zero();
  double squares_ = 0.0, count_ = 0.0;
};

/// Both regressions of the hand-eye calibration.
struct HandEye {
  MotionFit truth;   ///< p_A = s R_f_c p_B - (R_A - I) p;      x = (p, s)
  MotionFit camera;  ///< R_f_c p_B = p_A / s + (R_A - I) p / s; x = (p / s, 1 / s)
};

/// Relative motions of the truth's frame and the camera from the same time on.
struct MotionPair {
  Timestamp t;
  Pose A, B;
};

std::vector<MotionPair> motion_pairs(const Trajectory& truth, const Trajectory& visual, double lag_s) {
  std::vector<MotionPair> pairs;
  auto end = visual.poses.begin();
  for (const StampedPose& begin : visual.poses) {
    while (end != visual.poses.end() && seconds_between(begin.t, end->t) < kMotion_s) ++end;
    if (end == visual.poses.end()) break;
    const auto from = pose_at(truth, after(begin.t, lag_s)), to = pose_at(truth, after(end->t, lag_s));
    if (from && to) pairs.push_back({begin.t, from->inverse() * *to, begin.T_w_f.inverse() * end->T_w_f});
  }
  return pairs;
}

HandEye hand_eye(const std::vector<MotionPair>& pairs, const Eigen::Quaterniond& q_f_c) {
  HandEye result;
  for (const auto& [t, A, B] : pairs) {
    const Eigen::Vector3d camera = q_f_c * B.p;
    const Eigen::Matrix3d turn = A.R() - Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 3, 4> J;
    J << -turn, camera;
    result.truth.add(J, A.p);
    J << turn, A.p;
    result.camera.add(J, camera);
  }
  return result;
}

/// Adds position and scale of the hand-eye calibration, if the motion determines them.
void add_hand_eye(const std::vector<MotionPair>& pairs, TruthReport& report) {
  const HandEye motions = hand_eye(pairs, report.rotation->q_a_b);
  const auto by_truth = motions.truth.solve(), by_camera = motions.camera.solve();
  if (!by_truth || !by_camera || by_truth->x[3] <= 0.0 || by_camera->x[3] <= 0.0) return;
  const double least = by_truth->x[3], most = 1.0 / by_camera->x[3];
  const Eigen::Vector3d p = by_truth->x.head<3>(), q = most * by_camera->x.head<3>();
  const Eigen::Vector3d p_sigma = by_truth->sigma.head<3>(), q_sigma = most * by_camera->sigma.head<3>();
  report.position = 0.5 * (p + q);
  for (int axis = 0; axis < 3; ++axis)
    report.position_sigma[axis] =
        std::hypot(0.5 * (p[axis] - q[axis]), 0.5 * (p_sigma[axis] + q_sigma[axis]));
  const double relative = 0.5 * (by_truth->sigma[3] / least + by_camera->sigma[3] * most);
  const ScaleFit scale{.scale = std::sqrt(least * most),
                       .relative_sigma = std::hypot(0.5 * std::log(most / least), relative)};
  if (scale.relative_sigma <= kMostScaleSigma) report.scale = scale;
}

std::optional<BearingFit> bearing_of(const std::vector<MotionPair>& pairs, const Pose& T_c_f) {
  std::vector<Eigen::Vector2d> medians;
  std::array<std::vector<double>, 2> slopes;
  const auto finish_block = [&] {
    if (2.0 * static_cast<double>(slopes[0].size()) > kLeastMotions)
      medians.emplace_back(middle_of(slopes[0]), middle_of(slopes[1]));
    for (std::vector<double>& values : slopes) values.clear();
  };
  Timestamp start = pairs.empty() ? Timestamp{} : pairs.front().t;
  for (const auto& [t, A, B] : pairs) {
    if (seconds_between(start, t) >= kBearingBlock_s) {
      finish_block();
      start = t;
    }
    const Eigen::Vector3d a = (T_c_f * A * T_c_f.inverse()).p, b = B.p;
    const bool forward = std::abs(a.z()) > std::max(kLeastForward_m, kForward * a.norm()) &&
                         std::abs(b.z()) > kForward * b.norm();
    for (int axis = 0; forward && axis < 2; ++axis)
      slopes[static_cast<std::size_t>(axis)].push_back(a[axis] / a.z() - b[axis] / b.z());
  }
  finish_block();
  if (medians.size() < kLeastBearingBlocks) return std::nullopt;
  const auto count = static_cast<double>(medians.size());
  BearingFit fit{.sigma = Eigen::Vector2d::Zero()};
  for (const Eigen::Vector2d& median : medians) fit.slope += median / count;
  for (const Eigen::Vector2d& median : medians)
    fit.sigma += (median - fit.slope).cwiseAbs2() / (count * (count - 1.0));
  fit.sigma = fit.sigma.cwiseSqrt();
  return fit;
}

Cause truth_cause(const std::string& id, const std::string& name, const std::string& evidence,
                  const std::string& remedy) {
  return {.id = id, .name = name, .evidence = evidence, .remedy = remedy, .strength = 20.0};
}

/// The lag of the truth behind the camera, and the sensor that tells it.
struct TruthLag {
  datasets::LagFit fit;
  const char* sensor;
};

/// By the sensor that tells it better; by the images if both contradict each other, as the clock of the
/// gyroscope is then wrong.
std::optional<TruthLag> truth_lag(const TruthReport& report, const datasets::SequenceInfo& info) {
  std::optional<TruthLag> by_images, by_gyro;
  if (report.by_images) by_images = TruthLag{*report.by_images, "images"};
  if (report.by_gyro) {
    by_gyro = TruthLag{*report.by_gyro, "gyroscope"};
    by_gyro->fit.lag_s += info.rig.time_offset_s;
  }
  if (!by_images || !by_gyro) return by_images ? by_images : by_gyro;
  const datasets::LagFit &images = by_images->fit, &gyro = by_gyro->fit;
  const bool contradict =
      std::abs(images.lag_s - gyro.lag_s) > kClear * std::hypot(images.sigma_s, gyro.sigma_s);
  return contradict || images.sigma_s < gyro.sigma_s ? by_images : by_gyro;
}

std::vector<Cause> lag_causes(const TruthReport& report, const datasets::SequenceInfo& info) {
  const std::optional<TruthLag> found = truth_lag(report, info);
  const datasets::LagFit* const lag = found ? &found->fit : nullptr;
  if (lag == nullptr || std::abs(lag->lag_s) < kLeastTruthLag_s ||
      std::abs(lag->lag_s) < kClear * lag->sigma_s)
    return {};
  Cause cause = truth_cause("truth_late", "ground truth late",
                            fmt::format("its rotation is {:.1f} +- {:.1f} ms behind that of the {}",
                                        1e3 * lag->lag_s, 1e3 * lag->sigma_s, found->sensor),
                            fmt::format("subtract {:.4f} s from the stamps of the ground truth", lag->lag_s));
  cause.strength = std::abs(lag->lag_s) / lag->sigma_s;
  cause.correction = Correction{.change = [lag_s = lag->lag_s](auto& changed) {
    for (StampedPose& pose : changed.ground_truth.trajectory.poses) pose.t = after(pose.t, -lag_s);
  }};
  return {cause};
}

std::vector<Cause> frame_causes(const TruthReport& report, const datasets::SequenceInfo& info) {
  if (!report.rotation || !report.position) return {};
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  const Eigen::Vector3d turn = log_so3(report.rotation->q_a_b * T_f_c.q.conjugate());
  const Eigen::Vector3d shift = *report.position - T_f_c.p;
  double turned = 0.0, shifted = 0.0;
  Pose found = T_f_c;
  if (turn.norm() > kLeastTurn_rad) turned = turn.norm() / report.rotation->sigma_rad.norm();
  if (shift.norm() > kLeastDistance_m) shifted = shift.norm() / report.position_sigma.norm();
  if (turned < kClear && shifted < kClear) return {};
  if (turned >= kClear) found.q = report.rotation->q_a_b;
  if (shifted >= kClear) found.p = *report.position;
  Cause cause = truth_cause(
      "truth_frame", "ground truth of another coordinate frame",
      fmt::format(
          "the camera is {:.1f} deg and {:.3f} m from where the calibration says ({:.0f} and {:.0f} sigma)",
          turn.norm() * 180.0 / M_PI, shift.norm(), turned, shifted),
      fmt::format("move the ground truth: the camera is at ({:.3f}, {:.3f}, {:.3f}) m in its frame",
                  found.p.x(), found.p.y(), found.p.z()));
  cause.strength = std::max(turned, shifted);
  cause.correction =
      Correction{.change = [found](auto& changed) { changed.ground_truth.T_c_f = found.inverse(); }};
  return {cause};
}

/// The ground truth with positions averaged over 40 ms to both sides.
void smooth(std::vector<StampedPose>& poses) {
  constexpr double kHalfWindow_s = 0.04;
  const std::vector<StampedPose> before = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::size_t reach = 0;
    while (reach < i && i + reach + 1 < before.size() &&
           seconds_between(before[i - reach - 1].t, before[i].t) <= kHalfWindow_s)
      ++reach;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = i - reach; k <= i + reach; ++k) sum += before[k].T_w_f.p;
    poses[i].T_w_f.p = sum / static_cast<double>(2 * reach + 1);
  }
}

std::vector<Cause> quality_causes(const TruthReport& report) {
  std::vector<Cause> causes;
  if (report.noise_m > kLeastNoise_m) {
    causes.push_back(truth_cause("truth_noise", "ground truth noisy",
                                 fmt::format("{:.1f} mm per axis, from pose to pose", 1e3 * report.noise_m),
                                 "smooth the positions of the ground truth"));
    causes.back().correction =
        Correction{.change = [](auto& changed) { smooth(changed.ground_truth.trajectory.poses); }};
  }
  if (!report.jumps.empty()) {
    causes.push_back(
        truth_cause("truth_jump", "ground truth jumps",
                    fmt::format("{} step(s) that the neighboring ones do not have", report.jumps.size()),
                    "leave out the ground truth from the jump on"));
    causes.back().times = report.jumps;
  }
  if (report.interval_s > eval::kStrictMaxGap) {
    causes.push_back(truth_cause("truth_sparse", "ground truth sparse",
                                 fmt::format("it has one pose per {:.3g} s", report.interval_s),
                                 "export the ground truth at 10 Hz or more"));
  } else if (report.coverage < kLeastCoverage) {
    causes.push_back(truth_cause("truth_part", "ground truth of a part",
                                 fmt::format("it covers {:.0f} % of the frames", 100.0 * report.coverage),
                                 "--start and --length select a part with ground truth"));
  }
  for (Cause& cause : causes) cause.basis = CauseBasis::kShown;
  return causes;
}

/// Less strong than a lens of the run, which tells focal length and distortion, too.
std::vector<Cause> center_causes(const TruthReport& report, const datasets::SequenceInfo& info) {
  if (!report.bearing || !frame_causes(report, info).empty()) return {};
  const auto& [slope, sigma] = *report.bearing;
  const double sigmas = slope.norm() / std::max(sigma.norm(), kLeastBearing_rad / kClear);
  if (sigmas < kClear) return {};
  const Camera& camera = info.rig.camera;
  const Eigen::Vector2d center_px(camera.cx - camera.fx * slope.x(), camera.cy - camera.fy * slope.y());
  Cause cause = truth_cause(
      "center", "principal point, or a turned ground truth",
      fmt::format(
          "by images the camera moves {:.1f} deg beside the motion of the ground truth ({:.0f} sigma)",
          std::atan(slope.norm()) * 180.0 / M_PI, slope.norm() / sigma.norm()),
      fmt::format("[camera] cx = {:.2f}, cy = {:.2f} in rig.toml; if these are calibrated, calibrate the "
                  "rotation of the ground truth",
                  center_px.x(), center_px.y()));
  cause.strength = 0.5 * kClear;
  cause.correction = Correction{.change = [center_px](auto& changed) {
    changed.rig.camera.cx = center_px.x();
    changed.rig.camera.cy = center_px.y();
  }};
  return {cause};
}

std::vector<Cause> scale_causes(const TruthReport& report, const datasets::SequenceInfo& info) {
  if (!report.scale) return {};
  const auto [scale, relative_sigma] = *report.scale;
  const double difference = std::abs(std::log(scale));
  if (difference < std::max(kLeastScale, kClear * relative_sigma)) return {};
  const bool unit = scale > 3.0 || scale < 1.0 / 3.0;
  Cause cause = truth_cause(
      unit ? "depth_unit" : "depth_scale", unit ? "unit of depth" : "scale of depth",
      fmt::format("the camera moves {:.3f} +- {:.3f} times as far by the ground truth as by images and depth",
                  scale, scale * relative_sigma),
      fmt::format("[depth] scale = {:.4g} in rig.toml", info.rig.depth_units_per_m / scale));
  cause.strength = difference / relative_sigma;
  cause.correction = Correction{.depth_factor = scale};
  return {cause};
}

}  // namespace

TruthReport truth_report(const datasets::SequenceInfo& info, const RecordingSurvey& survey,
                         const Trajectory& visual) {
  TruthReport report;
  const Trajectory truth = part_of_truth(info);
  report.poses = truth.poses.size();
  report.interval_s = eval::median_pose_interval_s(truth);
  if (report.poses < 10) return report;
  double covered = 0.0;
  for (const Timestamp t : info.frame_times) covered += pose_at(truth, t) ? 1.0 : 0.0;
  report.coverage = covered / static_cast<double>(info.frame_times.size());
  report.noise_m = noise_of(truth.poses);
  report.jumps = jumps_of(truth.poses);
  const datasets::RateIntegral rates(truth);
  const std::vector<datasets::RateInterval> by_images = survey.rates();
  report.by_images = fit_lag(rates, by_images, kTruthLagRange_s);
  if (!info.imu.empty())
    report.by_gyro =
        fit_lag(rates, rates_between(datasets::RateIntegral(info.imu), info.frame_times), kTruthLagRange_s);
  const double lag_s = report.by_images ? report.by_images->lag_s : 0.0;
  const std::vector<MotionPair> pairs = motion_pairs(truth, visual, lag_s);
  report.bearing = bearing_of(pairs, info.ground_truth.T_c_f);
  if (!report.by_images) return report;
  report.rotation = fit_rotation(rate_pairs(rates, by_images, lag_s));
  add_hand_eye(pairs, report);
  return report;
}

std::vector<Cause> truth_causes(const TruthReport& report, const datasets::SequenceInfo& info) {
  std::vector<Cause> causes;
  if (report.poses == 0) return causes;
  for (const auto& more : {lag_causes(report, info), frame_causes(report, info), center_causes(report, info),
                           quality_causes(report), scale_causes(report, info)})
    causes.insert(causes.end(), more.begin(), more.end());
  return causes;
}

std::vector<std::string> undetermined_of_truth(const TruthReport& report) {
  std::vector<std::string> missing;
  if (!report.by_images && !report.by_gyro) missing.emplace_back("clock");
  if (!report.rotation || report.rotation->sigma_rad.norm() > kMostTurnSigma_rad || !report.position ||
      report.position_sigma.norm() > kMostPositionSigma_m)
    missing.emplace_back("coordinate frame");
  if (!report.scale) missing.emplace_back("scale");
  return missing;
}

std::string truth_table_header() {
  return fmt::format("{:<24} {:>7} {:>6} {:>16} {:>16} {:>14} {:>14} {:>14} {:>6}\n", "sequence", "covered",
                     "noise", "late, images", "late, gyroscope", "camera turned", "camera moved", "scale",
                     "jumps") +
         fmt::format("{:<24} {:>7} {:>6} {:>16} {:>16} {:>14} {:>14} {:>14} {:>6}\n", "", "%", "mm", "ms",
                     "ms", "deg", "mm", "%", "");
}

std::string truth_table_row(const std::string& name, const TruthReport& report,
                            const datasets::SequenceInfo& info) {
  if (report.poses == 0)
    return fmt::format("{:<24} no ground truth{}\n", name,
                       info.ground_truth.trajectory.poses.empty() ? "" : " at the time of the images");
  const auto lag_text = [](const std::optional<datasets::LagFit>& lag) {
    return lag ? fmt::format("{:+.1f} +- {:.1f}", 1e3 * lag->lag_s, 1e3 * lag->sigma_s) : std::string("n/a");
  };
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  std::string turned = "n/a", moved = "n/a", scale = "n/a";
  if (report.rotation)
    turned = fmt::format("{:.2f} +- {:.2f}", report.rotation->q_a_b.angularDistance(T_f_c.q) * 180.0 / M_PI,
                         report.rotation->sigma_rad.norm() * 180.0 / M_PI);
  if (report.position) {
    moved = fmt::format("{:.0f} +- {:.0f}", 1e3 * (*report.position - T_f_c.p).norm(),
                        1e3 * report.position_sigma.norm());
  }
  if (report.scale)
    scale = fmt::format("{:+.1f} +- {:.1f}", 100.0 * (report.scale->scale - 1.0),
                        100.0 * report.scale->scale * report.scale->relative_sigma);
  return fmt::format("{:<24} {:>7.1f} {:>6.2f} {:>16} {:>16} {:>14} {:>14} {:>14} {:>6}\n", name,
                     100.0 * report.coverage, 1e3 * report.noise_m, lag_text(report.by_images),
                     lag_text(report.by_gyro), turned, moved, scale, report.jumps.size());
}

}  // namespace stillpoint::bench
