// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/depth_registration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stillpoint {
namespace {

/// By how much a depth pixel reaches into its neighbours [px]: their rectangles move apart where depth
/// changes.
constexpr double kOverlap_px = 0.25;

/// Writes `value` into the pixels whose centres lie in the rectangle, where it is the nearest so far.
void splat(cv::Mat& registered, const Eigen::Vector2d& top_left, const Eigen::Vector2d& bottom_right,
           std::uint16_t value) {
  const int first_column = std::max(0, static_cast<int>(std::ceil(top_left.x() - kOverlap_px)));
  const int first_row = std::max(0, static_cast<int>(std::ceil(top_left.y() - kOverlap_px)));
  const int last_column =
      std::min(registered.cols - 1, static_cast<int>(std::floor(bottom_right.x() + kOverlap_px)));
  const int last_row =
      std::min(registered.rows - 1, static_cast<int>(std::floor(bottom_right.y() + kOverlap_px)));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      std::uint16_t& nearest = registered.at<std::uint16_t>(row, column);
      if (nearest == 0 || value < nearest) nearest = value;
    }
  }
}

}  // namespace

cv::Mat register_depth(const cv::Mat& depth, double depth_units_per_m, const DepthCamera& source,
                       const Camera& color) {
  cv::Mat registered = cv::Mat::zeros(color.height, color.width, CV_16UC1);
  const Camera& camera = source.camera;
  const Eigen::Matrix3d R_c_d = source.T_c_d.R();
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const std::uint16_t raw = depth.at<std::uint16_t>(row, column);
      if (raw == 0) continue;
      const double z = raw / depth_units_per_m;
      const auto seen_from_color = [&](double u_px, double v_px) -> Eigen::Vector3d {
        const Eigen::Vector3d p_d((u_px - camera.cx) / camera.fx * z, (v_px - camera.cy) / camera.fy * z, z);
        return R_c_d * p_d + source.T_c_d.p;
      };
      const Eigen::Vector3d near_corner = seen_from_color(column - 0.5, row - 0.5);
      const Eigen::Vector3d far_corner = seen_from_color(column + 0.5, row + 0.5);
      const double units = std::round(0.5 * (near_corner.z() + far_corner.z()) * depth_units_per_m);
      if (units < 1.0 || units > std::numeric_limits<std::uint16_t>::max()) continue;
      splat(registered, color.project(near_corner), color.project(far_corner),
            static_cast<std::uint16_t>(units));
    }
  }
  return registered;
}

}  // namespace stillpoint
