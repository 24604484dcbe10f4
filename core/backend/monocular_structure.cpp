// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/monocular_structure.h"

#include <algorithm>

#include "core/backend/camera_pose.h"
#include "core/backend/depth_initialization.h"
#include "core/backend/initializer.h"
#include "core/backend/relative_pose.h"
#include "core/backend/window_solver.h"

namespace stillpoint {
namespace {

/// Distance to the epipolar line, and reprojection while frames are located.
constexpr double kEpipolarInlier_px = 1.0;
constexpr double kLocateInlier_px = 5.0;

/// A start is far from the minimum: more iterations than a window that follows its predecessor.
constexpr int kAdjustIterations = 50;

/// Robust cost of an observation, on average, above which the structure does not explain the tracks: that of
/// one standard deviation.
constexpr double kMaxMeanCost = 0.5;

using Points = std::vector<std::optional<Eigen::Vector3d>>;  // of each landmark, in the world
using Rotations = std::vector<Eigen::Quaterniond>;           // q_b0_bk of each frame k

/// Rotations by gyroscopes with the biases that the samples were integrated with.
std::optional<Rotations> inertial_rotations(const Window& window) {
  Rotations rotations{Eigen::Quaterniond::Identity()};
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    const std::optional<Preintegration>& imu = window.frames[i].from_previous;
    if (!imu) return std::nullopt;
    rotations.push_back(rotations.back() * imu->delta_q(imu->gyro_bias()));
  }
  return rotations;
}

/// From inertial rotations and the window's extrinsics: q_ci_cj.
Eigen::Quaterniond camera_rotation(const Window& window, const Rotations& rotations, int i, int j) {
  const Eigen::Quaterniond q_bi_bj =
      rotations[static_cast<std::size_t>(i)].conjugate() * rotations[static_cast<std::size_t>(j)];
  return window.T_b_c.q.conjugate() * q_bi_bj * window.T_b_c.q;
}

std::vector<BearingPair> common_bearings(const Window& window, int i, int j) {
  std::vector<BearingPair> pairs;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || !landmark.seen_in(i) || !landmark.seen_in(j)) continue;
    pairs.push_back({landmark.in(i).bearing, landmark.in(j).bearing});
  }
  return pairs;
}

/// Mean displacement on the normalised plane that rotation does not explain.
double mean_parallax(const std::vector<BearingPair>& pairs, const Eigen::Quaterniond& q_first_second) {
  double sum = 0.0;
  for (const BearingPair& pair : pairs) {
    const Eigen::Vector3d turned = q_first_second * pair.second.homogeneous();
    sum += (turned.hnormalized() - pair.first).norm();
  }
  return pairs.empty() ? 0.0 : sum / static_cast<double>(pairs.size());
}

/// The frame that starts the structure together with the newest.
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

void place_camera(const Pose& T_w_c, int frame, Window& window) {
  window.frames[static_cast<std::size_t>(frame)].state.T_w_b = T_w_c * window.T_b_c.inverse();
}

/// Triangulates what the reference and the newest frame both see, and scales so that their median depth is 1.
Points start_structure(const Reference& reference, double bearing_sigma, Window& window) {
  place_camera(Pose{}, reference.frame, window);
  place_camera(reference.T_reference_newest, window.newest(), window);
  Window two = window;
  two.frames = {window.frames[static_cast<std::size_t>(reference.frame)], window.frames.back()};
  Points points(window.landmarks.size());
  std::vector<double> depths;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (landmark.dynamic || landmark.host > reference.frame || landmark.last() != window.newest()) continue;
    const Landmark seen{.observations = {landmark.in(reference.frame), landmark.observations.back()}};
    const double depth = triangulate_depth(two, seen, bearing_sigma);
    if (depth <= 0.0) continue;
    points[i] = depth * seen.observations.front().bearing.homogeneous();
    depths.push_back(depth);
  }
  if (depths.empty()) return points;

  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  for (std::optional<Eigen::Vector3d>& point : points) {
    if (point) *point /= *middle;
  }
  place_camera({reference.T_reference_newest.q, reference.T_reference_newest.p / *middle}, window.newest(),
               window);
  return points;
}

/// Locates a frame among points, starting from a neighbour that is located already.
bool locate(int frame, int neighbour, const Points& points, const Eigen::Quaterniond& q_neighbour_frame,
            double focal_px, Window& window) {
  std::vector<PointSighting> sightings;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (points[i] && landmark.seen_in(frame)) sightings.push_back({*points[i], landmark.in(frame).bearing});
  }
  const Pose T_w_cneighbour = window.T_w_c(neighbour);
  const Pose prediction{T_w_cneighbour.q * q_neighbour_frame, T_w_cneighbour.p};
  const std::optional<CameraPose> found =
      estimate_camera_pose(sightings, prediction, {.inlier_threshold = kLocateInlier_px / focal_px});
  if (found) place_camera(found->T_w_c, frame, window);
  return found.has_value();
}

/// What the frames `first` and later saw of a landmark that they saw.
Landmark since(int first, Landmark landmark) {
  if (landmark.host >= first) return landmark;
  landmark.observations.erase(landmark.observations.begin(),
                              landmark.observations.begin() + (first - landmark.host));
  landmark.host = first;
  return landmark;
}

/// Positions of all landmarks from the frames `first` and later, which are located.
Points triangulate_since(int first, double bearing_sigma, const Window& window) {
  Points points(window.landmarks.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (window.landmarks[i].dynamic || window.landmarks[i].last() <= first) continue;
    Landmark landmark = since(first, window.landmarks[i]);
    const double depth = triangulate_depth(window, landmark, bearing_sigma);
    if (depth <= 0.0) continue;
    landmark.inverse_depth = 1.0 / depth;
    points[i] = window.position(landmark);
  }
  return points;
}

/// Locates all frames but the two that the structure starts from.
bool locate_others(const Reference& reference, const Points& start, const Rotations& rotations,
                   double focal_px, double bearing_sigma, Window& window) {
  for (int frame = reference.frame + 1; frame < window.newest(); ++frame) {
    const Eigen::Quaterniond q = camera_rotation(window, rotations, frame - 1, frame);
    if (!locate(frame, frame - 1, start, q, focal_px, window)) return false;
  }
  for (int frame = reference.frame - 1; frame >= 0; --frame) {
    const Points points = triangulate_since(frame + 1, bearing_sigma, window);
    const Eigen::Quaterniond q = camera_rotation(window, rotations, frame + 1, frame);
    if (!locate(frame, frame + 1, points, q, focal_px, window)) return false;
  }
  return true;
}

/// Bundle adjustment. @return whether the tracks agree with its result
bool adjust(const BackendConfig& config, double focal_px, Window& window) {
  window.prior = first_prior(window, config.initializer);
  BackendConfig patient = config;
  patient.max_iterations = kAdjustIterations;
  const SolveReport report = solve_window(window, patient, focal_px);
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
  const Points start = start_structure(*reference, bearing_sigma, structure);
  if (!locate_others(*reference, start, *rotations, focal_px, bearing_sigma, structure)) return std::nullopt;
  for (Landmark& landmark : structure.landmarks) {
    const double depth = triangulate_depth(structure, landmark, bearing_sigma);
    landmark.inverse_depth = depth > 0.0 ? 1.0 / depth : 0.0;
    landmark.source = depth > 0.0 ? DepthSource::kTriangulated : DepthSource::kNone;
  }
  if (!adjust(config, focal_px, structure)) return std::nullopt;
  return structure;
}

}  // namespace stillpoint
