// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/monocular_structure.h"

#include <algorithm>

#include "core/backend/solvers/window_solver.h"
#include "core/backend/start/camera_pose.h"
#include "core/backend/start/depth_initialization.h"
#include "core/backend/start/initializer.h"
#include "core/backend/start/relative_pose.h"

namespace stillpoint {
namespace {

/// Inlier thresholds: distance to the epipolar line, and reprojection error in PnP.
constexpr double kEpipolarInlier_px = 1.0;
constexpr double kLocalizationInlier_px = 5.0;

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

void set_camera_pose(const Pose& T_w_c, int frame, Window& window) {
  window.frames[static_cast<std::size_t>(frame)].state.T_w_b = T_w_c * window.T_b_c.inverse();
}

/// Triangulates the common features of reference and newest frame, scaled to a median depth of 1.
Points triangulate_reference_pair(const Reference& reference, double bearing_sigma, Window& window) {
  set_camera_pose(Pose{}, reference.frame, window);
  set_camera_pose(reference.T_reference_newest, window.newest(), window);
  Window pair = window;
  pair.frames = {window.frames[static_cast<std::size_t>(reference.frame)], window.frames.back()};
  Points points(window.landmarks.size());
  std::vector<double> depths;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (landmark.dynamic || landmark.host > reference.frame || landmark.last() != window.newest()) continue;
    const Landmark in_pair{
        .observations = {landmark.observation_in(reference.frame), landmark.observations.back()}};
    const double depth = triangulate_depth(pair, in_pair, bearing_sigma);
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
  set_camera_pose({reference.T_reference_newest.q, reference.T_reference_newest.p / *middle}, window.newest(),
                  window);
  return points;
}

/// Estimates the pose of a frame from known points (PnP), predicted from a localized neighbor.
bool localize(int frame, int neighbor, const Points& points, const Eigen::Quaterniond& q_neighbor_frame,
              double focal_px, Window& window) {
  std::vector<PointObservation> observations;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (points[i] && landmark.observed_in(frame))
      observations.push_back({*points[i], landmark.observation_in(frame).bearing});
  }
  const Pose T_w_cneighbor = window.T_w_c(neighbor);
  const Pose prediction{T_w_cneighbor.q * q_neighbor_frame, T_w_cneighbor.p};
  const std::optional<CameraPose> found =
      estimate_camera_pose(observations, prediction, {.inlier_threshold = kLocalizationInlier_px / focal_px});
  if (found) set_camera_pose(found->T_w_c, frame, window);
  return found.has_value();
}

/// The landmark with its observations in the frames from `first` on only.
Landmark truncate_before(int first, Landmark landmark) {
  if (landmark.host >= first) return landmark;
  landmark.observations.erase(landmark.observations.begin(),
                              landmark.observations.begin() + (first - landmark.host));
  landmark.host = first;
  return landmark;
}

/// Triangulates all landmarks from the frames from `first` on, which must be localized.
Points triangulate_from(int first, double bearing_sigma, const Window& window) {
  Points points(window.landmarks.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (window.landmarks[i].dynamic || window.landmarks[i].last() <= first) continue;
    Landmark landmark = truncate_before(first, window.landmarks[i]);
    const double depth = triangulate_depth(window, landmark, bearing_sigma);
    if (depth <= 0.0) continue;
    landmark.inverse_depth = 1.0 / depth;
    points[i] = window.position(landmark);
  }
  return points;
}

/// Localizes all frames except the initial pair.
bool localize_remaining(const Reference& reference, const Points& initial_points, const Rotations& rotations,
                        double focal_px, double bearing_sigma, Window& window) {
  for (int frame = reference.frame + 1; frame < window.newest(); ++frame) {
    const Eigen::Quaterniond q = camera_rotation(window, rotations, frame - 1, frame);
    if (!localize(frame, frame - 1, initial_points, q, focal_px, window)) return false;
  }
  for (int frame = reference.frame - 1; frame >= 0; --frame) {
    const Points points = triangulate_from(frame + 1, bearing_sigma, window);
    const Eigen::Quaterniond q = camera_rotation(window, rotations, frame + 1, frame);
    if (!localize(frame, frame + 1, points, q, focal_px, window)) return false;
  }
  return true;
}

/// Bundle adjustment. @return whether it converged to a sufficiently low cost
bool bundle_adjust(const BackendConfig& config, double focal_px, Window& window) {
  window.prior = initial_prior(window, config.initializer);
  BackendConfig adjustment = config;
  adjustment.max_iterations = kBundleAdjustmentIterations;
  const SolveReport report = solve_window(window, adjustment, focal_px);
  if (!report.usable || report.landmarks < config.initializer.min_common_features) return false;
  std::size_t observations = 0;
  for (const Landmark& landmark : window.landmarks) {
    if (is_usable(landmark)) observations += landmark.observations.size() - 1;
  }
  return report.final_cost <= kMaxMeanCost * static_cast<double>(observations);
}

}  // namespace

std::optional<Window> reconstruct_window(const Window& window, const BackendConfig& config, double focal_px) {
  const std::optional<Rotations> rotations = inertial_rotations(window);
  if (!rotations) return std::nullopt;
  const std::optional<Reference> reference = find_reference(window, *rotations, config.initializer, focal_px);
  if (!reference) return std::nullopt;

  const double bearing_sigma = config.pixel_sigma_px / focal_px;
  Window structure = window;
  const Points initial_points = triangulate_reference_pair(*reference, bearing_sigma, structure);
  if (!localize_remaining(*reference, initial_points, *rotations, focal_px, bearing_sigma, structure))
    return std::nullopt;
  for (Landmark& landmark : structure.landmarks) {
    const double depth = triangulate_depth(structure, landmark, bearing_sigma);
    landmark.inverse_depth = depth > 0.0 ? 1.0 / depth : 0.0;
    landmark.source = depth > 0.0 ? DepthSource::kTriangulated : DepthSource::kNone;
  }
  if (!bundle_adjust(config, focal_px, structure)) return std::nullopt;
  return structure;
}

}  // namespace stillpoint
