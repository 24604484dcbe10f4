// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/bundle_adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <numeric>

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "core/backend/factors/ceres_manifolds.h"
#include "core/loop/loop_verification.h"
#include "core/loop/pose_graph_factors.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMinObservations = 3;
constexpr int kLandmarksPerKeyframe = 150;
// Distance of a pair from the graph. An object that moves as one piece can have most of the matches.
constexpr double kMaxDistance_m = 0.1;
constexpr double kMaxAngle_rad = 2.0 * std::numbers::pi / 180.0;

/// Sets of features that are the same point: union by the smaller index, with path halving.
class FeatureSets {
 public:
  explicit FeatureSets(std::span<const Keyframe> keyframes) {
    for (const Keyframe& keyframe : keyframes) {
      first_.push_back(parents_.size());
      parents_.resize(parents_.size() + keyframe.features.size());
    }
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t find(std::size_t keyframe, int feature) {
    return root(first_[keyframe] + static_cast<std::size_t>(feature));
  }
  void join(std::size_t a, std::size_t b) { parents_[std::max(a, b)] = std::min(a, b); }
  [[nodiscard]] std::size_t root(std::size_t element) {
    while (parents_[element] != element) element = parents_[element] = parents_[parents_[element]];
    return element;
  }

 private:
  std::vector<std::size_t> first_;  ///< element of the first feature of each keyframe
  std::vector<std::size_t> parents_;
};

class Association {
 public:
  Association(std::span<const Keyframe> keyframes, std::span<const Pose> T_m_b,
              const RelativePoseOptions& options)
      : keyframes_(keyframes), T_m_b_(T_m_b), options_(options), sets_(keyframes) {}

  void join_tracks() {
    std::map<std::int64_t, std::size_t> first;  // element of the first observation of each track
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      for (std::size_t f = 0; f < keyframes_[k].features.size(); ++f) {
        const std::int64_t track = keyframes_[k].features[f].track;
        if (track < 0) continue;
        const std::size_t element = sets_.find(k, static_cast<int>(f));
        const auto [found, is_new] = first.emplace(track, element);
        if (!is_new) sets_.join(sets_.root(found->second), element);
      }
    }
  }

  void join_matches(std::size_t query, std::size_t match) {
    const std::vector<KeyframeFeature>& of_query = keyframes_[query].features;
    const std::vector<KeyframeFeature>& of_match = keyframes_[match].features;
    const std::vector<FeatureMatch> matches = match_features(of_query, of_match);
    std::vector<PointPair> pairs;
    pairs.reserve(matches.size());
    for (const FeatureMatch& found : matches) {
      pairs.push_back({of_query[static_cast<std::size_t>(found.query)].p_c.cast<double>(),
                       of_match[static_cast<std::size_t>(found.match)].p_c.cast<double>()});
    }
    const std::optional<EstimatedRelativePose> estimate = estimate_relative_pose(pairs, options_);
    if (!estimate || !is_close(T_m_c(match).inverse() * T_m_c(query), estimate->T_m_q)) return;
    for (const int inlier : estimate->inliers) {
      const FeatureMatch& found = matches[static_cast<std::size_t>(inlier)];
      sets_.join(sets_.find(query, found.query), sets_.find(match, found.match));
    }
  }

  [[nodiscard]] std::vector<MapLandmark> landmarks() {
    std::map<std::size_t, MapLandmark> of_sets;
    for (std::size_t k = 0; k < keyframes_.size(); ++k) {
      for (std::size_t f = 0; f < keyframes_[k].features.size(); ++f) {
        const Eigen::Vector3d p_c = keyframes_[k].features[f].p_c.cast<double>();
        of_sets[sets_.find(k, static_cast<int>(f))].observations.push_back({static_cast<int>(k), p_c});
      }
    }
    std::vector<MapLandmark> all;
    for (auto& [set, landmark] : of_sets) {
      if (!is_usable(landmark)) continue;
      landmark.p_m = median_position(landmark);
      all.push_back(std::move(landmark));
    }
    return all;
  }

 private:
  [[nodiscard]] Pose T_m_c(std::size_t k) const { return T_m_b_[k] * keyframes_[k].T_b_c; }

  /// The median of each coordinate, which few wrong observations do not move far.
  [[nodiscard]] Eigen::Vector3d median_position(const MapLandmark& landmark) const {
    Eigen::Vector3d median;
    std::vector<double> values(landmark.observations.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::ranges::transform(landmark.observations, values.begin(), [&](const LandmarkObservation& seen) {
        return (T_m_c(static_cast<std::size_t>(seen.keyframe)) * seen.p_c)[axis];
      });
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median[axis] = *middle;
    }
    return median;
  }

  [[nodiscard]] static bool is_close(const Pose& a, const Pose& b) {
    return (a.p - b.p).norm() < kMaxDistance_m && a.q.angularDistance(b.q) < kMaxAngle_rad;
  }

  [[nodiscard]] static bool is_usable(const MapLandmark& landmark) {
    const auto& seen = landmark.observations;
    const auto same = [](const LandmarkObservation& a, const LandmarkObservation& b) {
      return a.keyframe == b.keyframe;
    };
    return seen.size() >= kMinObservations && std::ranges::adjacent_find(seen, same) == seen.end();
  }

  std::span<const Keyframe> keyframes_;
  std::span<const Pose> T_m_b_;
  RelativePoseOptions options_;
  FeatureSets sets_;
};

/// Those that most keyframes see, until each of their keyframes has enough.
std::vector<MapLandmark> chosen_landmarks(std::vector<MapLandmark> all, std::size_t keyframes) {
  std::ranges::stable_sort(all, [](const MapLandmark& a, const MapLandmark& b) {
    return a.observations.size() > b.observations.size();
  });
  std::vector<int> counts(keyframes, 0);
  const auto count_of = [&](const LandmarkObservation& seen) -> int& {
    return counts[static_cast<std::size_t>(seen.keyframe)];
  };
  std::erase_if(all, [&](const MapLandmark& landmark) {
    const bool is_needed = std::ranges::any_of(
        landmark.observations, [&](const auto& seen) { return count_of(seen) < kLandmarksPerKeyframe; });
    if (!is_needed) return true;
    for (const LandmarkObservation& seen : landmark.observations) ++count_of(seen);
    return false;
  });
  return all;
}

}  // namespace

std::vector<MapLandmark> associate_landmarks(std::span<const Keyframe> keyframes, std::span<const Pose> T_m_b,
                                             std::span<const GraphLoop> loops,
                                             const RelativePoseOptions& options) {
  Association association(keyframes, T_m_b, options);
  association.join_tracks();
  for (const GraphLoop& loop : loops)
    association.join_matches(static_cast<std::size_t>(loop.query), static_cast<std::size_t>(loop.match));
  return chosen_landmarks(association.landmarks(), keyframes.size());
}

namespace {

constexpr double kLargestResidual = 3.0;  // of an observation that has an effect
constexpr int kMaxIterations = 30;

class BundleProblem {
 public:
  BundleProblem(const PoseGraph& graph, std::span<const Keyframe> keyframes,
                std::span<const MapLandmark> landmarks, const BundleAdjustmentOptions& options)
      : options_(options), gravity_m_(mean_gravity(graph)), problem_(problem_options()) {
    for (const Pose& pose : graph.T_m_b) poses_.push_back(block_of(pose));
    for (PoseBlock& pose : poses_) problem_.AddParameterBlock(pose.data(), 7, &manifold_);
    problem_.SetParameterBlockConstant(poses_.front().data());
    for (const GraphEdge& edge : graph.odometry) add_odometry(edge);
    if (!gravity_m_.isZero()) add_gravity(graph);
    for (const MapLandmark& landmark : landmarks) add_landmark(landmark, keyframes);
  }

  [[nodiscard]] BundleAdjustmentSummary solve() {
    BundleAdjustmentSummary result{.landmarks = points_.size(), .observations = observations_.size()};
    result.rms_before = rms();
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector3d& point : points_) options.linear_solver_ordering->AddElementToGroup(point.data(), 0);
    for (PoseBlock& pose : poses_) options.linear_solver_ordering->AddElementToGroup(pose.data(), 1);
    if (!gravity_m_.isZero()) options.linear_solver_ordering->AddElementToGroup(gravity_m_.data(), 1);
    options.max_num_iterations = kMaxIterations;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    result.usable = summary.IsSolutionUsable();
    result.rms_after = rms();
    return result;
  }

  [[nodiscard]] std::vector<Pose> poses() const {
    std::vector<Pose> result;
    for (const PoseBlock& pose : poses_) result.push_back(pose_of(pose));
    return result;
  }

 private:
  struct Observation {
    Observation(const LandmarkObservation& seen, const Pose& T_b_c, const BundleAdjustmentOptions& options,
                const std::array<const double*, 2>& pose_and_landmark)
        : factor(seen.p_c, T_b_c, options.bearing_sigma, options.inverse_depth_sigma),
          blocks(pose_and_landmark) {}

    PointFactor factor;
    std::array<const double*, 2> blocks;  ///< pose, landmark
  };

  PoseBlock& pose(int keyframe) { return poses_[static_cast<std::size_t>(keyframe)]; }

  void add_odometry(const GraphEdge& edge) {
    odometry_.emplace_back(edge, one_);
    problem_.AddResidualBlock(&odometry_.back(), nullptr, pose(edge.i).data(), pose(edge.j).data());
  }

  void add_gravity(const PoseGraph& graph) {
    problem_.AddParameterBlock(gravity_m_.data(), 3, &sphere_);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!graph.gravity_b[i]) continue;
      gravity_.emplace_back(*graph.gravity_b[i], options_.gravity_sigma_rad);
      problem_.AddResidualBlock(&gravity_.back(), nullptr, poses_[i].data(), gravity_m_.data());
    }
  }

  /// Observations from behind the camera are left out: such features were matched wrongly.
  void add_landmark(const MapLandmark& landmark, std::span<const Keyframe> keyframes) {
    double* const point = points_.emplace_back(landmark.p_m).data();
    problem_.AddParameterBlock(point, 3);
    for (const LandmarkObservation& seen : landmark.observations) {
      double* const block = pose(seen.keyframe).data();
      const Pose& T_b_c = keyframes[static_cast<std::size_t>(seen.keyframe)].T_b_c;
      observations_.emplace_back(seen, T_b_c, options_, std::array<const double*, 2>{block, point});
      if (!std::isfinite(squared_residual(observations_.back()))) {
        observations_.pop_back();
      } else {
        problem_.AddResidualBlock(&observations_.back().factor, &tukey_, block, point);
      }
    }
  }

  static double squared_residual(const Observation& observation) {
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();
    if (!observation.factor.Evaluate(observation.blocks.data(), residual.data(), nullptr)) return INFINITY;
    return residual.squaredNorm();
  }

  /// Of the normalized residuals of the observations.
  [[nodiscard]] double rms() const {
    double sum = 0.0;
    for (const Observation& observation : observations_) sum += squared_residual(observation);
    return observations_.empty() ? 0.0 : std::sqrt(sum / (3.0 * static_cast<double>(observations_.size())));
  }

  BundleAdjustmentOptions options_;
  Eigen::Vector3d gravity_m_;
  PoseManifold manifold_;
  GravityManifold sphere_;
  ceres::TukeyLoss tukey_{kLargestResidual};
  double one_ = 1.0;
  std::deque<PoseBlock> poses_;  ///< addresses in deques are constant
  std::deque<Eigen::Vector3d> points_;
  std::deque<RelativePoseFactor> odometry_;
  std::deque<GravityFactor> gravity_;
  std::deque<Observation> observations_;
  ceres::Problem problem_;
};

}  // namespace

BundleAdjustmentResult adjust_bundle(const PoseGraph& graph, std::span<const Keyframe> keyframes,
                                     std::span<const MapLandmark> landmarks,
                                     const BundleAdjustmentOptions& options) {
  if (landmarks.empty()) return {.T_m_b = graph.T_m_b, .summary = {}};
  BundleProblem problem(graph, keyframes, landmarks, options);
  const BundleAdjustmentSummary summary = problem.solve();
  return {.T_m_b = summary.usable ? problem.poses() : graph.T_m_b, .summary = summary};
}

}  // namespace stillpoint
