// SPDX-License-Identifier: BSD-3-Clause
/// Consistency of features with the assumption that they are static: reprojection residuals, Paper Sec.
/// III-E, Eq. (6), and the readmission of dynamic features that have been static for a number of frames.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/covariance.h"

namespace stillpoint {

/// Observation of a feature in one frame of the window.
struct ConsistencyObservation {
  int frame = 0;                                      ///< index into ConsistencyView::T_w_c
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< on the normalized image plane
  double depth = 0.0;                                 ///< [m]; 0 = not measured
};

struct ConsistencyFeature {
  std::int64_t id = 0;
  double inverse_depth = 0.0;  ///< estimate in the frame of the first observation [1/m]; 0 = unknown
  std::size_t first = 0;       ///< index of its first observation in ConsistencyView::observations
  std::size_t count = 0;       ///< number of its observations, > 0
};

/// Input of the check: the poses of the window, and features of any label.
struct ConsistencyView {
  std::vector<Pose> T_w_c;  ///< camera pose of each frame, oldest first
  double focal_px = 0.0;    ///< focal length [px], > 0; scales the residuals
  std::vector<ConsistencyFeature> features;
  std::vector<ConsistencyObservation> observations;  ///< sorted by feature, then frame

  [[nodiscard]] std::span<const ConsistencyObservation> observations_of(
      const ConsistencyFeature& feature) const {
    return std::span(observations).subspan(feature.first, feature.count);
  }
};

struct ConsistencyResidual {
  std::int64_t id = 0;
  double mean_px = 0.0;                      ///< r_k
  int pair_count = 0;                        ///< m: number of frame pairs (i, j) in the mean
  std::optional<double> squared_distance{};  ///< Mahalanobis distance of the mean, see `gate_on_prediction`
};

/// Average reprojection residual of each feature k over the window. Eq. (6):
///
///   r_k = 1/m * sum_{j != i} || u_k^{c_i} - pi(T_b^c T_w^{b_i} T_{b_j}^w T_c^b P_k^{c_j}) ||
///
///   i          frame of the first observation of feature k in the window
///   j          the m other frames that observe feature k
///   u_k^{c_i}  observation of the feature in frame i, on the normalized image plane
///   P_k^{c_j}  3-D position of the feature in camera frame j: its depth times its bearing, see below
///   T_c^b      extrinsics, camera to body (T_b_c in the code); T_b^c is its inverse
///   T_{b_j}^w  pose of body frame j in the world (T_w_b); T_w^{b_i} is the inverse of that of frame i
///   pi         camera projection
///
/// With camera poses T_w_c = T_w_b T_b_c the chain is T_w_ci^-1 T_w_cj. The residual is evaluated on the
/// normalized plane and multiplied by the focal length: r_k is in px. A feature with r_k over a threshold is
/// dynamic.
///
/// The depth in P_k^{c_j} is the measured depth in frame j; if invalid, the depth in frame j implied by the
/// estimated inverse depth; if both are unknown, the pair (i, j) is omitted and m decreases. A point behind
/// camera i contributes `focal_px` (45 degrees).
/// @param recycled a result that is no longer needed; its memory is reused
/// @return one entry for each feature with m > 0, in the order of the features
[[nodiscard]] std::vector<ConsistencyResidual> consistency_residuals(
    const ConsistencyView& view, std::vector<ConsistencyResidual> recycled = {});

/// A predicted camera pose, and the error of the features that are compared with it.
struct PredictionError {
  UncertainPose camera;  ///< T_w_c of the newest frame, with its covariance P relative to the earlier ones
  double bearing_sigma = 0.0;  ///< s: of a feature position on the normalized image plane
};

/// Eq. (6) with the newest frame, whose pose is a prediction, in place of frame i; j are the earlier frames.
/// Features that are not observed in the newest frame have no entry.
///
/// With the error of the prediction, also the squared Mahalanobis distance of the mean vector r of the m
/// differences, which for a static feature has the chi-square distribution with two degrees of freedom. With
/// the Jacobian J of the projection of its mean position by the camera pose,
///
///   d^2 = r^T S^-1 r,    S = J P J^T + s^2 (1 + 1/m) I.
///
/// @param error    of the pose of the newest frame
/// @param recycled as above
[[nodiscard]] std::vector<ConsistencyResidual> gate_on_prediction(
    const ConsistencyView& view, const std::optional<PredictionError>& error = std::nullopt,
    std::vector<ConsistencyResidual> recycled = {});

/// Readmission of dynamic features that are static. Extends Paper Sec. III-E: a track that drifted from a
/// person onto the background is static from then on, although its older observations are not.
///
/// Stores an anchor point for each feature, and counts the frames in which the feature was observed there.
///
/// An anchor p_w = T_w_c (d * m) is set from an observation with valid depth d and bearing m. A later frame
/// counts as static if focal_px * || pi(T_w_c^-1 p_w) - m || <= static_residual_px, which needs no depth in
/// that frame; otherwise the anchor is set anew. An anchor with a depth from the wrong side of an edge
/// therefore delays the readmission by a few frames only.
class StaticReadmission {
 public:
  /// @param min_static_frames  consecutive static frames before a feature is readmitted, >= 1
  /// @param static_residual_px largest reprojection error of a static feature, px of the focal length, > 0
  StaticReadmission(int min_static_frames, double static_residual_px)
      : min_static_frames_(min_static_frames), static_residual_px_(static_residual_px) {}

  /// Processes the newest frame; removes features that are not observed in it.
  /// @return ids of the readmitted features, ascending; valid until the next call
  const std::vector<std::int64_t>& update(const ConsistencyView& view);

  void reset() { anchors_.clear(); }

 private:
  struct Anchor {
    std::int64_t id = 0;
    Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
    int static_frames = 0;  ///< consecutive, after the frame that set the anchor
  };

  int min_static_frames_;
  double static_residual_px_;
  std::vector<Anchor> anchors_;   ///< by ascending id
  std::vector<Anchor> previous_;  ///< those of the previous frame
  std::vector<std::int64_t> readmitted_;
};

}  // namespace stillpoint
