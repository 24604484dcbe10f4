// SPDX-License-Identifier: BSD-3-Clause
/// Passes poses to the library and back. This file is compiled with -march=native, the library for another
/// instruction set; values that arrive changed, or a crash, mean that the two disagree about the layout of
/// Eigen types.
#include <stillpoint/core/imu/propagation.h>
#include <stillpoint/eval/trajectory/alignment.h>

#include <cmath>
#include <cstdio>

namespace stillpoint {
namespace {

bool is_near(const char* what, double value, double expected) {
  if (std::abs(value - expected) < 1e-12) return true;
  std::printf("FAILED: %s is %.15g, expected %.15g\n", what, value, expected);
  return false;
}

bool is_pose(const char* what, const Pose& pose, const Pose& expected) {
  const bool rotation = is_near(what, (pose.q.coeffs() - expected.q.coeffs()).norm(), 0.0);
  return is_near(what, (pose.p - expected.p).norm(), 0.0) && rotation;
}

/// A quarter turn about z, and a shift.
Pose quarter_turn() {
  return Pose{Eigen::Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)), Eigen::Vector3d(1.0, 2.0, 3.0)};
}

/// The library reads vectors of poses, returns another, and aligns them: the result is the transform between
/// them.
bool trajectories_pass() {
  const Pose T_w_v = quarter_turn();
  Trajectory gt{.frame = "camera", .poses = {}};
  Trajectory est = gt;
  for (int i = 0; i < 5; ++i) {
    const Timestamp t{i * 100'000'000};
    const Pose T_v_f{Eigen::Quaterniond(std::cos(0.1 * i), std::sin(0.1 * i), 0.0, 0.0),
                     Eigen::Vector3d(i, i * i, 0.5 * i)};
    est.poses.push_back({t, T_v_f});
    gt.poses.push_back({t, T_w_v * T_v_f});
  }
  const std::vector<eval::MatchedPose> matches = eval::matched_poses(gt, est, eval::associate_tum(gt, est));
  bool same = is_near("the number of matches", static_cast<double>(matches.size()), 5.0);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    same = is_pose("a pose of the ground truth", matches[i].gt, gt.poses[i].T_w_f) && same;
    same = is_pose("a pose of the estimate", matches[i].est, est.poses[i].T_w_f) && same;
  }
  const eval::AlignmentResult aligned = eval::align(matches, eval::Alignment::kFirstPose);
  return is_pose("the alignment of the first pose", aligned.S_w_v.T_w_v, T_w_v) && same;
}

/// The library integrates IMU samples from a state: 1 m/s^2 along the body's x axis, which points along y of
/// the world, for one second from rest gives 1 m/s and a displacement of 1/2 m.
bool states_pass() {
  NavState start;
  start.T_w_b = quarter_turn();
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 10; ++i) {
    samples.push_back({Timestamp{i * 100'000'000}, Eigen::Vector3d::Zero(), Eigen::Vector3d(1.0, 0.0, 9.81)});
  }
  const NavState end = propagate(start, samples, Eigen::Vector3d(0.0, 0.0, -9.81));
  bool same = is_near("the time", to_seconds(end.t), 1.0);
  same = is_near("the velocity", (end.v_w - Eigen::Vector3d(0.0, 1.0, 0.0)).norm(), 0.0) && same;
  const Pose expected{start.T_w_b.q, Eigen::Vector3d(1.0, 2.5, 3.0)};
  return is_pose("the propagated pose", end.T_w_b, expected) && same;
}

}  // namespace
}  // namespace stillpoint

int main() {
  const bool trajectories = stillpoint::trajectories_pass();
  const bool states = stillpoint::states_pass();
  std::printf("trajectories %s, states %s\n", trajectories ? "pass" : "FAIL", states ? "pass" : "FAIL");
  return trajectories && states ? 0 : 1;
}
