// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories that the tests of figures draw.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/protocols/protocol.h"
#include "reports/drawing/evaluation/figures.h"

namespace stillpoint::report {

/// A circle of 2 m radius in 20 s, at 10 Hz, looking along its tangent.
inline Trajectory circle() {
  Trajectory path;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.02 * std::numbers::pi * i / 2.0;
    path.poses.emplace_back(
        from_seconds(0.1 * i),
        Pose{Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
             {2.0 * std::sin(angle), -2.0 * std::cos(angle), 0.1 * std::sin(3.0 * angle)}});
  }
  return path;
}

/// `circle` with a position error that grows with time, a rotation error that swings, and without the poses
/// of [8 s, 12 s].
inline Trajectory estimate(double error_m, double rotation_error_rad = 0.0) {
  Trajectory path = circle();
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    const double t_s = 0.1 * static_cast<double>(i);
    Pose& pose = path.poses[i].T_w_f;
    pose.p.x() += error_m * t_s / 20.0;
    pose.q = pose.q * Eigen::AngleAxisd(rotation_error_rad * std::sin(t_s), Eigen::Vector3d::UnitX());
  }
  std::erase_if(path.poses, [](const StampedPose& pose) {
    return pose.t > from_seconds(8.0) && pose.t < from_seconds(12.0);
  });
  return path;
}

/// Two estimates of a circle and their evaluations.
struct CircleRuns {
  Trajectory gt = circle();
  Trajectory near = estimate(0.1);
  Trajectory far = estimate(0.4);
  eval::ProtocolOptions options;
  eval::Evaluation near_errors = eval::evaluate("strict:se3", {gt, near, options});
  eval::Evaluation far_errors = eval::evaluate("strict:se3", {gt, far, options});
  std::vector<PlottedRun> runs{{"near", &near, &near_errors}, {"far", &far, &far_errors}};

  [[nodiscard]] FigureInput both() const { return {.gt = gt, .runs = runs}; }
  [[nodiscard]] FigureInput one() const { return {.gt = gt, .runs = std::span(runs).first(1)}; }
};

}  // namespace stillpoint::report
