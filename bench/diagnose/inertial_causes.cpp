// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/inertial_causes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/diagnose/evidence/accelerometer_axes.h"
#include "core/base/counted.h"
#include "core/geometry/so3.h"
#include "datasets/sequence_plausibility.h"

namespace stillpoint::bench {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kGravity = 9.80665;
constexpr double kLagRange_s = 0.2;
constexpr double kLeastLag_s =
    0.005;  ///< the motion between images is that of their brightness, not of points
constexpr double kSignificant = 4.0;  ///< standard deviations
constexpr double kOtherAxes = 0.7;    ///< residual without permutation of axes, else they are right
constexpr double kRightAxes = 0.2;    ///< residual of axes that are right, up to a few degrees
constexpr double kAsGood = 1.05;      ///< residual of axes that the motion does not tell from the best ones
constexpr double kBetterAxes = 0.6;   ///< residual with it, relative to that without
constexpr double kLeastRate = 0.02;   ///< of the rotation that tells the unit [rad/s]
constexpr double kLeastAngle_rad = 1.0 * kDegree;
constexpr double kAlignmentError_rad = 0.2 * kDegree;  ///< of the motion between images
constexpr double kDownward = -0.95;                    ///< upward part of a specific force downward
constexpr double kMostSigma_rad = 3.0 * kDegree;       ///< of an observed axis

void scale_gyro(datasets::SequenceInfo& info, double factor) {
  for (ImuSample& sample : info.imu) sample.gyro_b *= factor;
}

void scale_accel(datasets::SequenceInfo& info, double factor) {
  for (ImuSample& sample : info.imu) sample.accel_b *= factor;
}

double mean_accel(const datasets::SequenceInfo& info) {
  double sum = 0.0;
  for (const ImuSample& sample : info.imu) sum += sample.accel_b.norm();
  return sum / static_cast<double>(info.imu.size());
}

double rms_rate(std::span<const datasets::RatePair> pairs) {
  double squares = 0.0;
  for (const datasets::RatePair& pair : pairs)
    squares += pair.b.squaredNorm() / static_cast<double>(pairs.size());
  return std::sqrt(squares);
}

/// Norm of the mean acceleration of each second relative to the mean of the norms: near 1 with gravity, in
/// any unit.
double steady_ratio(const datasets::SequenceInfo& info) {
  constexpr double kSteadyTime_s = 1.0;
  double means = 0.0, norms = 0.0;
  for (auto begin = info.imu.begin(); begin != info.imu.end();) {
    const auto end = std::find_if(begin, info.imu.end(), [&](const ImuSample& sample) {
      return seconds_between(begin->t, sample.t) >= kSteadyTime_s;
    });
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; begin != end; ++begin) {
      sum += begin->accel_b;
      norms += begin->accel_b.norm();
    }
    means += sum.norm();
  }
  return norms > 0.0 ? means / norms : 0.0;
}

/// Accelerations of a phone's attitude filter, from which gravity was subtracted.
std::optional<Cause> missing_gravity(const datasets::SequenceInfo& info) {
  constexpr double kLeastMean = 0.7 * kGravity;
  constexpr double kLeastRatio = 0.7;  // renderings: 0.96 or more with gravity, 0.05 to 0.38 without
  const double mean = mean_accel(info);
  const double ratio = steady_ratio(info);
  if (mean >= kLeastMean || ratio >= kLeastRatio) return std::nullopt;
  return Cause{
      .id = "accel_gravity",
      .name = "accelerations without gravity",
      .evidence =
          fmt::format("the mean acceleration is {:.3g} m/s^2, and over a second {:.0f} % of it remain; "
                      "a sensor measures gravity, {:.3g} m/s^2, in one direction",
                      mean, 100.0 * ratio, kGravity),
      .remedy =
          "record the accelerations with gravity, as the accelerometer measures them, or run without "
          "the IMU (--variant vo)",
      .strength = 1000.0,
      .correction = Correction{.change =
                                   [](auto& changed) {
                                     changed.imu.clear();
                                     changed.rig.has_imu = false;
                                   },
                               .settings = {"imu.enabled=false"}}};
}

/// Gyroscope in deg/s, accelerometer in g or mg, or without gravity.
std::vector<Cause> unit_causes(const datasets::SequenceInfo& info, const datasets::RateIntegral& gyro,
                               std::span<const datasets::RateInterval> by_images) {
  std::vector<Cause> causes;
  const std::vector<datasets::RatePair> pairs = rate_pairs(gyro, by_images, info.rig.time_offset_s);
  const double ratio = rate_ratio(pairs);
  if (pairs.size() >= 15 && rms_rate(pairs) > kLeastRate && datasets::is_degrees_ratio(ratio)) {
    causes.push_back(
        {.id = "gyro_unit",
         .name = "gyroscope in deg/s",
         .evidence = fmt::format("its rates are {:.1f} times the rotation between images", ratio),
         .remedy = "convert the angular rates of the file to rad/s (times 0.01745329)",
         .strength = 1000.0,
         .correction = Correction{.change = [](auto& changed) { scale_gyro(changed, kDegree); }}});
  }
  if (std::optional<Cause> without_gravity = missing_gravity(info)) {
    causes.push_back(std::move(*without_gravity));
    return causes;
  }
  const double mean = mean_accel(info);
  for (const auto& [unit, factor] : {std::pair("g", kGravity), std::pair("mg", 0.001 * kGravity)}) {
    if (std::abs(mean * factor - kGravity) > 0.3 * kGravity) continue;
    causes.push_back(
        {.id = "accel_unit",
         .name = fmt::format("accelerometer in {}", unit),
         .evidence = fmt::format("the mean acceleration is {:.4g}, gravity {:.4g}", mean, kGravity),
         .remedy = fmt::format("convert the accelerations of the file to m/s^2 (times {:g})", factor),
         .strength = 1000.0,
         .correction =
             Correction{.change = [factor = factor](auto& changed) { scale_accel(changed, factor); }}});
  }
  return causes;
}

/// Which samples a permutation of axes concerns.
enum class PermutedSensor { kGyro, kAccel, kBoth };

Cause axes_cause(const Eigen::Matrix3d& P, PermutedSensor sensor, const std::string& evidence) {
  const bool gyro = sensor != PermutedSensor::kAccel, accel = sensor != PermutedSensor::kGyro;
  const char* const name = gyro && accel ? "IMU" : gyro ? "gyroscope" : "accelerometer";
  const char* const id = gyro && accel ? "imu_axes" : gyro ? "gyro_axes" : "accel_axes";
  return {.id = id,
          .name = fmt::format("axes of the {} swapped or inverted", name),
          .evidence = evidence,
          .remedy = gyro && accel && P.determinant() > 0.0
                        ? fmt::format("turn T_b_c in [imu] of rig.toml by the axes {}",
                                      datasets::permutation_text(P))
                        : fmt::format("reorder the columns of the file: {}", datasets::permutation_text(P)),
          .strength = kFundamental,
          .correction = Correction{.change = [P, gyro, accel](auto& changed) {
            for (ImuSample& sample : changed.imu) {
              if (gyro) sample.gyro_b = P * sample.gyro_b;
              if (accel) sample.accel_b = P * sample.accel_b;
            }
          }}};
}

Cause accel_axes_cause(const AccelerometerAxes& axes) {
  return axes_cause(
      axes.P, PermutedSensor::kAccel,
      fmt::format("the accelerometer follows the motion {} with a correlation of {:.2f}, "
                  "{:.2f} with it",
                  axes.by_truth ? "of the ground truth" : "between images", axes.stated, axes.correlation));
}

std::string matrix_text(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return fmt::format("[{:.5g}]", fmt::join(rows.data(), rows.data() + 16, ", "));
}

Cause extrinsics_cause(const std::string& id, const std::string& name, const std::string& evidence,
                       const Pose& T_b_c) {
  return {.id = id,
          .name = name,
          .evidence = evidence,
          .remedy = "[imu] T_b_c = " + matrix_text(T_b_c) + " in rig.toml",
          .strength = kFundamental,
          .correction = Correction{.change = [T_b_c](auto& changed) { changed.rig.T_b_c = T_b_c; }}};
}

/// The simplest permutation by whose residual no other one is clearly better: axes without rotation do not
/// tell their order. All signs inverted, then single signs, swapped axes, and those with other signs.
Eigen::Matrix3d simplest_permutation(const std::function<double(const Eigen::Matrix3d&)>& residual_with) {
  const auto& all = datasets::axis_permutations();
  std::array<double, 48> residuals{};
  std::ranges::transform(all, residuals.begin(), residual_with);
  const double smallest = *std::ranges::min_element(residuals);
  const auto complexity = [&](const Eigen::Matrix3d& P) {
    const bool signs_differ = std::abs(P.sum()) < 3.0;
    return 3.0 - P.diagonal().cwiseAbs().sum() + (signs_differ ? 0.5 : 0.0) +
           (signs_differ && P.determinant() < 0.0 ? 0.25 : 0.0);
  };
  std::size_t best = all.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (residuals[i] > kAsGood * smallest) continue;
    if (best == all.size() || complexity(all[i]) < complexity(all[best])) best = i;
  }
  return all[best];
}

/// Swapped or inverted axes, the inverse of the extrinsics, mirrored images: all that makes the gyroscope
/// follow the images much better than with the stated calibration.
/// @param at_offsets pairs at the stated time offset, and at that which fits best with any rotation: half a
/// period of a vibration later a gyroscope with inverted axes looks right
/// @param accel other axes that the accelerometer has
std::vector<Cause> axes_causes(const datasets::SequenceInfo& info,
                               const std::array<std::vector<datasets::RatePair>, 2>& at_offsets,
                               const std::optional<AccelerometerAxes>& accel) {
  const Eigen::Matrix3d R_b_c = info.rig.T_b_c.R();
  const auto residual = [&](const Eigen::Matrix3d& R) {
    return std::min(relative_residual(at_offsets[0], R), relative_residual(at_offsets[1], R));
  };
  const double stated = residual(R_b_c);
  if (stated < kRightAxes) return {};
  std::vector<Cause> causes;
  const auto residual_with = [&](const Eigen::Matrix3d& P) { return residual(P.transpose() * R_b_c); };
  Eigen::Matrix3d best = simplest_permutation(residual_with);
  double smallest = residual_with(best);
  const bool both = accel && residual_with(accel->P) < std::max(kRightAxes, kAsGood * smallest);
  if (both) {
    best = accel->P;
    smallest = residual_with(best);
  }
  const auto evidence = [&](double with_it) {
    return fmt::format(
        "the gyroscope differs from the rotation between images by {:.0f} %, by {:.0f} % with it",
        100.0 * stated, 100.0 * with_it);
  };
  if (smallest < kBetterAxes * stated) {
    causes.push_back(axes_cause(best, PermutedSensor::kBoth, evidence(smallest)));
    if (!both) causes.push_back(axes_cause(best, PermutedSensor::kGyro, evidence(smallest)));
    // The sensor whose axes are right by the accelerometer is tried last.
    causes[accel ? 0 : 1].strength += 10.0;
  }
  const double inverse = residual(R_b_c.transpose());
  if (inverse < kBetterAxes * stated)
    causes.push_back(extrinsics_cause("extrinsics_inverse", "inverse of T_b_c stated", evidence(inverse),
                                      info.rig.T_b_c.inverse()));
  const double mirrored = residual(R_b_c * Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal());
  if (mirrored < kBetterAxes * stated)
    causes.push_back({.id = "mirrored",
                      .name = "images mirrored left to right",
                      .evidence = evidence(mirrored),
                      .remedy = "record or export the images and depth again without mirroring",
                      .strength = kFundamental,
                      .correction = Correction{.mirrored = true}});
  return causes;
}

/// A rotation of the camera on the body other than the stated one, by rates of a sensor in its frame.
std::vector<Cause> rotation_causes(const datasets::SequenceInfo& info,
                                   const std::vector<datasets::RatePair>& pairs,
                                   const std::string& sensor = "images") {
  const datasets::RotationFit fit = fit_rotation(pairs);
  const Eigen::Quaterniond stated = info.rig.T_b_c.q;
  Eigen::Vector3d difference = log_so3(fit.q_a_b * stated.conjugate());
  if (fit.residual > kOtherAxes || relative_residual(pairs, stated.toRotationMatrix()) < fit.residual)
    return {};
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (fit.sigma_rad[i] > kMostSigma_rad) difference[i] = 0.0;
    largest = std::max(largest, std::abs(difference[i]) / std::hypot(fit.sigma_rad[i], kAlignmentError_rad));
  }
  if (largest < kSignificant || difference.norm() < kLeastAngle_rad) return {};
  Pose T_b_c = info.rig.T_b_c;
  T_b_c.q = (exp_so3(difference) * stated).normalized();
  Cause cause = extrinsics_cause("extrinsics_rotation", "camera rotation on the body",
                                 fmt::format("by gyroscope and {} it is {:.2f} deg off ({:.0f} sigma)",
                                             sensor, difference.norm() / kDegree, largest),
                                 T_b_c);
  cause.strength = largest;
  return {cause};
}

/// The center whose error turns the view as the rotation of the camera by images does, if that is not about
/// the optical axis. Weaker than a center that the run or the ground truth tells.
std::vector<Cause> center_beside_rotation(const datasets::SequenceInfo& info,
                                          const std::vector<datasets::RatePair>& pairs) {
  constexpr double kMostOfWidth = 0.05;  // of the image, by which the center of a lens may be off
  const datasets::RotationFit fit = fit_rotation(pairs);
  const Eigen::Matrix3d R_c_b = info.rig.T_b_c.R().transpose();
  const Eigen::Vector3d turn_c = R_c_b * log_so3(fit.q_a_b * info.rig.T_b_c.q.conjugate());
  const double sigma_z_rad =
      std::hypot(R_c_b.row(2).transpose().cwiseProduct(fit.sigma_rad).norm(), kAlignmentError_rad);
  const Camera& camera = info.rig.camera;
  const Eigen::Vector2d error_px(camera.fx * turn_c.y(), -camera.fy * turn_c.x());
  if (std::abs(turn_c.z()) > kSignificant * sigma_z_rad || error_px.norm() > kMostOfWidth * camera.width)
    return {};
  const Eigen::Vector2d center_px = Eigen::Vector2d(camera.cx, camera.cy) - error_px;
  return {{.id = "center",
           .name = "principal point",
           .evidence =
               fmt::format("off by ({:+.1f}, {:+.1f}) px it turns the view as the camera rotation does, and "
                           "this run does not observe it",
                           error_px.x(), error_px.y()),
           .remedy = fmt::format("[camera] cx = {:.2f}, cy = {:.2f} in rig.toml, if these are not calibrated",
                                 center_px.x(), center_px.y()),
           .strength = 1.0,
           .correction = Correction{.change = [center_px](auto& changed) {
             changed.rig.camera.cx = center_px.x();
             changed.rig.camera.cy = center_px.y();
           }}}};
}

/// By the rates of the ground truth, where those of the images are too noisy to tell, but agree.
std::vector<Cause> rotation_by_truth(const datasets::SequenceInfo& info, const datasets::RateIntegral& gyro,
                                     const std::vector<datasets::RatePair>& by_images) {
  std::vector<datasets::RateInterval> by_truth =
      rates_between(datasets::RateIntegral(info.ground_truth.trajectory), info.frame_times);
  for (datasets::RateInterval& interval : by_truth) interval.rate = info.ground_truth.T_c_f.q * interval.rate;
  const std::vector<datasets::RatePair> pairs = rate_pairs(gyro, by_truth, info.rig.time_offset_s);
  const datasets::RotationFit fit = fit_rotation(pairs);
  const bool images_agree = relative_residual(by_images, fit.q_a_b.toRotationMatrix()) <
                            relative_residual(by_images, info.rig.T_b_c.R());
  const double stated = relative_residual(pairs, info.rig.T_b_c.R());
  const bool explains = fit.residual < std::min(kRightAxes, kBetterAxes * stated);  // a vibration remains
  return explains && images_agree ? rotation_causes(info, pairs, "ground truth") : std::vector<Cause>{};
}

std::vector<Cause> clock_causes(const datasets::SequenceInfo& info, const datasets::LagFit& fit) {
  const double difference_s = fit.lag_s - info.rig.time_offset_s;
  const double sigmas = std::abs(difference_s) / fit.sigma_s;
  if (std::abs(difference_s) < kLeastLag_s || sigmas < kSignificant) return {};
  const double offset_s = fit.lag_s;
  return {{.id = "time_offset",
           .name = "clocks of camera and IMU offset",
           .evidence = fmt::format("the gyroscope follows the images {:+.1f} +- {:.1f} ms later than stated",
                                   1e3 * difference_s, 1e3 * fit.sigma_s),
           .remedy = fmt::format("[imu] time_offset_s = {:.4f} in rig.toml", offset_s),
           .strength = sigmas,
           .correction =
               Correction{.change = [offset_s](auto& changed) { changed.rig.time_offset_s = offset_s; }}}};
}

double drift_sigmas(const datasets::LagFit& fit) { return std::abs(fit.drift_ppm) / fit.drift_sigma_ppm; }

/// A lag that changes by more than a constant one may be wrong.
std::vector<Cause> drift_causes(const datasets::SequenceInfo& info, const datasets::LagFit& fit) {
  const Timestamp first = info.frame_times.front();
  const double duration_s = seconds_between(first, info.frame_times.back());
  const double rate = 1e-6 * fit.drift_ppm, sigmas = drift_sigmas(fit);
  if (std::abs(rate) * duration_s < kLeastLag_s || sigmas < kSignificant) return {};
  return {{.id = "clock_drift",
           .name = "clocks of camera and IMU drifting",
           .evidence = fmt::format("the gyroscope gets {:.0f} +- {:.0f} ms later per minute", 6e4 * rate,
                                   6e-2 * fit.drift_sigma_ppm),
           .remedy =
               fmt::format("divide the time since the start by {:.6f} in the stamps of the IMU", 1.0 + rate),
           .strength = sigmas,
           .correction = Correction{.change = [rate, lag_s = fit.lag_s, duration_s](auto& changed) {
             // The lag of the fit is that of the middle, and becomes that of the whole.
             const Timestamp middle = after(changed.frame_times.front(), 0.5 * duration_s);
             for (ImuSample& sample : changed.imu)
               sample.t = after(sample.t, -rate * seconds_between(middle, sample.t));
             changed.rig.time_offset_s = lag_s;
           }}}};
}

/// Number of samples at the largest absolute value of an axis, of the axis with the most.
std::size_t clipped_samples(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*sensor) {
  std::size_t most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double largest = 0.0;
    for (const ImuSample& sample : samples) largest = std::max(largest, std::abs((sample.*sensor)[axis]));
    const auto count = std::ranges::count_if(samples, [&](const ImuSample& sample) {
      return largest > 0.0 && std::abs((sample.*sensor)[axis]) >= largest;
    });
    most = std::max(most, static_cast<std::size_t>(count));
  }
  return most;
}

Cause sample_cause(const std::string& id, const std::string& name, const std::string& evidence,
                   double strength) {
  return {.id = id,
          .name = name,
          .evidence = evidence,
          .remedy = "record again with another rate or range, or run without the IMU",
          .strength = strength,
          .correction = Correction{.settings = {"imu.enabled=false"}},
          .basis = CauseBasis::kShown};
}

/// Samples during the frames.
std::vector<ImuSample> used_samples(const datasets::SequenceInfo& info) {
  std::vector<ImuSample> used;
  for (const ImuSample& sample : info.imu) {
    if (sample.t >= info.frame_times.front() && sample.t <= info.frame_times.back()) used.push_back(sample);
  }
  return used;
}

std::vector<Cause> sample_causes(const datasets::SequenceInfo& info) {
  constexpr double kGap_s = 0.05, kLeastRate_hz = 80.0, kMostJitter = 0.15;
  constexpr std::size_t kMostClippedSamples = 8;
  const std::vector<ImuSample> samples = used_samples(info);
  std::vector<Cause> causes;
  if (samples.size() < 100) return causes;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i)
    intervals.push_back(seconds_between(samples[i - 1].t, samples[i].t));
  std::vector<double> sorted = intervals;
  std::ranges::sort(sorted);
  const double typical = sorted[sorted.size() / 2];
  const auto gaps =
      std::ranges::count_if(intervals, [&](double x) { return x > std::max(kGap_s, 3.0 * typical); });
  if (gaps > 0)
    causes.push_back(sample_cause("imu_gap", "inertial samples missing",
                                  fmt::format("{} gap(s), the longest {:.3f} s", gaps, sorted.back()),
                                  100.0));
  const double rate_hz =
      static_cast<double>(samples.size()) / seconds_between(samples.front().t, samples.back().t);
  if (1.0 / typical < kLeastRate_hz)
    causes.push_back(sample_cause("imu_rate", "few inertial samples",
                                  fmt::format("{:.0f} per second, 100 to 400 are usual", rate_hz), 50.0));
  const double spread = sorted[sorted.size() * 9 / 10] - sorted[sorted.size() / 10];
  if (spread > kMostJitter * typical)
    causes.push_back(
        sample_cause("imu_jitter", "stamps of inertial samples are noisy",
                     fmt::format("80 % of the intervals are within {:.2f} ms, their median is {:.2f} ms",
                                 1e3 * spread, 1e3 * typical),
                     spread / typical));
  for (const auto& [id, name, sensor] :
       {std::tuple("gyro_saturated", "gyroscope saturated", &ImuSample::gyro_b),
        std::tuple("accel_saturated", "accelerometer saturated", &ImuSample::accel_b)}) {
    const std::size_t clipped = clipped_samples(samples, sensor);
    if (clipped > kMostClippedSamples)
      causes.push_back(sample_cause(id, name,
                                    fmt::format("{} with the largest value of the axis",
                                                counted(static_cast<std::size_t>(clipped), "sample")),
                                    100.0));
  }
  return causes;
}

/// The scale of the motion between images, by the accelerometer.
std::vector<Cause> depth_scale_causes(const datasets::SequenceInfo& info, const RecordingSurvey& survey) {
  constexpr double kLeastDifference = 0.03;  ///< accuracy on recorded motion
  const std::optional<InertialScale> found = inertial_depth_scale(info, survey);
  if (!found || std::abs(found->scale - 1.0) < std::max(kLeastDifference, kSignificant * found->sigma))
    return {};
  const double scale = found->scale;
  const bool unit = scale > 3.0 || scale < 1.0 / 3.0;
  return {{.id = unit ? "depth_unit" : "depth_scale",
           .name = unit ? "unit of depth" : "scale of depth",
           .evidence = fmt::format(
               "the camera moves {:.3f} +- {:.3f} times as far by the accelerometer as by images and depth",
               scale, found->sigma),
           .remedy = fmt::format("[depth] scale = {:.4g} in rig.toml", info.rig.depth_units_per_m / scale),
           .strength = std::abs(scale - 1.0) / found->sigma,
           .correction = Correction{.depth_factor = scale}}};
}

}  // namespace

std::vector<Cause> inertial_causes(const datasets::SequenceInfo& info, const RecordingSurvey& survey) {
  if (info.imu.empty()) return {};
  const datasets::RateIntegral gyro(info.imu);
  const std::vector<datasets::RateInterval> by_images = survey.rates();
  std::vector<Cause> causes = unit_causes(info, gyro, by_images);
  if (!causes.empty()) return causes;
  const auto add = [&](const std::vector<Cause>& more) {
    causes.insert(causes.end(), more.begin(), more.end());
  };
  add(sample_causes(info));
  const std::optional<datasets::LagFit> lag = fit_lag(gyro, by_images, kLagRange_s);
  const bool lag_is_known = lag && (lag->sigma_s < kLeastLag_s || drift_sigmas(*lag) > kSignificant);
  const std::vector<datasets::RatePair> pairs =
      rate_pairs(gyro, by_images, lag_is_known ? lag->lag_s : info.rig.time_offset_s);
  const std::optional<AccelerometerAxes> accel_axes = accelerometer_axes(info, survey);
  const std::vector<Cause> axes =
      axes_causes(info, {rate_pairs(gyro, by_images, info.rig.time_offset_s), pairs}, accel_axes);
  add(axes);
  if (axes.empty()) {
    const std::vector<Cause> turned = rotation_causes(info, pairs);
    add(turned.empty() ? rotation_by_truth(info, gyro, pairs) : turned);
    if (!turned.empty()) add(center_beside_rotation(info, pairs));
  }
  if (lag) {
    add(clock_causes(info, *lag));
    add(drift_causes(info, *lag));
  }
  add(depth_scale_causes(info, survey));
  if (accel_axes) {
    const auto has = [&](const char* id) { return std::ranges::find(axes, id, &Cause::id) != axes.end(); };
    const bool are_those_of_imu = has("imu_axes") && !has("gyro_axes");
    if (!are_those_of_imu && !accel_axes->gyroscope_too) add({accel_axes_cause(*accel_axes)});
  } else if (const auto up = upward_part_of_force(info); up && *up < kDownward) {
    causes.push_back(
        axes_cause(-Eigen::Matrix3d::Identity(), PermutedSensor::kAccel,
                   "at rest it would measure an acceleration downward, by the ground truth (if its "
                   "z axis points up)"));
    causes.back().strength = 100.0;  // unlike the motion between images, by a convention
  }
  return causes;
}

namespace {

/// Median of the rates that the gyroscope measures beside those between images, by axis [rad/s].
Eigen::Vector3d gyro_bias(const datasets::SequenceInfo& info, const RecordingSurvey& survey) {
  const std::vector<datasets::RatePair> pairs =
      rate_pairs(datasets::RateIntegral(info.imu), survey.rates(), info.rig.time_offset_s);
  const Eigen::Matrix3d R_b_c = info.rig.T_b_c.R();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3 && !pairs.empty(); ++axis) {
    std::vector<double> differences;
    for (const datasets::RatePair& pair : pairs) differences.push_back((pair.a - R_b_c * pair.b)[axis]);
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::ranges::nth_element(differences, middle);
    bias[axis] = *middle;
  }
  return bias;
}

}  // namespace

std::vector<Cause> start_causes(const datasets::SequenceInfo& info, const RecordingSurvey& survey) {
  constexpr double kRest_s = 1.0, kSettled_s = 2.0;
  constexpr double kLeastSpeed_mps = 0.05, kLeastRate_radps = 0.05;  // of hands that hold a camera still
  constexpr double kLargeBias_radps = 0.1;   // EuRoC has 0.08, phones and cameras 0.02 at most
  constexpr double kBiasSigma_radps = 0.01;  // of the difference of both rates
  constexpr double kClearEffect = 0.7;       // errors in 2 of 8 s that are 2.3 times those of the others
  if (info.imu.empty() || survey.frames.empty()) return {};
  Cause cause{.id = "standing_start",
              .name = "standing start missing",
              .remedy = "let the camera rest for 2 s at the start, or leave the start out by --start",
              .strength = 0.5,
              .basis = CauseBasis::kInferred,
              .needs_effect = true,
              .largest_ratio = kClearEffect};
  double seconds = 0.0, path_m = 0.0, angle_rad = 0.0;
  const Timestamp first = survey.frames.front().t;
  for (std::size_t i = 0; i < survey.frames.size(); ++i) {
    const FrameStatistics& frame = survey.frames[i];
    if (frame.t > after(first, kSettled_s)) break;
    cause.times.push_back(frame.t);
    if (i == 0 || !frame.T_now_last || frame.t > after(first, kRest_s)) continue;
    seconds += seconds_between(survey.frames[i - 1].t, frame.t);
    path_m += frame.T_now_last->p.norm();
    angle_rad += log_so3(frame.T_now_last->q).norm();
  }
  if (seconds <= 0.0 || (path_m < kLeastSpeed_mps * seconds && angle_rad < kLeastRate_radps * seconds))
    return {};
  cause.evidence = fmt::format("the camera moves at {:.2f} m/s and {:.2f} rad/s in the first second",
                               path_m / seconds, angle_rad / seconds);
  if (const double bias = gyro_bias(info, survey).norm(); bias > kLargeBias_radps) {
    cause.evidence += fmt::format(", and the gyroscope has a bias of {:.2f} rad/s", bias);
    cause.basis = CauseBasis::kCompared;
    cause.strength = bias / kBiasSigma_radps;
    cause.needs_effect = false;
  }
  return {cause};
}

}  // namespace stillpoint::bench
