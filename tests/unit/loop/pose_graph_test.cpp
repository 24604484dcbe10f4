// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/pose_graph.h"

#include <gtest/gtest.h>

#include "core/loop/pose_graph_factors.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/simulated/simulated_pose_graph.h"

namespace stillpoint {
namespace {

std::vector<double> values_of(const Pose& pose) {
  return {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()};
}

const Pose kFirst{exp_so3({0.3, -0.2, 1.1}), {1.0, -2.0, 0.5}};
const Pose kSecond{exp_so3({0.1, 0.4, 1.9}), {2.0, -1.0, 0.7}};

TEST(PoseGraph, TheJacobiansOfARelativePoseAreThoseOfItsResidual) {
  Matrix6 covariance = Matrix6::Identity();
  covariance(0, 4) = covariance(4, 0) = 0.3;
  const double weight = 0.6;
  const GraphEdge edge{.T_i_j = {exp_so3({0.5, 0.2, 0.9}), {0.4, 0.1, 0.0}}, .covariance = covariance};
  EXPECT_LT(jacobian_error(RelativePoseFactor(edge, weight), {values_of(kFirst), values_of(kSecond)}), 1e-8);
}

TEST(PoseGraph, TheJacobiansOfGravityAreThoseOfItsResidual) {
  const Eigen::Vector3d g = Eigen::Vector3d(0.1, -0.2, -1.0).normalized();
  const GravityFactor factor(Eigen::Vector3d(0.2, 0.1, -1.0).normalized(), 0.1);
  EXPECT_LT(jacobian_error(factor, {values_of(kFirst), {g.x(), g.y(), g.z()}}), 1e-7);
}

TEST(PoseGraph, FourDegreesOfFreedomKeepTheInclination) {
  const HeadingManifold manifold(-Eigen::Vector3d::UnitZ());
  const std::vector<double> before = values_of(kFirst);
  std::vector<double> turned = before;
  const double delta[4] = {0.1, 0.2, 0.3, 0.7};
  ASSERT_TRUE(manifold.Plus(before.data(), delta, turned.data()));
  const Eigen::Quaterniond q(turned.data() + 3);
  EXPECT_LT(
      (q.conjugate() * Eigen::Vector3d::UnitZ() - kFirst.q.conjugate() * Eigen::Vector3d::UnitZ()).norm(),
      1e-12);
  double difference[4];
  ASSERT_TRUE(manifold.Minus(turned.data(), before.data(), difference));
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(difference[i], delta[i], 1e-12);
}

TEST(PoseGraph, WeightsFallFromOneToZeroBetweenTheirLimits) {
  // mu = 1, c^2 = 4: limits at 2 and 8; at r^2 = 4, w = 2 / 2 sqrt(2) - 1.
  EXPECT_EQ(graduated_weight(2.0, 1.0, 4.0), 1.0);
  EXPECT_EQ(graduated_weight(8.0, 1.0, 4.0), 0.0);
  EXPECT_NEAR(graduated_weight(4.0, 1.0, 4.0), std::sqrt(2.0) - 1.0, 1e-15);
}

TEST(PoseGraph, ExactMeasurementsGiveTheTruePoses) {
  SimulatedPoseGraph simulated =
      simulated_pose_graph({.keyframes = 60, .keyframes_per_lap = 20, .loops = 6, .gravity = true});
  for (GraphEdge& edge : simulated.graph.odometry) {
    edge.T_i_j = simulated.truth[static_cast<std::size_t>(edge.i)].inverse() *
                 simulated.truth[static_cast<std::size_t>(edge.j)];
  }
  for (GraphEdge& edge : simulated.graph.loops) {
    edge.T_i_j = simulated.truth[static_cast<std::size_t>(edge.i)].inverse() *
                 simulated.truth[static_cast<std::size_t>(edge.j)];
  }
  const PoseGraphSolution solution = optimize_pose_graph(simulated.graph, {});
  EXPECT_LT(largest_error_m(solution.T_m_b, simulated.truth), 1e-5);
}

TEST(PoseGraph, LoopsRemoveTheDrift) {
  const SimulatedPoseGraph simulated = simulated_pose_graph({});
  const double before = largest_error_m(simulated.graph.T_m_b, simulated.truth);
  const PoseGraphSolution solution = optimize_pose_graph(simulated.graph, {});
  EXPECT_GT(before, 0.15);
  EXPECT_LT(largest_error_m(solution.T_m_b, simulated.truth), 0.35 * before);
}

TEST(PoseGraph, FalseLoopsAreOutliers) {
  const SimulatedPoseGraph simulated = simulated_pose_graph({.loops = 30, .false_every = 3});
  const PoseGraphSolution solution = optimize_pose_graph(simulated.graph, {});
  EXPECT_EQ(solution.inliers, simulated.true_loops);
  const PoseGraphSolution expected = [&] {
    SimulatedPoseGraph without = simulated;
    without.graph.loops.clear();
    for (std::size_t i = 0; i < simulated.true_loops.size(); ++i) {
      if (simulated.true_loops[i]) without.graph.loops.push_back(simulated.graph.loops[i]);
    }
    return optimize_pose_graph(without.graph, {});
  }();
  EXPECT_LT(largest_error_m(solution.T_m_b, expected.T_m_b), 1e-3);
}

TEST(PoseGraph, GravityKeepsTheMapLevel) {
  // Pitch drifts without bound in the odometry, and nothing but gravity observes it.
  SimulatedPoseGraph simulated = simulated_pose_graph({.loops = 0, .sigma_rad = 0.01, .gravity = true});
  const auto worst_tilt = [&](const std::vector<Pose>& poses) {
    double worst = 0.0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const Eigen::Vector3d up = poses[k].q * (simulated.truth[k].q.conjugate() * Eigen::Vector3d::UnitZ());
      worst = std::max(worst, std::acos(std::min(1.0, up.z())));
    }
    return worst;
  };
  EXPECT_GT(worst_tilt(simulated.graph.T_m_b), 0.05);
  EXPECT_LT(worst_tilt(optimize_pose_graph(simulated.graph, {}).T_m_b), 0.02);
}

TEST(PoseGraph, FourDegreesOfFreedomRemoveTheDriftOfHeading) {
  const SimulatedPoseGraph simulated = simulated_pose_graph({.gravity = true});
  const PoseGraphSolution solution = optimize_pose_graph(simulated.graph, {.dof = 4});
  EXPECT_LT(largest_error_m(solution.T_m_b, simulated.truth),
            0.5 * largest_error_m(simulated.graph.T_m_b, simulated.truth));
}

TEST(PoseGraph, IsDeterministic) {
  const SimulatedPoseGraph simulated = simulated_pose_graph({.loops = 30, .false_every = 6});
  const PoseGraphSolution a = optimize_pose_graph(simulated.graph, {});
  const PoseGraphSolution b = optimize_pose_graph(simulated.graph, {});
  for (std::size_t k = 0; k < a.T_m_b.size(); ++k) EXPECT_EQ(a.T_m_b[k].p, b.T_m_b[k].p);
}

}  // namespace
}  // namespace stillpoint
