// SPDX-License-Identifier: BSD-3-Clause
/// Initial rotation of the camera on the body and time offset, from rotations alone: those of the camera by
/// its features, and those of the body by the gyroscope.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/vision/feature_views.h"
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
  /// Of (theta, time offset), with q_b_c Exp(theta): the prior included.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  /// d^T (C + S)^-1 d of the difference d of q_b_c and time offset from the rig, with S what a calibration
  /// leaves: four degrees of freedom.
  double rig_contradiction = 0.0;
  double rotation_deviations = 0.0;  ///< see AlignedRotation::deviations
  bool is_certain = false;           ///< to 0.3 degrees and 1 ms
  /// The rotation of the rig was kept: the time offset is certain before, and the contradiction is its own
  /// (one degree of freedom).
  bool is_of_offset_alone = false;
};

/// Rotation of the camera from one frame to a later one, by vision alone.
struct CameraRotation {
  Timestamp begin, end;  ///< stamps of the frames
  Eigen::Quaterniond dq_c = Eigen::Quaterniond::Identity();
};

/// Collects rotations of the camera by vision alone (CameraRotations) at the start of a sequence and compares
/// them with the gyroscope. Neither states of the window nor depth scale, lever arm or gravity enter, so a
/// far-off calibration is found that the window, which linearizes all of them together, would not converge
/// from.
///
/// With the rotation dR_c of the camera from t_i to t_j and dR_b(d, b) of the
/// gyroscope from t_i + d to t_j + d with bias b, the residual is
///
///   r = Log(dR_b(d, b)^-1 R_b_c dR_c R_b_c^-1).
///
/// Gauss-Newton over R_b_c Exp(theta), d and b with the Cauchy loss; the configured standard deviations of
/// extrinsics, time offset and gyroscope bias about the rig are the prior, so an axis about which the camera
/// does not turn stays where it is. Jacobians, with the angular rates w_i, w_j at the ends:
///
///   dr/dtheta = R_b_c (dR_c^T - I),    dr/dd = dR_b^T w_i - w_j,    dr/db = -d Log(dR_b) / db.
///
/// A vibration has a minimum at each of its periods: a cart that vibrates at 10 Hz looks the same 100 ms
/// later. The steps therefore begin at the offset within `BackendConfig::time_offset_bound_s` of the rig, in
/// steps of 5 ms, where the mean of |r|, with the bias that makes the mean of r zero, is smallest, if it is
/// less than seven tenths of that at the rig.
class RotationAligner {
 public:
  RotationAligner(const BackendConfig& config, const Rig& rig);

  void add(const CameraRotation& rotation) { rotations_.push_back(rotation); }

  /// For each frame.
  /// @param now its stamp
  /// @param imu samples since the first frame
  /// @return the alignment once it is certain (0.3 degrees, 1 ms) after 1.5 s, and 3 s after the first frame
  /// in any case; before, once, that of the time offset alone when it is certain, after 0.5 s: later ones are
  /// relative to it
  [[nodiscard]] std::optional<RotationAlignment> align(Timestamp now, ImuBuffer& imu);

 private:
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
  [[nodiscard]] double initial_offset(ImuBuffer& imu) const;
  [[nodiscard]] RotationAlignment aligned(ImuBuffer& imu) const;
  [[nodiscard]] std::optional<RotationAlignment> align_offset(RotationAlignment initial,
                                                              ImuBuffer& imu) const;

  Eigen::Quaterniond q_b_c_;  ///< of the rig
  double time_offset_s_;      ///< of the rig, or aligned alone
  double offset_bound_s_;     ///< largest difference from it
  Unknowns prior_information_;
  std::optional<Timestamp> first_;  ///< stamp of the first frame
  std::vector<CameraRotation> rotations_;
  bool offset_is_aligned_ = false;
};

/// Rotations of the camera from each frame to the next one, by which the time offset is seen where the camera
/// vibrates, and successive ones over 0.2 s or more, which are more accurate. States and calibration of the
/// window are only their initial guess.
class CameraRotations {
 public:
  /// @param focal_px of the camera
  explicit CameraRotations(double focal_px);

  /// Adds the newest frame of a window with an IMU.
  /// @param window with labels of the newest features
  /// @return those that end at it, if at least 20 features determine them
  [[nodiscard]] std::vector<CameraRotation> add(const Window& window);

 private:
  [[nodiscard]] std::optional<CameraRotation> since(std::size_t from, const Pose& T_b_c);

  FeatureViews views_;
  Timestamp long_begin_;  ///< stamp at which the next rotation of 0.2 s begins
};

}  // namespace stillpoint
