// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "core/backend/factors/ceres_manifolds.h"
#include "core/loop/pose_graph_factors.h"
#include "tests/support/simulated/simulated_pose_graph.h"
#include "tests/unit/loop/random_features.h"

namespace stillpoint {
namespace {

constexpr int kKeyframes = 40;  // half of them on the way out, half on the way back

TEST(BundleAdjustment, TheJacobiansOfAPointAreThoseOfItsResidual) {
  const Pose T_b_c{exp_so3({0.2, -0.1, 0.3}), {0.05, 0.02, -0.1}};
  const Pose T_m_b{exp_so3({0.3, -0.2, 1.1}), {1.0, -2.0, 0.5}};
  const PointFactor factor({0.3, -0.2, 2.1}, T_b_c, 0.01, 0.02);
  const PoseBlock pose = block_of(T_m_b);
  const Eigen::Vector3d X = T_m_b * (T_b_c * Eigen::Vector3d(0.4, -0.1, 2.0));
  const auto residual_at = [&](const Eigen::Vector<double, 9>& delta) {
    PoseBlock moved_pose = pose;
    PoseManifold().Plus(pose.data(), delta.data(), moved_pose.data());
    const Eigen::Vector3d moved_X = X + delta.tail<3>();
    const std::array<const double*, 2> blocks = {moved_pose.data(), moved_X.data()};
    Eigen::Vector3d residual;
    EXPECT_TRUE(factor.Evaluate(blocks.data(), residual.data(), nullptr));
    return residual;
  };
  Eigen::Matrix<double, 3, 7, Eigen::RowMajor> J_pose;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> J_X;
  std::array<double*, 2> jacobians = {J_pose.data(), J_X.data()};
  const std::array<const double*, 2> blocks = {pose.data(), X.data()};
  Eigen::Vector3d residual;
  ASSERT_TRUE(factor.Evaluate(blocks.data(), residual.data(), jacobians.data()));
  Eigen::Matrix<double, 3, 9> J;
  J << J_pose.leftCols<6>(), J_X;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector<double, 9> delta = 1e-6 * Eigen::Vector<double, 9>::Unit(i);
    const Eigen::Vector3d numeric = (residual_at(delta) - residual_at(-delta)) / 2e-6;
    EXPECT_LT((J.col(i) - numeric).norm(), 1e-6 * J.norm()) << i;
  }
}

/// A camera that moves sideways along a wall of points and back, with odometry that drifts.
struct Wall {
  std::vector<Pose> truth;
  std::vector<Keyframe> keyframes;
  PoseGraph graph;
  std::vector<GraphLoop> loops;
};

Pose pose_at(int k) {
  const int step = std::min(k, kKeyframes - 1 - k);
  return {exp_so3({0.02 * std::sin(k), 0.02 * std::cos(k), 0.0}), {0.2 * step, 0.05 * std::sin(k), 0.0}};
}

std::vector<KeyframeFeature> wall_points(std::mt19937_64& random, std::mt19937& noise) {
  std::vector<KeyframeFeature> points;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f lateral = normal_vector(noise, 1.0).cast<float>();
    points.push_back(
        {random_descriptor(random),
         {0.014F * static_cast<float>(i) - 1.5F, 0.5F * lateral.y(), 3.0F + 0.5F * std::abs(lateral.z())}});
  }
  return points;
}

/// The measured position: with noise of 0.0005 on the normalized image plane, and of 0.0005 / m.
Eigen::Vector3d measured(const Eigen::Vector3d& p_c, std::mt19937& noise) {
  const Eigen::Vector3d error = normal_vector(noise, 0.0005);
  const double z = 1.0 / (1.0 / p_c.z() + error.z());
  return z * Eigen::Vector3d(p_c.x() / p_c.z() + error.x(), p_c.y() / p_c.z() + error.y(), 1.0);
}

/// The odometry of the true poses, with errors.
PoseGraph drifting_graph(const std::vector<Pose>& truth, std::mt19937& noise) {
  PoseGraph graph{.T_m_b = {truth.front()}};
  graph.gravity_b.resize(truth.size());
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const Pose motion = disturbed(truth[k - 1].inverse() * truth[k], noise, 0.005, 0.001);
    graph.odometry.push_back({.i = static_cast<int>(k) - 1,
                              .j = static_cast<int>(k),
                              .T_i_j = motion,
                              .covariance = pose_covariance(0.005, 0.001)});
    graph.T_m_b.push_back(graph.T_m_b.back() * motion);
  }
  return graph;
}

/// @param wrong_every each of so many features is at a wrong place; 0: none
Wall make_wall(int wrong_every) {
  std::mt19937_64 random(3);
  std::mt19937 noise(5);
  const std::vector<KeyframeFeature> points = wall_points(random, noise);
  Wall wall;
  int observations = 0;
  for (int k = 0; k < kKeyframes; ++k) {
    wall.truth.push_back(pose_at(k));
    Keyframe keyframe{.frame = k, .t = from_seconds(k)};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_c = wall.truth.back().inverse() * points[i].p_c.cast<double>();
      if (std::abs(p_c.x()) > 0.6 * p_c.z() || std::abs(p_c.y()) > 0.4 * p_c.z()) continue;
      Eigen::Vector3d seen = measured(p_c, noise);
      if (wrong_every > 0 && ++observations % wrong_every == 0) seen.x() += 0.3;
      const auto track = static_cast<std::int64_t>(i) + (k < kKeyframes / 2 ? 0 : 1000);
      keyframe.features.push_back(
          {with_flipped_bits(points[i].descriptor, 10, random), seen.cast<float>(), track});
    }
    wall.keyframes.push_back(std::move(keyframe));
  }
  wall.graph = drifting_graph(wall.truth, noise);
  for (int k = 0; k < kKeyframes / 2; k += 5) wall.loops.push_back({.match = k, .query = kKeyframes - 1 - k});
  return wall;
}

double largest_error(const Wall& wall, const std::vector<Pose>& T_m_b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < T_m_b.size(); ++k)
    largest = std::max(largest, (T_m_b[k].p - wall.truth[k].p).norm());
  return largest;
}

std::vector<MapLandmark> landmarks_of(const Wall& wall) {
  // Matches must be close to the graph: it is that of the truth here, as after its optimization.
  return associate_landmarks(wall.keyframes, wall.truth, wall.loops, {.inlier_threshold = 0.01});
}

TEST(BundleAdjustment, LandmarksOfBothVisitsRemoveTheDrift) {
  const Wall wall = make_wall(0);
  const BundleAdjustmentResult adjusted = adjust_bundle(wall.graph, wall.keyframes, landmarks_of(wall), {});
  EXPECT_TRUE(adjusted.summary.usable);
  EXPECT_GT(adjusted.summary.landmarks, 200u);
  EXPECT_GT(largest_error(wall, wall.graph.T_m_b), 0.06);
  EXPECT_LT(largest_error(wall, adjusted.T_m_b), 0.02);
  EXPECT_LT(adjusted.summary.rms_after, adjusted.summary.rms_before);
}

TEST(BundleAdjustment, WrongObservationsHaveNoEffect) {
  const Wall wall = make_wall(4);
  const std::vector<MapLandmark> landmarks = landmarks_of(wall);
  PoseGraph graph = wall.graph;
  graph.T_m_b = wall.truth;
  EXPECT_LT(largest_error(wall, adjust_bundle(graph, wall.keyframes, landmarks, {}).T_m_b), 0.02);
}

TEST(BundleAdjustment, WithoutLandmarksThePosesRemain) {
  const Wall wall = make_wall(0);
  const BundleAdjustmentResult adjusted = adjust_bundle(wall.graph, wall.keyframes, {}, {});
  EXPECT_EQ(adjusted.T_m_b.back().p, wall.graph.T_m_b.back().p);
}

TEST(LandmarkAssociation, ALoopJoinsTheTracksOfBothVisits) {
  Wall wall = make_wall(0);
  const auto visits = [](const std::vector<MapLandmark>& landmarks) {
    return std::ranges::count_if(landmarks, [](const MapLandmark& landmark) {
      return landmark.observations.front().keyframe < kKeyframes / 2 &&
             landmark.observations.back().keyframe >= kKeyframes / 2;
    });
  };
  EXPECT_GT(visits(landmarks_of(wall)), 100);
  wall.loops.clear();
  EXPECT_EQ(visits(landmarks_of(wall)), 0);
}

TEST(LandmarkAssociation, PointsWithTwoFeaturesOfOneKeyframeAreLeftOut) {
  Wall wall = make_wall(0);
  wall.loops.clear();
  const std::int64_t track = wall.keyframes[10].features[20].track;
  const auto has_track = [&](const MapLandmark& landmark) {
    const LandmarkObservation& seen = landmark.observations.front();
    return std::ranges::any_of(wall.keyframes[static_cast<std::size_t>(seen.keyframe)].features,
                               [&](const KeyframeFeature& feature) {
                                 return feature.track == track && feature.p_c.cast<double>() == seen.p_c;
                               });
  };
  EXPECT_TRUE(std::ranges::any_of(landmarks_of(wall), has_track));
  wall.keyframes[10].features.push_back(wall.keyframes[10].features[20]);
  EXPECT_FALSE(std::ranges::any_of(landmarks_of(wall), has_track));
}

}  // namespace
}  // namespace stillpoint
