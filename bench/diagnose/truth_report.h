// SPDX-License-Identifier: BSD-3-Clause
/// Compares the ground truth of a recording with its other sensors: clock, coordinate frame, scale, noise,
/// jumps.
///
/// With relative motions A of the truth's frame f and B of the camera over 0.5 s, A X = X B for X = T_f_c
/// (hand-eye calibration; Tsai and Lenz 1989). R_f_c comes from the angular rates (`fit_rotation`). Position
/// p of the camera in f and scale s of the camera's motion minimize
///   sum |(R_A - I) p - s R_f_c p_B + p_A|^2                        (errors of the truth), and
///   sum |((R_A - I) p + p_A) / s - R_f_c p_B|^2                    (errors of the images).
/// Errors of p_B reduce s by the first, errors of p_A increase it by the second: s is between both (Frisch
/// 1934, Statistical Confluence Analysis). The result is their mean (of s the geometric one), and half of
/// their difference is part of its deviation.
///
/// A camera whose stated center is off by d moves by images with depth to a side: with focal length f,
///   x_A / z_A - x_B / z_B = d_x / f, and likewise of y,
/// for motions forward or backward, in the coordinates of the camera. So does one whose truth is turned.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/diagnose/cause.h"
#include "bench/diagnose/evidence/recording_survey.h"

namespace stillpoint::bench {

struct ScaleFit {
  double scale = 1.0;           ///< true motion to that of the camera, > 0
  double relative_sigma = 1.0;  ///< of its logarithm
};

/// Lateral motion by the truth minus that by images, per forward motion: about x and y of the camera.
struct BearingFit {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();  ///< by the differences between seconds
};

struct TruthReport {
  std::size_t poses = 0;
  double interval_s = 0.0;                    ///< median time between consecutive poses
  double coverage = 0.0;                      ///< fraction of the frames between poses at most 0.1 s apart
  std::optional<datasets::LagFit> by_images;  ///< stamp of the truth minus that of the image
  std::optional<datasets::LagFit> by_gyro;    ///< stamp of the truth minus that of the gyroscope
  std::optional<datasets::RotationFit> rotation;  ///< R_f_c
  std::optional<Eigen::Vector3d> position;        ///< of the camera in f [m]
  Eigen::Vector3d position_sigma = Eigen::Vector3d::Zero();
  std::optional<BearingFit> bearing;  ///< nullopt with fewer than five seconds forward or backward
  std::optional<ScaleFit> scale;      ///< nullopt if its deviation exceeds 25 %
  double noise_m = 0.0;               ///< white noise per axis, by fourth differences
  std::vector<Timestamp> jumps;       ///< steps that the neighboring ones do not have
};

/// @param visual trajectory of the camera by a run without IMU; may be empty
/// @return all that can be told; nothing of a truth without poses or orientations
[[nodiscard]] TruthReport truth_report(const datasets::SequenceInfo& info, const RecordingSurvey& survey,
                                       const Trajectory& visual);

/// What the report contradicts.
[[nodiscard]] std::vector<Cause> truth_causes(const TruthReport& report, const datasets::SequenceInfo& info);

/// Which of "clock", "coordinate frame" and "scale" the motion does not determine.
[[nodiscard]] std::vector<std::string> undetermined_of_truth(const TruthReport& report);

/// Header and row of a table.
[[nodiscard]] std::string truth_table_header();
[[nodiscard]] std::string truth_table_row(const std::string& name, const TruthReport& report,
                                          const datasets::SequenceInfo& info);

}  // namespace stillpoint::bench
