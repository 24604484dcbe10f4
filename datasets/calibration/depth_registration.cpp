// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/depth_registration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stillpoint::datasets {
namespace {

/// Margin [px] of the rectangle of a depth pixel: closes the gaps between neighbors of different depth.
constexpr double kOverlap_px = 0.25;

/// Writes `value` to the pixels whose centers lie in the rectangle, subject to the z-buffer test.
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
      const auto to_color_frame = [&](double u_px, double v_px) -> Eigen::Vector3d {
        const Eigen::Vector3d p_d((u_px - camera.cx) / camera.fx * z, (v_px - camera.cy) / camera.fy * z, z);
        return R_c_d * p_d + source.T_c_d.p;
      };
      const Eigen::Vector3d top_left = to_color_frame(column - 0.5, row - 0.5);
      const Eigen::Vector3d bottom_right = to_color_frame(column + 0.5, row + 0.5);
      const double units = std::round(0.5 * (top_left.z() + bottom_right.z()) * depth_units_per_m);
      if (units < 1.0 || units > std::numeric_limits<std::uint16_t>::max()) continue;
      splat(registered, color.project(top_left), color.project(bottom_right),
            static_cast<std::uint16_t>(units));
    }
  }
  return registered;
}

}  // namespace stillpoint::datasets
