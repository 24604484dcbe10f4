// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/monocular_structure.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "core/backend/start/depth_initialization.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/vision/camera_pose.h"

namespace stillpoint {
namespace {

constexpr int kMinimalSample = 5;
constexpr double kConfidence = 0.999;

/// Points farther away than this are ignored in the selection among the four decompositions (cheirality).
constexpr double kFarthest_baselines = 200.0;

}  // namespace

std::optional<RelativePose> estimate_relative_pose(const std::vector<BearingPair>& pairs, double threshold,
                                                   int min_inliers) {
  if (static_cast<int>(pairs.size()) < std::max(min_inliers, kMinimalSample)) return std::nullopt;
  std::vector<cv::Point2d> first;
  std::vector<cv::Point2d> second;
  for (const BearingPair& pair : pairs) {
    first.emplace_back(pair.first.x(), pair.first.y());
    second.emplace_back(pair.second.x(), pair.second.y());
  }
  const cv::Mat camera = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat mask;
  const cv::Mat essential =
      cv::findEssentialMat(first, second, camera, cv::RANSAC, kConfidence, threshold, mask);
  if (essential.rows != 3 || essential.cols != 3) return std::nullopt;

  cv::Mat rotation;
  cv::Mat translation;
  const int inliers =
      cv::recoverPose(essential, first, second, camera, rotation, translation, kFarthest_baselines, mask);
  if (inliers < min_inliers) return std::nullopt;
  const Eigen::Matrix3d R_second_first =
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.ptr<double>());
  const Pose T_second_first{Eigen::Quaterniond(R_second_first),
                            Eigen::Map<Eigen::Vector3d>(translation.ptr<double>())};
  return RelativePose{T_second_first.inverse(), inliers};
}

namespace {

/// Inlier threshold of the essential matrix: distance to the epipolar line.
constexpr double kEpipolarInlier_px = 1.0;

/// The initial structure is far from the minimum and needs more iterations than a tracked window.
constexpr int kBundleAdjustmentIterations = 50;

/// Largest accepted mean robust cost per observation: that of an error of one standard deviation.
constexpr double kMaxMeanCost = 0.5;

using Points = std::vector<std::optional<Eigen::Vector3d>>;  // per landmark, in the world
using Rotations = std::vector<Eigen::Quaterniond>;           // q_b0_bk per frame k

/// Preintegrated rotations, with the biases of the integration.
std::optional<Rotations> inertial_rotations(const Window& window) {
  Rotations rotations{Eigen::Quaterniond::Identity()};
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const std::optional<Preintegration>& imu = window.frames[i].from_previous;
    if (!imu) return std::nullopt;
    rotations.push_back(rotations.back() * imu->delta_q(imu->gyro_bias()));
  }
  return rotations;
}

/// q_ci_cj from inertial rotations and extrinsics.
Eigen::Quaterniond camera_rotation(const Window& window, const Rotations& rotations, int i, int j) {
  const Eigen::Quaterniond q_bi_bj =
      rotations[static_cast<std::size_t>(i)].conjugate() * rotations[static_cast<std::size_t>(j)];
  return window.T_b_c.q.conjugate() * q_bi_bj * window.T_b_c.q;
}

std::vector<BearingPair> common_bearings(const Window& window, int i, int j) {
  std::vector<BearingPair> pairs;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || !landmark.observed_in(i) || !landmark.observed_in(j)) continue;
    pairs.push_back({landmark.observation_in(i).bearing, landmark.observation_in(j).bearing});
  }
  return pairs;
}

/// Mean rotation-compensated displacement on the normalized image plane.
double mean_parallax(const std::vector<BearingPair>& pairs, const Eigen::Quaterniond& q_first_second) {
  double sum = 0.0;
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector3d rotated = q_first_second * pair.second.homogeneous();
    sum += (rotated.hnormalized() - pair.first).norm();
  }
  return pairs.empty() ? 0.0 : sum / static_cast<double>(pairs.size());
}

/// The frame that, with the newest one, forms the initial pair.
struct Reference {
  int frame = 0;
  Pose T_reference_newest;
};

std::optional<Reference> find_reference(const Window& window, const Rotations& rotations,
                                        const InitializerConfig& config, double focal_px) {
  for (int frame = 0; frame < window.newest(); ++frame) {
    const std::vector<BearingPair> pairs = common_bearings(window, frame, window.newest());
    if (static_cast<int>(pairs.size()) < config.min_common_features) continue;
    const Eigen::Quaterniond q = camera_rotation(window, rotations, frame, window.newest());
    if (focal_px * mean_parallax(pairs, q) < config.min_parallax_px) continue;
    const std::optional<RelativePose> pose =
        estimate_relative_pose(pairs, kEpipolarInlier_px / focal_px, config.min_common_features / 2);
    if (pose) return Reference{frame, pose->T_first_second};
  }
  return std::nullopt;
}

/// The landmark with its observations in the frames from `first` on only.
Landmark truncate_before(int first, Landmark landmark) {
  if (landmark.host >= first) return landmark;
  landmark.observations.erase(landmark.observations.begin(),
                              landmark.observations.begin() + (first - landmark.host));
  landmark.host = first;
  return landmark;
}

/// The window whose poses and depths are estimated, step by step.
class Structure {
 public:
  Structure(const Window& window, const BackendConfig& config, double focal_px)
      : window_(window),
        config_(config),
        focal_px_(focal_px),
        bearing_sigma_(config.feature_sigma_px / focal_px) {}

  // The steps of `reconstruct_window`, in this order; false if a step fails.
  [[nodiscard]] Points triangulate_reference_pair(const Reference& reference);
  [[nodiscard]] bool localize_remaining(const Reference& reference, const Points& initial_points,
                                        const Rotations& rotations);
  void triangulate_landmarks();
  [[nodiscard]] bool bundle_adjust(WindowSolver& solver);

  [[nodiscard]] Window release() { return std::move(window_); }

 private:
  struct Neighbor {
    int frame;  ///< localized
    Eigen::Quaterniond q_neighbor_frame;
  };
  void set_camera_pose(const Pose& T_w_c, int frame);
  [[nodiscard]] bool localize(int frame, const Neighbor& neighbor, const Points& points);
  [[nodiscard]] Points triangulate_from(int first) const;

  Window window_;
  const BackendConfig& config_;
  double focal_px_;
  double bearing_sigma_;
};

void Structure::set_camera_pose(const Pose& T_w_c, int frame) {
  window_.frames[static_cast<std::size_t>(frame)].state.T_w_b = T_w_c * window_.T_b_c.inverse();
}

/// Triangulates the common features of reference and newest frame, scaled to a median depth of 1.
Points Structure::triangulate_reference_pair(const Reference& reference) {
  set_camera_pose(Pose{}, reference.frame);
  set_camera_pose(reference.T_reference_newest, window_.newest());
  Window pair = window_;
  pair.frames = {window_.frames[static_cast<std::size_t>(reference.frame)], window_.frames.back()};
  Points points(window_.landmarks.size());
  std::vector<double> depths;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window_.landmarks[i];
    if (landmark.dynamic || landmark.host > reference.frame || landmark.last() != window_.newest()) continue;
    const Landmark in_pair{
        .observations = {landmark.observation_in(reference.frame), landmark.observations.back()}};
    const double depth = triangulate_depth(pair, in_pair, bearing_sigma_);
    if (depth <= 0.0) continue;
    points[i] = depth * in_pair.observations.front().bearing.homogeneous();
    depths.push_back(depth);
  }
  if (depths.empty()) return points;

  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  for (std::optional<Eigen::Vector3d>& point : points) {
    if (point) *point /= *middle;
  }
  set_camera_pose({reference.T_reference_newest.q, reference.T_reference_newest.p / *middle},
                  window_.newest());
  return points;
}

/// Estimates the pose of a frame from known points (PnP), predicted from a localized neighbor.
bool Structure::localize(int frame, const Neighbor& neighbor, const Points& points) {
  std::vector<PointObservation> observations;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window_.landmarks[i];
    if (points[i] && landmark.observed_in(frame))
      observations.push_back({*points[i], landmark.observation_in(frame).bearing});
  }
  const Pose T_w_cneighbor = window_.T_w_c(neighbor.frame);
  const Pose prediction{T_w_cneighbor.q * neighbor.q_neighbor_frame, T_w_cneighbor.p};
  const std::optional<CameraPose> found = estimate_camera_pose(
      observations, prediction, {.inlier_threshold = kLocalizationInlier_px / focal_px_});
  if (found) set_camera_pose(found->T_w_c, frame);
  return found.has_value();
}

/// Triangulates all landmarks from the frames from `first` on, which must be localized.
Points Structure::triangulate_from(int first) const {
  Points points(window_.landmarks.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (window_.landmarks[i].dynamic || window_.landmarks[i].last() <= first) continue;
    Landmark landmark = truncate_before(first, window_.landmarks[i]);
    const double depth = triangulate_depth(window_, landmark, bearing_sigma_);
    if (depth <= 0.0) continue;
    landmark.inverse_depth = 1.0 / depth;
    points[i] = window_.position(landmark);
  }
  return points;
}

/// Localizes all frames except the initial pair.
bool Structure::localize_remaining(const Reference& reference, const Points& initial_points,
                                   const Rotations& rotations) {
  for (int frame = reference.frame + 1; frame < window_.newest(); ++frame) {
    const Eigen::Quaterniond q = camera_rotation(window_, rotations, frame - 1, frame);
    if (!localize(frame, {frame - 1, q}, initial_points)) return false;
  }
  for (int frame = reference.frame - 1; frame >= 0; --frame) {
    const Points points = triangulate_from(frame + 1);
    const Eigen::Quaterniond q = camera_rotation(window_, rotations, frame + 1, frame);
    if (!localize(frame, {frame + 1, q}, points)) return false;
  }
  return true;
}

void Structure::triangulate_landmarks() {
  for (Landmark& landmark : window_.landmarks) {
    const double depth = triangulate_depth(window_, landmark, bearing_sigma_);
    landmark.inverse_depth = depth > 0.0 ? 1.0 / depth : 0.0;
    landmark.source = depth > 0.0 ? DepthSource::kTriangulated : DepthSource::kNone;
  }
}

/// Bundle adjustment. @return whether it converged to a sufficiently low cost
bool Structure::bundle_adjust(WindowSolver& solver) {
  window_.prior = initial_prior(window_, config_);
  BackendConfig adjustment = config_;
  adjustment.max_iterations = kBundleAdjustmentIterations;
  const SolveReport report = solver.solve(window_, adjustment, focal_px_);
  if (!report.usable || report.landmarks < config_.initializer.min_common_features) return false;
  std::size_t observations = 0;
  for (const Landmark& landmark : window_.landmarks) {
    if (is_usable(landmark)) observations += landmark.observations.size() - 1;
  }
  return report.final_cost <= kMaxMeanCost * static_cast<double>(observations);
}

}  // namespace

std::optional<Window> reconstruct_window(const Window& window, const BackendConfig& config, double focal_px,
                                         WindowSolver& solver) {
  const std::optional<Rotations> rotations = inertial_rotations(window);
  if (!rotations) return std::nullopt;
  const std::optional<Reference> reference = find_reference(window, *rotations, config.initializer, focal_px);
  if (!reference) return std::nullopt;

  Structure structure(window, config, focal_px);
  const Points initial_points = structure.triangulate_reference_pair(*reference);
  if (!structure.localize_remaining(*reference, initial_points, *rotations)) return std::nullopt;
  structure.triangulate_landmarks();
  if (!structure.bundle_adjust(solver)) return std::nullopt;
  return structure.release();
}

}  // namespace stillpoint
