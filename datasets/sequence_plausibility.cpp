// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillpoint::datasets {
namespace {

constexpr double kMaxTilt =
    0.5;  ///< cosine of the angle between "up" and the mean specific force: 60 degrees
constexpr int kMaxShift_px = 48;           ///< between two frames
constexpr int kDepthStep_px = 16;          ///< every 16th pixel of both directions is sampled
constexpr double kMinDepth_m = 0.3;        ///< RealSense and Kinect measure from 0.3 m on
constexpr double kMaxDepth_m = 12.0;       ///< and at most to about 10 m
constexpr double kMaxClockOffset_s = 0.5;  ///< searched range
constexpr double kClockStep_s = 0.005;
constexpr double kMinClockFinding_s = 0.03;
constexpr double kMaxClockDisagreement_s = 0.03;  ///< of a half with the whole
constexpr double kMinCorrelation = 0.7;
constexpr double kMinGain = 0.05;     ///< of the correlation over that without offset
constexpr double kMinTurnRate = 0.1;  ///< standard deviation [rad/s]
constexpr std::size_t kMinTurns = 60;

/// Means of the columns without their own mean.
std::vector<double> column_profile(const cv::Mat& gray) {
  std::vector<double> profile(static_cast<std::size_t>(gray.cols), 0.0);
  for (int row = 0; row < gray.rows; ++row) {
    const auto* const pixels = gray.ptr<std::uint8_t>(row);
    for (int column = 0; column < gray.cols; ++column)
      profile[static_cast<std::size_t>(column)] += pixels[column];
  }
  double mean = 0.0;
  for (double& value : profile) mean += (value /= gray.rows) / gray.cols;
  for (double& value : profile) value -= mean;
  return profile;
}

/// Mean squared difference of b(x + shift) and a(x).
double difference_at(const std::vector<double>& a, const std::vector<double>& b, int shift) {
  const int columns = static_cast<int>(a.size());
  double sum = 0.0;
  int count = 0;
  for (int x = std::max(0, -shift); x < std::min(columns, columns - shift); ++x, ++count) {
    const double difference = b[static_cast<std::size_t>(x + shift)] - a[static_cast<std::size_t>(x)];
    sum += difference * difference;
  }
  return count > 0 ? sum / count : 0.0;
}

/// The shift with the smallest difference, refined by a parabola.
std::optional<double> shift_between(const std::vector<double>& a, const std::vector<double>& b) {
  const int range = std::min(kMaxShift_px, static_cast<int>(a.size()) / 4);
  std::vector<double> differences;
  for (int shift = -range; shift <= range; ++shift) differences.push_back(difference_at(a, b, shift));
  const auto best = std::ranges::min_element(differences);
  if (best == differences.begin() || best + 1 == differences.end()) return std::nullopt;
  const double curvature = *(best - 1) - 2.0 * *best + *(best + 1);
  const double fraction = curvature > 0.0 ? 0.5 * (*(best - 1) - *(best + 1)) / curvature : 0.0;
  return static_cast<double>(best - differences.begin()) - range + fraction;
}

/// Angle about the y axis of the camera at the time of each sample: the integral of the rate.
std::vector<double> integrated_angle(const SequenceInfo& info) {
  std::vector<double> angle;
  const Eigen::Vector3d y_b = info.rig.T_b_c.R().col(1);
  double sum = 0.0;
  for (std::size_t i = 0; i < info.imu.size(); ++i) {
    if (i > 0)
      sum += 0.5 * (info.imu[i - 1].gyro_b + info.imu[i].gyro_b).dot(y_b) *
             seconds_between(info.imu[i - 1].t, info.imu[i].t);
    angle.push_back(sum);
  }
  return angle;
}

/// The angle at a time by linear interpolation; clamped at the ends.
double angle_at(const SequenceInfo& info, const std::vector<double>& angle, Timestamp t) {
  const auto next = std::ranges::lower_bound(info.imu, t, {}, &ImuSample::t);
  if (next == info.imu.begin()) return angle.front();
  if (next == info.imu.end()) return angle.back();
  const auto i = static_cast<std::size_t>(next - info.imu.begin());
  const double fraction =
      seconds_between(info.imu[i - 1].t, t) / seconds_between(info.imu[i - 1].t, info.imu[i].t);
  return angle[i - 1] + fraction * (angle[i] - angle[i - 1]);
}

/// Pearson correlation; 0 if a series is constant.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  double mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

double percentile(std::vector<float> values, double fraction) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::optional<std::string> gravity_finding(const SequenceInfo& info) {
  if (info.imu.empty()) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : info.imu) sum += sample.accel_b;
  const Eigen::Vector3d force_c = info.rig.T_b_c.R().transpose() * sum / static_cast<double>(info.imu.size());
  if (force_c.norm() == 0.0 || -force_c.y() >= kMaxTilt * force_c.norm()) return std::nullopt;
  return fmt::format(
      "the mean specific force in the camera frame is ({:.2f}, {:.2f}, {:.2f}), but that of an upright "
      "camera points "
      "along -y; are axes swapped, the sign of the accelerations inverted, or T_b_c wrong?",
      force_c.x(), force_c.y(), force_c.z());
}

void ImagePlausibility::add(const Frame& frame) {
  for (int row = 0; row < frame.depth.rows; row += kDepthStep_px) {
    for (int column = 0; column < frame.depth.cols; column += kDepthStep_px) {
      const std::uint16_t raw = frame.depth.at<std::uint16_t>(row, column);
      if (raw != 0) depths_m_.push_back(static_cast<float>(raw / frame.depth_units_per_m));
    }
  }
  if (info_.imu.empty()) return;
  std::vector<double> profile = column_profile(frame.gray);
  if (last_profile_.size() == profile.size() && last_t_ < frame.t) {
    const std::optional<double> shift_px = shift_between(last_profile_, profile);
    const double rate_px = info_.rig.camera.fx * seconds_between(last_t_, frame.t);
    if (shift_px) turns_.push_back({.from = last_t_, .to = frame.t, .rate = -*shift_px / rate_px});
  }
  last_profile_ = std::move(profile);
  last_t_ = frame.t;
}

std::optional<std::string> ImagePlausibility::depth_unit_finding() const {
  if (depths_m_.empty()) return std::nullopt;
  const double near_m = percentile(depths_m_, 0.05);
  const double far_m = percentile(depths_m_, 0.95);
  if (near_m >= kMinDepth_m && far_m <= kMaxDepth_m) return std::nullopt;
  const double factor = far_m > kMaxDepth_m ? 5.0 : 0.2;
  return fmt::format(
      "90 % of the measurements are from {:.2f} to {:.2f} m with {:g} units per meter; is the unit another "
      "one? With "
      "[depth] scale = {:g} in a rig.toml, they are from {:.2f} to {:.2f} m",
      near_m, far_m, info_.rig.depth_units_per_m, factor * info_.rig.depth_units_per_m, near_m / factor,
      far_m / factor);
}

double ImagePlausibility::correlation_at(double offset_s, std::span<const Turn> turns,
                                         const std::vector<double>& angle) const {
  std::vector<double> by_images, by_gyro;
  for (const Turn& turn : turns) {
    const double change =
        angle_at(info_, angle, after(turn.to, offset_s)) - angle_at(info_, angle, after(turn.from, offset_s));
    by_images.push_back(turn.rate);
    by_gyro.push_back(change / seconds_between(turn.from, turn.to));
  }
  return correlation(by_images, by_gyro);
}

ImagePlausibility::ClockOffset ImagePlausibility::best_offset(std::span<const Turn> turns,
                                                              const std::vector<double>& angle) const {
  const double known_s = info_.rig.time_offset_s;
  const double without = correlation_at(known_s, turns, angle);
  ClockOffset best{.offset_s = 0.0, .correlation = without, .without = without};
  for (double candidate = -kMaxClockOffset_s; candidate <= kMaxClockOffset_s; candidate += kClockStep_s) {
    const double value = correlation_at(known_s + candidate, turns, angle);
    if (value > best.correlation) {
      best.correlation = value;
      best.offset_s = candidate;
    }
  }
  return best;
}

std::optional<std::string> ImagePlausibility::clock_finding() const {
  if (turns_.size() < kMinTurns) return std::nullopt;
  double squares = 0.0;
  for (const Turn& turn : turns_) squares += turn.rate * turn.rate / static_cast<double>(turns_.size());
  if (std::sqrt(squares) < kMinTurnRate) return std::nullopt;
  const std::vector<double> angle = integrated_angle(info_);
  const ClockOffset found = best_offset(turns_, angle);
  if (found.correlation < kMinCorrelation || found.correlation - found.without < kMinGain ||
      std::abs(found.offset_s) < kMinClockFinding_s)
    return std::nullopt;
  // A chance correlation of a short or disturbed sequence differs between its halves.
  const std::span<const Turn> turns(turns_);
  for (const auto half : {turns.first(turns.size() / 2), turns.subspan(turns.size() / 2)}) {
    if (std::abs(best_offset(half, angle).offset_s - found.offset_s) > kMaxClockDisagreement_s)
      return std::nullopt;
  }
  return fmt::format(
      "the rotation in the images follows the gyroscope best (correlation {:.2f}, {:.2f} without) if [imu] "
      "time_offset_s = {:.3f}; are the clocks offset?",
      found.correlation, found.without, info_.rig.time_offset_s + found.offset_s);
}

}  // namespace stillpoint::datasets
