// SPDX-License-Identifier: BSD-3-Clause
/// Motion of the camera between two images, by direct alignment of their brightness: for checks of other
/// sensors that must not depend on the odometry.
///
/// For the pixels u_i of the earlier image with depth z_i, p_i = z_i (unproject(u_i), 1), the rigid motion T
/// and the difference b of the exposures minimize
///   sum_i rho(I'(project(T p_i)) - I(u_i) - b)
/// with the loss of Huber. Inverse compositional Gauss-Newton from coarse to fine (Baker and Matthews 2004;
/// Kerl, Sturm, Cremers 2013): T <- T exp(-d), with the Jacobian of the earlier image. Without depth, T is a
/// rotation and z_i = 1. The translation has the scale of the depth; the rotation does not depend on it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/frame.h"

namespace stillpoint::datasets {

class ImageMotion {
 public:
  explicit ImageMotion(const Camera& camera) : camera_(camera) {}

  /// @param frame the next one
  /// @return T_now_last, which maps coordinates of the camera at the frame before to those at this one;
  /// nullopt for the first one, and if the images do not determine it
  [[nodiscard]] std::optional<Pose> add(const Frame& frame);

 private:
  /// The image reduced by `factor` in both directions.
  struct Level {
    int factor = 1;
    int width = 0;
    int height = 0;
    std::vector<float> gray;

    [[nodiscard]] float at(int x, int y) const {
      return gray[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
    }
  };

  /// A pixel of the earlier image. The last element of the Jacobian is that of b.
  struct Point {
    Eigen::Vector3d p;
    double gray = 0.0;
    Eigen::Matrix<double, 7, 1> jacobian;  ///< of I(project(exp(d) p)): translation, rotation, 1
  };

  [[nodiscard]] static Level reduced(const cv::Mat& gray, int factor);
  [[nodiscard]] static std::optional<double> interpolated(const Level& level, const Eigen::Vector2d& pixel);
  [[nodiscard]] std::vector<Point> points_of(const Level& level, const Frame& frame) const;

  /// One step of Gauss-Newton: the new motion, and what was before it.
  struct Step {
    Pose T;
    double brightness = 0.0;  ///< change of b
    double loss = 0.0;        ///< mean, before the step [gray values]
    double change = 0.0;      ///< of the rotation [rad]
    std::size_t visible = 0;  ///< number of points in the image
  };
  [[nodiscard]] std::optional<Step> step(const Level& level, const std::vector<Point>& points, const Pose& T,
                                         double brightness) const;
  [[nodiscard]] std::optional<Pose> aligned(const std::vector<Level>& levels,
                                            const std::vector<std::vector<Point>>& before) const;

  Camera camera_;
  bool has_depth_ = false;
  std::vector<std::vector<Point>> last_;  ///< of the frame before, the finest level first
};

}  // namespace stillpoint::datasets
