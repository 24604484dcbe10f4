// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/gyro_check.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/so3.h"
#include "datasets/angular_rates.h"
#include "datasets/sequence_plausibility.h"
#include "eval/io/nmea_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kWindow_s = 1.0;
constexpr std::size_t kLeastWindows = 5;
constexpr double kLeastRate = 0.05;  ///< of a window with rotation [rad/s]
constexpr double kMostRelativeDifference = 0.2;
constexpr double kLagRange_s = 0.2;
constexpr double kLeastLag_s = 0.02;
constexpr double kSigmas = 4.0;
constexpr double kBetterLag = 0.8;    ///< residual with a lag to that without; noise remains
constexpr double kBetterFit = 0.5;    ///< residual with an explanation to that without
constexpr double kLeastFactor = 1.3;  ///< of the rates
constexpr double kDegree = M_PI / 180.0;

/// The rates of a sensor in the body frame, and those of the truth.
struct Rates {
  RateIntegral gyro;
  RateIntegral truth;
  Eigen::Matrix3d R_b_f;  ///< f: frame of the truth
  double offset_s = 0.0;  ///< stated, of the gyroscope

  /// Pairs (gyroscope, truth) between successive times, without the mean difference.
  [[nodiscard]] std::vector<RatePair> pairs(std::span<const Timestamp> times) const {
    std::vector<RatePair> result = rate_pairs(gyro, intervals(times), offset_s);
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();
    for (const RatePair& pair : result) bias += (pair.a - pair.b) / static_cast<double>(result.size());
    for (RatePair& pair : result) pair.a -= bias;
    return result;
  }

  /// Of the truth, in the body frame.
  [[nodiscard]] std::vector<RateInterval> intervals(std::span<const Timestamp> times) const {
    std::vector<RateInterval> result = rates_between(truth, times);
    for (RateInterval& interval : result) interval.rate = R_b_f * interval.rate;
    return result;
  }
};

std::vector<Timestamp> times_of_windows(const SequenceInfo& info) {
  const std::vector<StampedPose>& poses = info.ground_truth.trajectory.poses;
  const Timestamp end = std::min(poses.back().t, after(info.imu.back().t, -info.rig.time_offset_s));
  std::vector<Timestamp> times;
  for (Timestamp t = std::max(poses.front().t, after(info.imu.front().t, -info.rig.time_offset_s)); t <= end;
       t = after(t, kWindow_s))
    times.push_back(t);
  return times;
}

/// The pairs with rotation by one of both sensors: at rest, noise differs from noise.
std::vector<RatePair> moving(std::vector<RatePair> pairs) {
  std::erase_if(pairs,
                [](const RatePair& pair) { return std::max(pair.a.norm(), pair.b.norm()) < kLeastRate; });
  return pairs;
}

/// Root mean square of the angle of vectors of rate over a window [deg].
template <class Vector>
double rms_deg(std::span<const RatePair> pairs, const Vector& vector_of) {
  double squares = 0.0;
  for (const RatePair& pair : pairs)
    squares += vector_of(pair).squaredNorm() / static_cast<double>(pairs.size());
  return std::sqrt(squares) * kWindow_s / kDegree;
}

/// The lag of the truth, if it makes the rates between images agree better.
std::optional<std::string> lag_text(const Rates& rates, const SequenceInfo& info) {
  const std::vector<RateInterval> by_truth = rates.intervals(info.frame_times);
  const std::optional<LagFit> fit = fit_lag(rates.gyro, by_truth, kLagRange_s);
  if (!fit) return std::nullopt;
  const double late_s = rates.offset_s - fit->lag_s;
  if (std::abs(late_s) < std::max(kLeastLag_s, kSigmas * fit->sigma_s)) return std::nullopt;
  const double without = fit_rotation(rate_pairs(rates.gyro, by_truth, rates.offset_s)).residual;
  if (fit->residual > kBetterLag * without) return std::nullopt;
  return fmt::format(
      "the ground truth is {:.0f} ms {}: over {} intervals between images the rates differ by {:.0f} % with "
      "this lag, by {:.0f} % without; are the clocks offset?",
      1e3 * std::abs(late_s), late_s > 0.0 ? "late" : "early", by_truth.size(), 100.0 * fit->residual,
      100.0 * without);
}

/// What makes the rates between images agree; empty if nothing does.
std::string explanation_of(const std::vector<RatePair>& pairs) {
  const double stated = relative_residual(pairs, Eigen::Matrix3d::Identity());
  const double factor = rate_ratio(pairs);
  std::vector<RatePair> scaled = pairs;
  for (RatePair& pair : scaled) pair.a /= factor;
  if (std::abs(std::log(factor)) > std::log(kLeastFactor) &&
      relative_residual(scaled, Eigen::Matrix3d::Identity()) < kBetterFit * stated)
    return fmt::format("the gyroscope turns {:.2f} times as far; is its unit another one than rad/s?",
                       factor);
  const auto with_axes = [&](const Eigen::Matrix3d& P) { return relative_residual(pairs, P.transpose()); };
  const auto& all = axis_permutations();
  const Eigen::Matrix3d& best = *std::ranges::min_element(all, {}, with_axes);
  const RotationFit fit = fit_rotation(pairs);
  if (with_axes(best) < kBetterFit * stated && with_axes(best) < fit.residual + 0.05)
    return "both agree with the axes " + permutation_text(best) +
           " of the gyroscope; are its columns in order?";
  if (fit.residual < kBetterFit * stated)
    return fmt::format(
        "both agree if one is turned by {:.0f} deg; is T_b_c, or the frame of the ground truth, another one?",
        log_so3(fit.q_a_b).norm() / kDegree);
  return "are they of the same recording and frame?";
}

}  // namespace

std::optional<std::string> gyro_truth_finding(const SequenceInfo& info) {
  const Trajectory& truth = info.ground_truth.trajectory;
  if (info.imu.size() < 2 || truth.poses.size() < 2 || truth.frame == eval::kGnssFrame) return std::nullopt;
  const Rates rates{.gyro = RateIntegral(info.imu),
                    .truth = RateIntegral(truth),
                    .R_b_f = (info.rig.T_b_c.q * info.ground_truth.T_c_f.q).toRotationMatrix(),
                    .offset_s = info.rig.time_offset_s};
  const std::vector<RatePair> windows = moving(rates.pairs(times_of_windows(info)));
  const bool turns = std::ranges::any_of(windows, [](const RatePair& pair) { return pair.b.norm() > 1e-9; });
  if (windows.size() < kLeastWindows || !turns || is_degrees_ratio(rate_ratio(windows))) return std::nullopt;
  const std::optional<std::string> lag = lag_text(rates, info);
  const std::string remedy = " `stillpoint diagnose --truth` measures axes and clocks";
  if (relative_residual(windows, Eigen::Matrix3d::Identity()) < kMostRelativeDifference)
    return lag ? std::optional(*lag + remedy) : std::nullopt;
  return fmt::format(
             "over {} windows of 1 s, the rotation by the gyroscope differs by {:.1f} deg (RMS) from that of "
             "the ground truth, which is {:.1f} deg: ",
             windows.size(), rms_deg(windows, [](const RatePair& pair) { return pair.a - pair.b; }),
             rms_deg(windows, [](const RatePair& pair) { return pair.b; })) +
         lag.value_or(
             explanation_of(rate_pairs(rates.gyro, rates.intervals(info.frame_times), rates.offset_s))) +
         remedy;
}

}  // namespace stillpoint::datasets
