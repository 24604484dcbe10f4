// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_consistency.h"

#include <gtest/gtest.h>

#include "tests/support/simulated/simulated_pose_graph.h"

namespace stillpoint {
namespace {

constexpr int kPerLap = 50;

struct Laps {
  std::vector<Pose> T_w_b;
  OdometryDrift drift;
  explicit Laps(int count) {
    for (int k = 0; k < count; ++k) {
      T_w_b.push_back(pose_on_circle(k, kPerLap));
      drift.add(from_seconds(0.2 * k), T_w_b.back());
    }
  }
  [[nodiscard]] GraphLoop loop(int match, int query, const Eigen::Vector3d& error) const {
    GraphLoop result{
        .match = match,
        .query = query,
        .T_bm_bq = T_w_b[static_cast<std::size_t>(match)].inverse() * T_w_b[static_cast<std::size_t>(query)],
        .covariance = 1e-4 * Matrix6::Identity()};
    result.T_bm_bq.p += error;
    return result;
  }
};

TEST(OdometryDrift, TheCovarianceOfTwoStepsIsThatOfTheirComposition) {
  // Straight motion of 2 m along x in two steps: the rotation of the first step moves the end by 1 m times
  // theta.
  OdometryDrift drift;
  for (int k = 0; k < 3; ++k)
    drift.add(from_seconds(k), {Eigen::Quaterniond::Identity(), {1.0 * k, 0.0, 0.0}});
  const Matrix6 step = drift.step_covariance(1);
  const Matrix6 both = drift.covariance(0, 2);
  EXPECT_NEAR(both(0, 0), 2.0 * step(0, 0), 1e-15);
  EXPECT_NEAR(both(1, 1), 2.0 * step(1, 1) + step(5, 5), 1e-15);
  EXPECT_NEAR(both(5, 5), 2.0 * step(5, 5), 1e-15);
  EXPECT_NEAR(both(1, 5), step(5, 5), 1e-15);
}

TEST(OdometryDrift, AWindowThatVisionHardlyLocatesClaimsNoMoreThanACentimeter) {
  const auto step_of = [](const Matrix6& claimed) {
    OdometryDrift drift;
    drift.add(from_seconds(0.0), {});
    drift.add(from_seconds(0.2), {}, claimed);
    return drift.step_covariance(1);
  };
  const Matrix6 walk = step_of(Matrix6::Zero());
  // Three standard deviations are added to the random walk: see the header.
  EXPECT_NEAR(step_of(pose_covariance(6.0, 1e-3))(1, 1) - walk(1, 1), 0.03 * 0.03, 1e-12);
  EXPECT_NEAR(step_of(pose_covariance(1e-3, 2.0))(4, 4) - walk(4, 4), 0.0157079633 * 0.0157079633, 1e-11);
  EXPECT_NEAR(step_of(pose_covariance(0.005, 1e-3))(1, 1) - walk(1, 1), 0.015 * 0.015, 1e-12);
}

/// Steps of 0.2 m along x. From the middle on, the odometry drifts along y, as its covariances say.
struct SidewaysDrift {
  static constexpr int kSteps = 20;
  static constexpr double kError_m = 0.1;
  std::vector<Pose> truth;
  PoseGraph graph;

  explicit SidewaysDrift(double sigma_m) {
    OdometryDrift drift;
    for (int k = 0; k <= kSteps; ++k) {
      const int drifting = std::max(0, k - kSteps / 2);
      truth.push_back({Eigen::Quaterniond::Identity(), {0.2 * k, 0.0, 0.0}});
      graph.T_m_b.push_back(truth.back());
      graph.T_m_b.back().p.y() += kError_m * drifting / (kSteps / 2);
      graph.gravity_b.emplace_back();
      Matrix6 covariance = pose_covariance(1e-4, 1e-5);
      if (drifting > 0) covariance(1, 1) = sigma_m * sigma_m;
      drift.add(from_seconds(0.2 * k), graph.T_m_b.back(), covariance);
      if (k > 0) add_step(k, drift);
    }
    graph.loops.push_back({.i = 0,
                           .j = kSteps,
                           .T_i_j = truth.front().inverse() * truth.back(),
                           .covariance = pose_covariance(0.005, 0.001)});
  }

  void add_step(int k, const OdometryDrift& drift) {
    const auto at = static_cast<std::size_t>(k);
    graph.odometry.push_back({.i = k - 1,
                              .j = k,
                              .T_i_j = graph.T_m_b[at - 1].inverse() * graph.T_m_b[at],
                              .covariance = drift.step_covariance(at)});
  }
};

TEST(OdometryDrift, ADriftInOneDirectionIsCorrectedWhereTheCovarianceOfTheWindowIsLarge) {
  const SidewaysDrift drift(0.03);
  const PoseGraphSolution solution = optimize_pose_graph(drift.graph, {});
  ASSERT_TRUE(solution.inliers.front());
  EXPECT_LT(largest_error_m(solution.T_m_b, drift.truth), 0.1 * SidewaysDrift::kError_m);
}

TEST(LoopConsistency, ALoopThatAgreesWithTheOdometryHasNoDistance) {
  const Laps laps(100);
  EXPECT_LT(odometry_distance(laps.loop(3, 53, Eigen::Vector3d::Zero()), laps.T_w_b, laps.drift), 1e-12);
}

TEST(LoopConsistency, AnotherAisleContradictsTheOdometry) {
  const Laps laps(100);
  EXPECT_GT(odometry_distance(laps.loop(3, 53, {2.0, 0.0, 0.0}), laps.T_w_b, laps.drift), 100.0);
}

TEST(LoopConsistency, LoopsAgreeWithEachOtherIfTheirErrorsAreEqual) {
  // The drift of the odometry over the lap does not enter: both loops measure it.
  const Laps laps(100);
  const GraphLoop first = laps.loop(3, 53, Eigen::Vector3d::Zero());
  EXPECT_LT(pairwise_distance(first, laps.loop(4, 54, Eigen::Vector3d::Zero()), laps.T_w_b, laps.drift),
            1e-9);
  EXPECT_GT(pairwise_distance(first, laps.loop(4, 54, {0.3, 0.0, 0.0}), laps.T_w_b, laps.drift), 27.9);
}

}  // namespace
}  // namespace stillpoint
