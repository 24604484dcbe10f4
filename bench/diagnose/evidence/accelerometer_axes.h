// SPDX-License-Identifier: BSD-3-Clause
/// Compares the accelerometer with the motion between images: its axes, and the scale of depth.
///
/// Over times t_i < t_j < t_k of 0.2 s each, with position P and rotation R of the camera by images, the
/// scale s of the true depth to the stated one, specific force f and gravity g,
///   s [(P_k - P_j) / (t_k - t_j) - (P_j - P_i) / (t_j - t_i)] = integral w(t) (R R_c_b A f + g) dt,
/// where w rises from 0 at t_i to 1 at t_j and falls to 0 at t_k; A permutes and inverts axes. In blocks of
/// 1.5 s the part of both sides along the integral of w is that of gravity. See ImagePlausibility.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "bench/diagnose/evidence/recording_survey.h"

namespace stillpoint::bench {

struct AccelerometerAxes {
  Eigen::Matrix3d P = Eigen::Matrix3d::Identity();  ///< true force = P * recorded force
  double correlation = 0.0;                         ///< of both sides with P
  double stated = 0.0;                              ///< without P
  bool by_truth = false;                            ///< as images do not tell
  /// The gyroscope follows the ground truth with P, too: axes of both, or of the ground truth.
  bool gyroscope_too = false;
};

/// By the images, or by the ground truth, whose positions resolve a vibration; over 0.05 s then.
/// @return nullopt if no other axes follow clearly better, or the motion does not tell
[[nodiscard]] std::optional<AccelerometerAxes> accelerometer_axes(const datasets::SequenceInfo& info,
                                                                  const RecordingSurvey& survey);

/// Part of the mean specific force along the z axis of the ground truth: 1 if that points up and the axes of
/// the accelerometer are right, -1 if these are inverted.
/// @return nullopt without ground truth, or if the force has no steady direction in it
[[nodiscard]] std::optional<double> upward_part_of_force(const datasets::SequenceInfo& info);

/// s with its standard deviation, by the differences between blocks.
struct InertialScale {
  double scale = 1.0;
  double sigma = 1.0;
};

/// @return nullopt without four blocks in which the accelerometer follows the images (correlation of at least
/// 0.9)
[[nodiscard]] std::optional<InertialScale> inertial_depth_scale(const datasets::SequenceInfo& info,
                                                                const RecordingSurvey& survey);

}  // namespace stillpoint::bench
