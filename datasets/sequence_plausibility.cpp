// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/so3.h"
#include "eval/io/nmea_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kMaxTilt =
    0.5;  ///< cosine of the angle between "up" and the mean specific force: 60 degrees
constexpr int kMaxShift_px = 48;           ///< between two frames
constexpr int kDepthStep_px = 16;          ///< every 16th pixel of both directions is sampled
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
    const int shifted = x + shift;
    const double difference = b[static_cast<std::size_t>(shifted)] - a[static_cast<std::size_t>(x)];
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

constexpr double kMinMeanAccel = 7.0;   ///< [m/s^2] range of the mean |a| of a hand-held or wheeled IMU;
constexpr double kMaxMeanAccel = 13.0;  ///< a mean near 1 indicates the unit g, near 1000 the unit mg
constexpr double kRateInterval_s = 0.1;
constexpr double kMinRate = 0.02;       ///< [rad/s], RMS of the true rate that tells the unit
constexpr double kMaxMedianRate = 5.0;  ///< [rad/s]
constexpr double kMinUnitMotions = 15;
constexpr double kMinUnitCorrelation = 0.6;
constexpr double kScaleInterval_s = 0.2;
constexpr double kScaleBlock_s = 1.5;
constexpr double kMinBlockCorrelation = 0.7;
constexpr double kMinScaleFinding = 3.0;

/// The pose of the camera by the ground truth; nullopt without a pose on both sides at most 0.1 s away.
std::optional<Pose> true_pose(const SequenceInfo& info, Timestamp t) {
  constexpr double kMaxGap_s = 0.1;
  const std::vector<StampedPose>& poses = info.ground_truth.trajectory.poses;
  if (info.ground_truth.trajectory.frame == eval::kGnssFrame) return std::nullopt;  // no orientations
  const auto next = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (next == poses.end() || (next == poses.begin() && next->t != t)) return std::nullopt;
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  if (next->t == t) return next->T_w_f * T_f_c;
  const auto last = std::prev(next);
  const double interval_s = seconds_between(last->t, next->t);
  if (interval_s > kMaxGap_s) return std::nullopt;
  return interpolate(last->T_w_f, next->T_w_f, seconds_between(last->t, t) / interval_s) * T_f_c;
}

/// Ratio of the rates of the gyroscope and the ground truth: sum |w| |w_true| / sum |w_true|^2 over
/// intervals; nullopt without ground truth or rotation.
std::optional<double> rate_ratio(const SequenceInfo& info) {
  double product = 0.0, squares = 0.0, count = 0.0;
  std::size_t begin = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i < info.imu.size(); ++i) {
    sum += info.imu[i].gyro_b;
    const double duration_s = seconds_between(info.imu[begin].t, info.imu[i].t);
    if (duration_s < kRateInterval_s) continue;
    const auto from = true_pose(info, info.imu[begin].t);
    const auto to = true_pose(info, info.imu[i].t);
    if (from && to && duration_s < 2.0 * kRateInterval_s) {
      const double true_rate = from->q.angularDistance(to->q) / duration_s;
      product += sum.norm() / static_cast<double>(i - begin) * true_rate;
      squares += true_rate * true_rate;
      count += 1.0;
    }
    begin = i;
    sum.setZero();
  }
  if (count < 5.0 || squares < count * kMinRate * kMinRate) return std::nullopt;
  return product / squares;
}

/// mm, TUM RGB-D, cm, 0.1 mm: the most common one first.
constexpr std::array<double, 4> kUsualUnitsPerM{1000.0, 5000.0, 100.0, 10'000.0};

/// The usual units per meter that are nearest to an estimate; the estimate if none is near.
double likely_units(double estimate) {
  constexpr double kMaxFactor = 1.5;  // errors of the estimate; the usual units differ by 2 or more
  const auto distance = [estimate](double units) { return std::abs(std::log(units / estimate)); };
  const double nearest = *std::ranges::min_element(kUsualUnitsPerM, {}, distance);
  return distance(nearest) < std::log(kMaxFactor) ? nearest : estimate;
}

/// The first usual unit in which depths of this range are those of an RGB-D camera.
std::optional<double> usual_units(double nearest, double farthest) {
  for (const double units_per_m : kUsualUnitsPerM) {
    if (nearest / units_per_m >= kLeastDepth_m && farthest / units_per_m <= kLargestDepth_m)
      return units_per_m;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> imu_unit_findings(const SequenceInfo& info) {
  std::vector<std::string> findings;
  if (info.imu.empty()) return findings;
  double sum = 0.0;
  std::vector<float> rates;
  for (const ImuSample& sample : info.imu) {
    sum += sample.accel_b.norm();
    rates.push_back(static_cast<float>(sample.gyro_b.norm()));
  }
  const double mean = sum / static_cast<double>(info.imu.size());
  if (mean < kMinMeanAccel || mean > kMaxMeanAccel) {
    findings.push_back(fmt::format(
        "the mean acceleration is {:.3f}, expected about 9.8 (gravity); is it in m/s^2, and with gravity?",
        mean));
  }
  const std::optional<double> ratio = rate_ratio(info);
  if (ratio && is_degrees_ratio(*ratio)) {
    findings.push_back(fmt::format(
        "the angular rates are {:.1f} times those of the ground truth; are they in deg/s instead of rad/s?",
        *ratio));
  } else if (const double middle = percentile(rates, 0.5); middle > kMaxMedianRate) {
    findings.push_back(fmt::format(
        "half of the angular rates exceed {:.1f} rad/s; are they in deg/s instead of rad/s?", middle));
  }
  return findings;
}

std::optional<std::string> float_depth_finding(const std::vector<float>& measurements) {
  if (measurements.empty()) return std::nullopt;
  const double near_m = percentile(measurements, 0.05);
  const double far_m = percentile(measurements, 0.95);
  if (near_m <= kLargestDepth_m && far_m >= kLeastDepth_m) return std::nullopt;
  const std::string found = fmt::format(
      "90 % of the measurements are from {:.4g} to {:.4g}, and floats are read as meters; is this the unit?",
      near_m, far_m);
  const std::optional<double> units_per_m = usual_units(near_m, far_m);
  if (!units_per_m) return found + " Convert them to meters";
  return found + fmt::format(
                     " Divided by {0:g}, they are from {1:.2f} to {2:.2f} m: convert them to meters, or "
                     "to 16-bit integers with [depth] scale = {0:g} in a rig.toml",
                     *units_per_m, near_m / *units_per_m, far_m / *units_per_m);
}

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

void ImagePlausibility::add_depth(const Frame& frame) {
  for (int row = 0; row < frame.depth.rows; row += kDepthStep_px) {
    for (int column = 0; column < frame.depth.cols; column += kDepthStep_px) {
      const std::uint16_t raw = frame.depth.at<std::uint16_t>(row, column);
      if (raw != 0) depths_m_.push_back(static_cast<float>(raw / frame.depth_units_per_m));
    }
  }
}

void ImagePlausibility::add(const Frame& frame) {
  add_depth(frame);
  compare_depth(frame);
  if (info_.imu.empty()) return;
  add_motion(frame);
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
  if (near_m >= kLeastDepth_m && far_m <= kLargestDepth_m) return std::nullopt;
  const std::string found = fmt::format(
      "90 % of the measurements are from {:.2f} to {:.2f} m with {:g} units per meter; is the unit another "
      "one?",
      near_m, far_m, info_.rig.depth_units_per_m);
  const double stated = info_.rig.depth_units_per_m;
  const std::optional<double> units_per_m = usual_units(near_m * stated, far_m * stated);
  if (!units_per_m) return found + " [depth] scale in a rig.toml sets the units per meter";
  return found + fmt::format(" With [depth] scale = {:g} in a rig.toml, they are from {:.2f} to {:.2f} m",
                             *units_per_m, near_m * stated / *units_per_m, far_m * stated / *units_per_m);
}

namespace {

constexpr std::array<double, 3> kDepthScales{0.2, 1.0, 5.0};
constexpr double kMinParallax = 0.01;  ///< of the median depth; less motion does not tell the scale
constexpr double kMaxParallax = 2.5;
constexpr std::size_t kMinPoints = 100;
constexpr int kMinScalePairs = 3;

/// Gray value between pixels; nullopt outside of the image.
std::optional<double> gray_at(const cv::Mat& gray, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= gray.cols || y + 1 >= gray.rows) return std::nullopt;
  const double a = pixel.x() - x, b = pixel.y() - y;
  const auto at = [&](int row, int column) {
    return static_cast<double>(gray.at<std::uint8_t>(row, column));
  };
  return (1.0 - b) * ((1.0 - a) * at(y, x) + a * at(y, x + 1)) +
         b * ((1.0 - a) * at(y + 1, x) + a * at(y + 1, x + 1));
}

}  // namespace

void ImagePlausibility::compare_depth(const Frame& frame) {
  const std::optional<Pose> T_w_c = true_pose(info_, frame.t);
  if (!T_w_c || frame.depth.empty() || frame.gray.empty()) return;
  const Camera& camera = info_.rig.camera;
  if (reference_) {
    const Pose T_now_ref = T_w_c->inverse() * reference_->T_w_c;
    const double parallax = T_now_ref.p.norm() / reference_->median_m;
    if (parallax < kMinParallax) return;
    std::array<double, 3> errors{};
    std::size_t common = 0;
    for (std::size_t i = 0; i < reference_->points_c.size(); ++i) {
      std::array<double, 3> differences{};
      bool visible = true;
      for (std::size_t k = 0; visible && k < kDepthScales.size(); ++k) {
        const Eigen::Vector3d p = T_now_ref * Eigen::Vector3d(kDepthScales[k] * reference_->points_c[i]);
        const std::optional<double> gray =
            p.z() > 0.0 ? gray_at(frame.gray, camera.project(p)) : std::nullopt;
        visible = gray.has_value();
        if (visible) differences[k] = std::min(std::abs(*gray - reference_->gray[i]), 30.0);
      }
      if (!visible) continue;
      ++common;
      for (std::size_t k = 0; k < errors.size(); ++k) errors[k] += differences[k];
    }
    const auto best = std::ranges::min_element(errors);
    std::array<double, 3> sorted = errors;
    std::ranges::sort(sorted);
    constexpr double kClear = 0.8;  // of the second smallest difference
    if (common >= kMinPoints && parallax < kMaxParallax && sorted[0] < kClear * sorted[1])
      ++best_scale_[static_cast<std::size_t>(best - errors.begin())];
  }
  DepthFrame next{.T_w_c = *T_w_c};
  std::vector<float> depths;
  constexpr int kStep_px = 8;
  for (int row = 0; row < frame.depth.rows; row += kStep_px) {
    for (int column = 0; column < frame.depth.cols; column += kStep_px) {
      const std::uint16_t raw = frame.depth.at<std::uint16_t>(row, column);
      if (raw == 0) continue;
      const double depth_m = raw / frame.depth_units_per_m;
      const Eigen::Vector2d bearing = camera.unproject({column, row});
      next.points_c.emplace_back(depth_m * bearing.x(), depth_m * bearing.y(), depth_m);
      next.gray.push_back(frame.gray.at<std::uint8_t>(row, column));
      depths.push_back(static_cast<float>(depth_m));
    }
  }
  if (depths.size() < kMinPoints) return;
  next.median_m = percentile(depths, 0.5);
  reference_ = std::move(next);
}

std::optional<DepthScaleByTruth> ImagePlausibility::depth_scale_by_truth() const {
  const int all = best_scale_[0] + best_scale_[1] + best_scale_[2];
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
    if (best_scale_[k] >= kMinScalePairs && 3 * best_scale_[k] >= 2 * all)
      return DepthScaleByTruth{kDepthScales[k], best_scale_[k], all};
  }
  return std::nullopt;
}

std::optional<std::string> ImagePlausibility::depth_scale_finding() const {
  const std::optional<DepthScaleByTruth> found = depth_scale_by_truth();
  if (!found) return std::nullopt;
  return fmt::format(
      "the images follow the motion of the ground truth with {:g} times the depth ({} of {} pairs of "
      "frames); with "
      "{:g} units per meter, [depth] scale = {:g} in a rig.toml would be right",
      found->factor, found->pairs, found->all_pairs, info_.rig.depth_units_per_m,
      info_.rig.depth_units_per_m / found->factor);
}

void ImagePlausibility::add_motion(const Frame& frame) {
  constexpr std::size_t kMaxMotions = 600;  // 20 s; each takes milliseconds
  if (motions_.size() >= kMaxMotions) return;
  const std::optional<Pose> T_now_last = image_motion_.add(frame);
  if (T_now_last && last_motion_t_ < frame.t)
    motions_.push_back({.from = last_motion_t_, .to = frame.t, .T_to_from = *T_now_last});
  last_motion_t_ = frame.t;
}

namespace {

/// The samples between two times.
std::span<const ImuSample> samples_between(const std::vector<ImuSample>& imu, Timestamp from, Timestamp to) {
  const auto begin = std::ranges::lower_bound(imu, from, {}, &ImuSample::t);
  const auto end = std::ranges::upper_bound(begin, imu.end(), to, {}, &ImuSample::t);
  return {begin, end};
}

}  // namespace

std::optional<std::string> ImagePlausibility::gyro_unit_finding() const {
  const auto is_known = [](const std::string& finding) { return finding.find("deg/s") != std::string::npos; };
  if (std::ranges::any_of(imu_unit_findings(info_), is_known)) return std::nullopt;
  std::vector<double> by_images, by_gyro;
  double product = 0.0, squares = 0.0;
  for (const Motion& motion : motions_) {
    const double offset_s = info_.rig.time_offset_s;
    const auto samples = samples_between(info_.imu, after(motion.from, offset_s), after(motion.to, offset_s));
    if (samples.empty()) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : samples) sum += sample.gyro_b;
    by_gyro.push_back(sum.norm() / static_cast<double>(samples.size()));
    by_images.push_back(log_so3(motion.T_to_from.q).norm() / seconds_between(motion.from, motion.to));
    product += by_gyro.back() * by_images.back();
    squares += by_images.back() * by_images.back();
  }
  const double count = static_cast<double>(by_images.size());
  if (count < kMinUnitMotions || squares < count * kMinRate * kMinRate) return std::nullopt;
  const double ratio = product / squares;
  if (!is_degrees_ratio(ratio) || correlation(by_images, by_gyro) < kMinUnitCorrelation) return std::nullopt;
  return fmt::format(
      "the angular rates are {:.1f} times the rotation in the images; are they in deg/s instead of rad/s?",
      ratio);
}

ImagePlausibility::ScaleSums ImagePlausibility::scale_sums(std::span<const Motion> block) const {
  std::vector<Pose> poses{Pose{}};  // T_w_c at the begin of the first motion, then at the end of each
  std::vector<Timestamp> times{block.front().from};
  for (const Motion& motion : block) {
    poses.push_back(poses.back() * motion.T_to_from.inverse());
    times.push_back(motion.to);
  }
  const double interval_s = seconds_between(times.front(), times.back()) / static_cast<double>(block.size());
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(kScaleInterval_s / interval_s)));
  const Eigen::Matrix3d R_c_b = info_.rig.T_b_c.R().transpose();
  std::vector<std::array<Eigen::Vector3d, 2>> sides;
  std::vector<double> weights;
  for (std::size_t j = step; j + step < poses.size(); ++j) {
    const std::size_t i = j - step, k = j + step;
    const double before_s = seconds_between(times[i], times[j]),
                 behind_s = seconds_between(times[j], times[k]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_of_weights = 0.0;
    for (const ImuSample& sample : samples_between(info_.imu, after(times[i], info_.rig.time_offset_s),
                                                   after(times[k], info_.rig.time_offset_s))) {
      const Timestamp t = after(sample.t, -info_.rig.time_offset_s);
      const double w =
          t < times[j] ? seconds_between(times[i], t) / before_s : seconds_between(t, times[k]) / behind_s;
      const auto next = std::ranges::lower_bound(times, t);
      const auto n = std::clamp<std::ptrdiff_t>(next - times.begin(), 1, std::ssize(times) - 1);
      const std::size_t to = static_cast<std::size_t>(n);
      const double fraction = seconds_between(times[to - 1], t) / seconds_between(times[to - 1], times[to]);
      sum += w * (interpolate(poses[to - 1], poses[to], fraction).q * (R_c_b * sample.accel_b));
      sum_of_weights += w;
    }
    if (sum_of_weights <= 0.0) continue;
    const double weight = 0.5 * (before_s + behind_s);  // integral of w
    sides.push_back({(poses[k].p - poses[j].p) / behind_s - (poses[j].p - poses[i].p) / before_s,
                     weight / sum_of_weights * sum});
    weights.push_back(weight);
  }
  // The part of both sides along the weights is that of gravity.
  std::array<Eigen::Vector3d, 2> gravity{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double squares = 0.0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) gravity[side] += weights[i] * sides[i][side];
    squares += weights[i] * weights[i];
  }
  ScaleSums sums;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Eigen::Vector3d images = sides[i][0] - weights[i] / squares * gravity[0];
    const Eigen::Vector3d inertial = sides[i][1] - weights[i] / squares * gravity[1];
    sums.images += images.squaredNorm();
    sums.both += images.dot(inertial);
    sums.inertial += inertial.squaredNorm();
  }
  return sums;
}

std::optional<std::string> ImagePlausibility::depth_motion_finding() const {
  if (depths_m_.empty() || motions_.empty() || depth_scale_finding()) return std::nullopt;
  double accel = 0.0;
  for (const ImuSample& sample : info_.imu)
    accel += sample.accel_b.norm() / static_cast<double>(info_.imu.size());
  if (accel < kMinMeanAccel || accel > kMaxMeanAccel) return std::nullopt;
  ScaleSums all;
  for (std::size_t begin = 0; begin < motions_.size();) {
    std::size_t end = begin + 1;
    while (end < motions_.size() && motions_[end].from == motions_[end - 1].to &&
           seconds_between(motions_[begin].from, motions_[end].to) < kScaleBlock_s)
      ++end;
    const ScaleSums sums = scale_sums(std::span(motions_).subspan(begin, end - begin));
    // A person who fills the image moves unlike the accelerometer.
    const bool follows = sums.both >= kMinBlockCorrelation * std::sqrt(sums.images * sums.inertial);
    const bool is_long = seconds_between(motions_[begin].from, motions_[end - 1].to) >= 0.6 * kScaleBlock_s;
    if (follows && is_long) {
      all.images += sums.images;
      all.both += sums.both;
      all.inertial += sums.inertial;
    }
    begin = end;
  }
  if (all.images <= 0.0 || all.inertial <= 0.0) return std::nullopt;
  const double correlation = all.both / std::sqrt(all.images * all.inertial);
  const double scale = all.both / all.images;
  if (scale > 1.0 / kMinScaleFinding && scale < kMinScaleFinding) return std::nullopt;
  return fmt::format(
      "by the accelerometer, the camera moves {:.2g} times as far as the images show with {:g} units per "
      "meter (correlation {:.2f}); is [depth] scale = {:.4g} in a rig.toml right?",
      scale, info_.rig.depth_units_per_m, correlation, likely_units(info_.rig.depth_units_per_m / scale));
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
