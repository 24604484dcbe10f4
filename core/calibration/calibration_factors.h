// SPDX-License-Identifier: BSD-3-Clause
/// Residuals of the batch estimation of the calibration, as Ceres cost functions.
///
/// Parameter blocks: poses T_w_b, T_b_c, T_c_d, T_w_g and T_f_b (p, q xyzw; tangent space as for
/// PoseManifold), `camera` (fx, fy, cx, cy, eight distortion coefficients), `readout` (rolling-shutter time
/// [s]), `depth` (scale and offset), `depth_camera` (fx, fy, cx, cy), the landmark X_w [m], and the delay of
/// the depth image [s].
#pragma once

#include <Eigen/Core>

#include <optional>

#include <ceres/sized_cost_function.h>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/trajectory.h"

namespace stillpoint {

/// Values of `camera`.
inline constexpr int kCameraValues = 12;

/// Smallest depth at which a landmark is projected [m]; nearer ones are projected from there.
inline constexpr double kNearestPoint_m = 0.05;

/// A pixel u with velocity u', whose row is read out the fraction a of the readout time T after the middle
/// row:
///
///   r = (project(T_c_b T_b_w X_w) - (u - a T u')) / sigma
class PixelFactor final : public ceres::SizedCostFunction<2, 7, 7, kCameraValues, 1, 3> {
 public:
  struct Measurement {
    Eigen::Vector2d pixel;
    Eigen::Vector2d velocity_px;  ///< [px/s]
    double row_fraction = 0.0;    ///< a, from -1/2 to 1/2
  };

  /// @param sigma_px standard deviation of a coordinate
  PixelFactor(CameraModel model, const Measurement& measurement, double sigma_px)
      : model_(model), measurement_(measurement), weight_(1.0 / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  CameraModel model_;
  Measurement measurement_;
  double weight_;
};

/// The depth image around a pixel u_0 of the depth camera: inverse depth rho_0 + g . (u - u_0), which is
/// exact on a plane. With p_d = T_d_c p_c, its depth z, its pixel u(p_d) and the scale s (ratio of measured
/// to true depth) and the offset o [1/m] of the sensor:
///
///   r = (1 / (s z) + o - rho_0 - g . (u(p_d) - u_0)) / sigma
/// The depth image is late by t_d, and read out like the color image: with the velocity v_c of the landmark
/// in the camera frame, p_c is that of the middle row of the color image plus (a T + t_d) v_c.
///
/// For a registered depth image T_c_d is the identity, t_d = 0, and u is the pixel u_c of the landmark in the
/// color image, displaced by c_d - c, with the centers c_d of `depth_camera` and c that is stated:
///
///   u = u_c + c_d - c
class DepthFactor final : public ceres::SizedCostFunction<1, 7, 7, 7, 4, 2, 3, 1, 1> {
 public:
  struct Measurement {
    double inverse_depth = 0.0;                            ///< rho_0 [1/m]
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();    ///< g [1/m/px]
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();       ///< u_0 [px]
    Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero();  ///< v_c [m/s]
    double row_fraction = 0.0;                             ///< a, of the color image
    std::optional<Eigen::Vector2d> registered_px = {};     ///< u_c - c, of a registered depth image
  };

  /// @param sigma of the inverse depth [1/m]
  DepthFactor(const Measurement& measurement, double sigma)
      : measurement_(measurement), weight_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Measurement measurement_;
  double weight_;
};

/// An edge of the depth image: the near side, of depth z, ends at the pixel u_d. It is projected to the color
/// image, and compared with an edge there, along the normal n of both, pixel u_e:
///
///   r = n . (project(T_c_d p_d - t_d v_c) - u_e) / sigma,   p_d = z ((u_d - c_d) / f_d, 1)
///
/// Parameter blocks: T_c_d, `depth_camera`, `camera`, t_d [s].
class EdgeFactor final : public ceres::SizedCostFunction<1, 7, 4, kCameraValues, 1> {
 public:
  struct Measurement {
    Eigen::Vector2d pixel;                                 ///< u_d [px]
    double depth_m = 0.0;                                  ///< z
    Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero();  ///< v_c [m/s]
    Eigen::Vector2d edge = Eigen::Vector2d::Zero();        ///< u_e [px]
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();     ///< n [1]
  };

  /// @param sigma_px standard deviation of the distance
  EdgeFactor(CameraModel model, const Measurement& measurement, double sigma_px)
      : model_(model), measurement_(measurement), weight_(1.0 / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  [[nodiscard]] Eigen::Vector3d point_in_color(const double* T_c_d, const double* depth_camera,
                                               double delay_s) const;

  CameraModel model_;
  Measurement measurement_;
  double weight_;
};

/// Pixel of a point in the camera frame.
/// @param camera as the parameter block
[[nodiscard]] Eigen::Vector2d projected_pixel(CameraModel model, const double* camera,
                                              const Eigen::Vector3d& p_c);

/// r = A (x - x_0). Ceres' NormalPrior would allocate matrices that this project frees in another way.
class LinearPriorFactor final : public ceres::CostFunction {
 public:
  LinearPriorFactor(Eigen::VectorXd mean, Eigen::MatrixXd A);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::VectorXd mean_;
  Eigen::MatrixXd A_;
};

/// r = ((p - p_0) / sigma_m, Log(q_0^-1 q) / sigma_rad).
class PosePrior final : public ceres::SizedCostFunction<6, 7> {
 public:
  PosePrior(const Pose& mean, double sigma_m, double sigma_rad)
      : mean_(mean), sigma_m_(sigma_m), sigma_rad_(sigma_rad) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Pose mean_;
  double sigma_m_, sigma_rad_;
};

/// A ground truth T_g_f of the frame f in its own world g, stamped by its own clock, at a keyframe of time t.
/// With the delay d of the ground truth, and T(d) = T_w_g T_g_f(t + d) T_f_b, whose T_g_f is interpolated:
///
///   r = ((p_w_b - p(d)) / sigma_m, Log(q(d)^-1 q_w_b) / sigma_rad)
///
/// Parameter blocks: T_w_b, T_w_g, T_f_b, d [s].
class TruthFactor final : public ceres::SizedCostFunction<6, 7, 7, 7, 1> {
 public:
  struct Sigmas {
    double position_m, rotation_rad;
  };

  /// @param truth at least two poses; must outlive the factor
  TruthFactor(const Trajectory& truth, Timestamp t, const Sigmas& sigmas)
      : truth_(truth), t_(t), sigmas_(sigmas) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Trajectory& truth_;
  Timestamp t_;
  Sigmas sigmas_;
};

/// Longest interval of a ground truth that is interpolated [s].
inline constexpr double kMaxTruthInterval_s = 0.15;

/// The pose at a time; nullopt beyond the ends, and in longer intervals.
[[nodiscard]] std::optional<Pose> truth_at(const Trajectory& truth, Timestamp t);

}  // namespace stillpoint
