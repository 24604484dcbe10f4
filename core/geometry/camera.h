// SPDX-License-Identifier: BSD-3-Clause
/// Central camera models: pinhole with radial-tangential distortion (Brown 1966), with the denominator that
/// OpenCV adds ("rational"), and Kannala-Brandt (2006).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "core/base/fields.h"

namespace stillpoint {

enum class CameraModel { kRadialTangential, kKannalaBrandt };
constexpr auto enum_names(CameraModel) {
  return EnumNames<CameraModel, 2>{{{CameraModel::kRadialTangential, "radial-tangential"},
                                    {CameraModel::kKannalaBrandt, "kannala-brandt"}}};
}

/// Intrinsics [px] and distortion coefficients; all zero = no distortion.
///
/// With the normalized coordinates (x, y) of a point and r^2 = x^2 + y^2, the pixel is
/// u = fx x_d + cx, v = fy y_d + cy, where
/// radial-tangential (k1 k2 p1 p2 k3 k4 k5 k6; OpenCV's order and rational model, Azure Kinect):
///   g   = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///   x_d = x g + 2 p1 x y + p2 (r^2 + 2 x^2)
///   y_d = y g + p1 (r^2 + 2 y^2) + 2 p2 x y
/// Kannala-Brandt (k1 k2 k3 k4), with theta = atan(r):
///   (x_d, y_d) = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) / r * (x, y)
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  CameraModel model = CameraModel::kRadialTangential;
  std::array<double, 8> distortion{};

  /// Mean focal length; converts thresholds in pixels to the normalized plane.
  [[nodiscard]] double focal_px() const { return 0.5 * (fx + fy); }

  /// Pixel of the point `p_c` in camera coordinates, p_c.z() > 0. Pixel centers have integer coordinates.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_c) const;

  /// Undistorted normalized coordinates (x, y) of a pixel; the ray is (x, y, 1). Newton's method, to 1e-10.
  [[nodiscard]] Eigen::Vector2d unproject(const Eigen::Vector2d& pixel) const;

  /// Whether the pixel is inside the image, at least `border` px from its edge.
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
           pixel.y() <= height - 1 - border;
  }
  [[nodiscard]] bool has_distortion() const;
  /// Whether k4 k5 k6 are not all 0, in the radial-tangential model.
  [[nodiscard]] bool has_denominator() const;
  /// The first 5 numbers of `distortion`, all 8 with a denominator.
  [[nodiscard]] std::span<const double> coefficients() const;
};

}  // namespace stillpoint
