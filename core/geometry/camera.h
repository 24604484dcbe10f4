// SPDX-License-Identifier: BSD-3-Clause
/// Central cameras: pinhole with radial-tangential distortion (Brown 1966), and Kannala-Brandt (2006)
/// fisheye.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/base/fields.h"

namespace stillpoint {

enum class CameraModel { kRadialTangential, kKannalaBrandt };
constexpr auto enum_names(CameraModel) {
  return EnumNames<CameraModel, 2>{{{CameraModel::kRadialTangential, "radial-tangential"},
                                    {CameraModel::kKannalaBrandt, "kannala-brandt"}}};
}

/// Intrinsics [px]. Distortion: k1 k2 p1 p2 k3 for radial-tangential, k1 k2 k3 k4 for Kannala-Brandt; zeros =
/// none.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  CameraModel model = CameraModel::kRadialTangential;
  std::array<double, 5> distortion{};

  /// Mean focal length: thresholds in pixels are divided by it to reach the normalised plane.
  [[nodiscard]] double focal_px() const { return 0.5 * (fx + fy); }

  /// Pixel of the point `p_c` in camera coordinates, p_c.z() > 0. Pixel centres are at whole numbers.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_c) const;

  /// Undistorted normalised coordinates (x, y) of a pixel: the bearing is (x, y, 1). By Newton steps, to
  /// 1e-10.
  [[nodiscard]] Eigen::Vector2d unproject(const Eigen::Vector2d& pixel) const;

  /// Whether the pixel lies in the picture, `border` px away from its edge.
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel, double border = 0.0) const {
    return pixel.x() >= border && pixel.y() >= border && pixel.x() <= width - 1 - border &&
           pixel.y() <= height - 1 - border;
  }
  [[nodiscard]] bool has_distortion() const;
};

}  // namespace stillpoint
