// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/image_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"

namespace stillpoint::datasets {
namespace {

constexpr int kFinestWidth_px = 160;
constexpr int kLevels = 3;  ///< each half as wide as the one before
constexpr std::array<int, kLevels> kSteps = {6, 8, 12};
constexpr double kHuber = 8.0;  ///< [gray values]
constexpr std::size_t kMinAligned = 100;
constexpr double kMinVisible = 0.5;  ///< of the points
constexpr double kMaxLoss = 0.8;     ///< of that without motion, else the images show none or another one
constexpr double kStillLoss = 1.0;   ///< mean loss [gray values] of images that are equal up to noise
constexpr double kMinChange = 1e-6;  ///< [rad]

double huber(double r) { return std::abs(r) < kHuber ? 0.5 * r * r / kHuber : std::abs(r) - 0.5 * kHuber; }

}  // namespace

ImageMotion::Level ImageMotion::reduced(const cv::Mat& gray, int factor) {
  Level level{.factor = factor, .width = gray.cols / factor, .height = gray.rows / factor, .gray = {}};
  level.gray.reserve(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      int sum = 0;
      for (int row = y * factor; row < (y + 1) * factor; ++row) {
        const auto* const pixels = gray.ptr<std::uint8_t>(row);
        for (int column = x * factor; column < (x + 1) * factor; ++column) sum += pixels[column];
      }
      level.gray.push_back(static_cast<float>(sum) / static_cast<float>(factor * factor));
    }
  }
  return level;
}

/// @param pixel of the whole image
std::optional<double> ImageMotion::interpolated(const Level& level, const Eigen::Vector2d& pixel) {
  const double half = 0.5 * (level.factor - 1);
  const double u = (pixel.x() - half) / level.factor, v = (pixel.y() - half) / level.factor;
  if (!(u >= 0.0 && v >= 0.0 && u < level.width - 1 && v < level.height - 1)) return std::nullopt;
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double a = u - x, b = v - y;
  return (1.0 - b) * ((1.0 - a) * level.at(x, y) + a * level.at(x + 1, y)) +
         b * ((1.0 - a) * level.at(x, y + 1) + a * level.at(x + 1, y + 1));
}

std::vector<ImageMotion::Point> ImageMotion::points_of(const Level& level, const Frame& frame) const {
  std::vector<Point> points;
  const int stride = level.width > kFinestWidth_px / 2 ? 2 : 1;
  const double half = 0.5 * (level.factor - 1);
  for (int y = 1; y + 1 < level.height; y += stride) {
    for (int x = 1; x + 1 < level.width; x += stride) {
      const Eigen::Vector2d pixel(level.factor * x + half, level.factor * y + half);
      const double depth_m =
          frame.depth.empty() ? 1.0 : depth_at(frame.depth, frame.depth_units_per_m, pixel.x(), pixel.y());
      if (!(depth_m > 0.0)) continue;
      const Eigen::Vector2d gradient =
          Eigen::Vector2d(level.at(x + 1, y) - level.at(x - 1, y), level.at(x, y + 1) - level.at(x, y - 1)) /
          (2.0 * level.factor);
      const Eigen::Vector2d bearing = camera_.unproject(pixel);
      if (!bearing.allFinite() || gradient.isZero()) continue;
      Point point{.p = depth_m * bearing.homogeneous(), .gray = level.at(x, y), .jacobian = {}};
      constexpr double kDelta = 1e-4;  // relative to the depth; project depends on p / p.z only
      Eigen::Vector3d by_point;
      for (int k = 0; k < 3; ++k) {
        Eigen::Vector3d moved = point.p;
        moved[k] += kDelta * depth_m;
        by_point[k] = gradient.dot(camera_.project(moved) - pixel) / (kDelta * depth_m);
      }
      point.jacobian.head<3>() = frame.depth.empty() ? Eigen::Vector3d::Zero() : by_point;
      point.jacobian.segment<3>(3) = point.p.cross(by_point);
      point.jacobian[6] = 1.0;
      points.push_back(point);
    }
  }
  return points;
}

std::optional<ImageMotion::Step> ImageMotion::step(const Level& level, const std::vector<Point>& points,
                                                   const Pose& T, double brightness) const {
  Eigen::Matrix<double, 7, 7> H = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> g = Eigen::Matrix<double, 7, 1>::Zero();
  Step result{.T = T};
  for (const Point& point : points) {
    const Eigen::Vector3d p = T * point.p;
    if (!(p.z() > 0.05 * point.p.z())) continue;
    const std::optional<double> gray = interpolated(level, camera_.project(p));
    if (!gray) continue;
    const double r = *gray - point.gray - brightness;
    const double weight = std::abs(r) < kHuber ? 1.0 : kHuber / std::abs(r);
    H.selfadjointView<Eigen::Lower>().rankUpdate(point.jacobian, weight);
    g += weight * r * point.jacobian;
    result.loss += huber(r);
    ++result.visible;
  }
  if (result.visible < kMinAligned ||
      static_cast<double>(result.visible) < kMinVisible * static_cast<double>(points.size()))
    return std::nullopt;
  result.loss /= static_cast<double>(result.visible);
  if (!has_depth_) H.topLeftCorner<3, 3>().setIdentity();
  const Eigen::Matrix<double, 7, 1> d = solve_symmetric(H, g);
  if (!d.allFinite()) return std::nullopt;
  result.brightness = d[6];
  result.T = T * Pose{exp_so3(d.segment<3>(3)), d.head<3>()}.inverse();
  result.change = d.segment<3>(3).norm();
  return result;
}

std::optional<Pose> ImageMotion::aligned(const std::vector<Level>& levels,
                                         const std::vector<std::vector<Point>>& before) const {
  Pose T;
  double brightness = 0.0;
  double loss = 0.0, still_loss = 0.0;
  for (std::size_t k = levels.size(); k-- > 0;) {
    for (int i = 0; i < kSteps[k]; ++i) {
      const std::optional<Step> next = step(levels[k], before[k], T, brightness);
      if (!next) return std::nullopt;
      brightness += next->brightness;
      T = next->T;
      loss = next->loss;
      if (next->change < kMinChange) break;
    }
  }
  if (const std::optional<Step> still = step(levels[0], before[0], Pose{}, brightness))
    still_loss = still->loss;
  if (loss > kStillLoss && loss > kMaxLoss * still_loss) return std::nullopt;
  return T;
}

std::optional<Pose> ImageMotion::add(const Frame& frame) {
  const int finest = std::max(1, (frame.gray.cols + kFinestWidth_px - 1) / kFinestWidth_px);
  const std::vector<std::vector<Point>> before = std::exchange(last_, {});
  std::vector<Level> levels;
  for (int k = 0; k < kLevels; ++k) {
    levels.push_back(reduced(frame.gray, finest << k));
    last_.push_back(points_of(levels.back(), frame));
  }
  std::optional<Pose> T = before.empty() ? std::nullopt : aligned(levels, before);
  has_depth_ = !frame.depth.empty();
  return T;
}

}  // namespace stillpoint::datasets
