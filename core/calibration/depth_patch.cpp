// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/depth_patch.h"

#include "core/geometry/decompositions.h"

#include <cmath>
#include <cstdint>

namespace stillpoint {
namespace {

constexpr int kRadius_px = 4;
constexpr int kMinPixels = 60;
constexpr double kMaxRms = 0.01;  // of the fit [1/m]: twice the noise of a Kinect

}  // namespace

std::optional<DepthFactor::Measurement> depth_patch(const cv::Mat& depth, double units_per_m,
                                                    const Eigen::Vector2d& pixel) {
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d center(std::round(pixel.x()), std::round(pixel.y()));
  if (center.x() < kRadius_px || center.y() < kRadius_px || center.x() >= depth.cols - kRadius_px ||
      center.y() >= depth.rows - kRadius_px)
    return std::nullopt;
  const int column = static_cast<int>(center.x()), row = static_cast<int>(center.y());
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
  for (int y = -kRadius_px; y <= kRadius_px; ++y) {
    for (int x = -kRadius_px; x <= kRadius_px; ++x) {
      const std::uint16_t raw = depth.at<std::uint16_t>(row + y, column + x);
      if (raw == 0) continue;
      const double inverse = units_per_m / raw;
      const Eigen::Vector3d a(1.0, x, y);
      A += a * a.transpose();
      b += inverse * a;
      squares += inverse * inverse;
      ++count;
    }
  }
  if (count < kMinPixels) return std::nullopt;
  const Eigen::Vector3d fit = solve_symmetric(A, b);
  const double rms = std::sqrt(std::max(0.0, (squares - fit.dot(b)) / count));
  if (!fit.allFinite() || rms > kMaxRms || fit[0] <= 0.0) return std::nullopt;
  return DepthFactor::Measurement{.inverse_depth = fit[0], .gradient = fit.tail<2>(), .pixel = center};
}

}  // namespace stillpoint
