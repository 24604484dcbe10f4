// SPDX-License-Identifier: BSD-3-Clause
/// The variables of the batch estimation of a calibration, and their initial values.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/calibrate.h"
#include "core/calibration/calibration_factors.h"
#include "core/calibration/depth_edges.h"
#include "core/calibration/imu_axes_factor.h"

namespace stillpoint {

using PoseValues = std::array<double, 7>;       ///< p, q xyzw
using SpeedBiasValues = std::array<double, 9>;  ///< v, gyro bias, accel bias

/// The parameters that all keyframes share.
struct SharedValues {
  std::array<double, kCameraValues> camera{};
  double readout_s = 0.0;
  std::array<double, 2> depth = {1.0, 0.0};  ///< scale and offset [1/m], relative to the stated ones
  std::array<double, 4> depth_camera{};
  PoseValues T_b_c{}, T_c_d{};
  double time_offset_s = 0.0;
  ImuAxesValues imu_axes{};  ///< relative to the stated ones
  double depth_delay_s = 0.0;
  PoseValues T_f_b{};  ///< with the next: of the ground truth, see TruthFactor
  double truth_delay_s = 0.0;
};

[[nodiscard]] SharedValues shared_values(const RigCalibration& calibration);
/// @param stated from which scale and offset of the depth are counted
[[nodiscard]] RigCalibration rig_calibration(const SharedValues& shared, const RigCalibration& stated);

[[nodiscard]] PoseValues values_of(const Pose& pose);
[[nodiscard]] Pose pose_of(const PoseValues& values);

struct BatchObservation {
  int keyframe = 0;  ///< in `BatchState`
  CalibrationFeature feature;
  bool pixel_is_inlier = true;
  bool depth_is_inlier = true;
};

struct BatchLandmark {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  std::vector<BatchObservation> observations;

  [[nodiscard]] bool is_usable() const;  ///< three inliers
};

struct BatchKeyframe {
  Timestamp t;
  int section = 0;
  PoseValues pose{};
  SpeedBiasValues speed_bias{};
  cv::Mat depth, gray;
  std::vector<DepthEdge> edges;  ///< of depth images that are not registered
};

struct BatchState {
  std::vector<BatchKeyframe> keyframes;
  std::vector<BatchLandmark> landmarks;
  std::vector<Eigen::Vector3d> gravity_w;  ///< per section [m/s^2]
  SharedValues shared;
  double pixel_sigma_px = 1.0;
  double inverse_depth_sigma = 0.01;
  double edge_sigma_px = 2.0;
  ImuNoiseFactors imu_noise;
  std::vector<PoseValues> T_w_g;  ///< world of the ground truth, per section; empty without one
  double truth_sigma_m = 0.005, truth_sigma_rad = 0.01;
};

/// The keyframes from the fraction `begin` to the fraction `end` of all, with the landmarks that at least
/// three of them see and whose position measured depth or a parallax of one degree determines.
[[nodiscard]] BatchState initial_state(const CalibrationInput& input, double begin, double end);

}  // namespace stillpoint
