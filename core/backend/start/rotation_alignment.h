// SPDX-License-Identifier: BSD-3-Clause
/// Initial rotation of the camera on the body and time offset, from rotations alone.
#pragma once

#include <optional>
#include <vector>

#include "core/config/backend_config.h"
#include "core/geometry/pose.h"
#include "core/imu/imu_buffer.h"
#include "core/types/rig.h"

namespace stillpoint {

/// A calibration that explains why camera and gyroscope turn differently.
struct RotationAlignment {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
  double time_offset_s = 0.0;                           ///< of the IMU clock, as in Rig
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  double rotation_sigma_rad = 0.0;                      ///< largest standard deviation of q_b_c about an axis
  double offset_sigma_s = 0.0;
};

/// Collects the rotation of the camera by visual odometry at the start of a sequence and compares it with the
/// gyroscope. Neither depth scale nor lever arm nor gravity enters, so a far-off calibration is found that
/// the window, which linearizes all of them together, would not converge from.
///
/// For successive frames i, j at least 0.1 s apart, with the rotation dR_c of the camera and dR_b(d, b) of
/// the gyroscope from t_i + d to t_j + d with bias b, the residual is
///
///   r = Log(dR_b(d, b)^-1 R_b_c dR_c R_b_c^-1).
///
/// Gauss-Newton over R_b_c Exp(theta), d and b with the Cauchy loss; the configured standard deviations of
/// extrinsics, time offset and gyroscope bias about the rig are the prior, so an axis about which the camera
/// does not turn stays where it is. Jacobians, with the angular rates w_i, w_j at the ends:
///
///   dr/dtheta = R_b_c (dR_c^T - I),    dr/dd = dR_b^T w_i - w_j,    dr/db = -d Log(dR_b) / db.
class RotationAligner {
 public:
  RotationAligner(const BackendConfig& config, const Rig& rig);

  /// Adds the newest frame.
  /// @param q_w_c by vision alone
  void add(Timestamp t, const Eigen::Quaterniond& q_w_c);

  /// After a loss: rotations before and after it are not compared.
  void reset() { views_.clear(); }

  /// @param imu samples since the first frame
  /// @return the alignment once it is certain (0.3 degrees, 1 ms), and after 3 s in any case; nothing in the
  /// first 1.5 s
  [[nodiscard]] std::optional<RotationAlignment> align(ImuBuffer& imu) const;

 private:
  struct View {
    Timestamp t;
    Eigen::Quaterniond q_w_c;
  };
  /// theta, d, b.
  using Unknowns = Eigen::Matrix<double, 7, 1>;
  struct Residual {
    Eigen::Vector3d r;
    Eigen::Matrix<double, 3, 7> J;
  };
  struct NormalEquations {
    Eigen::Matrix<double, 7, 7> H;
    Unknowns g;
  };

  [[nodiscard]] std::vector<Residual> residuals(const RotationAlignment& at, ImuBuffer& imu) const;
  [[nodiscard]] NormalEquations normal_equations(const RotationAlignment& at, ImuBuffer& imu) const;

  Eigen::Quaterniond q_b_c_;  ///< of the rig
  double time_offset_s_;      ///< of the rig
  Unknowns prior_information_;
  std::vector<View> views_;  ///< at least 0.1 s apart
};

}  // namespace stillpoint
