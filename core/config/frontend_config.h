// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the tracker and the feature detectors. Paper Sec. III-A, III-B. The defaults are those of the
/// program, see odometry_config.h. The field lists explain the keys.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

enum class TrackerPrediction { kNone, kRotation, kFull };
constexpr auto enum_names(TrackerPrediction) {
  return EnumNames<TrackerPrediction, 3>{{{TrackerPrediction::kNone, "none"},
                                          {TrackerPrediction::kRotation, "rotation"},
                                          {TrackerPrediction::kFull, "full"}}};
}

enum class FeatureDetectorKind { kGridFast, kShiTomasi };
constexpr auto enum_names(FeatureDetectorKind) {
  return EnumNames<FeatureDetectorKind, 2>{
      {{FeatureDetectorKind::kGridFast, "grid_fast"}, {FeatureDetectorKind::kShiTomasi, "shi_tomasi"}}};
}

enum class TrackerKind { kOpenCv, kPatch };
constexpr auto enum_names(TrackerKind) {
  return EnumNames<TrackerKind, 2>{{{TrackerKind::kOpenCv, "opencv"}, {TrackerKind::kPatch, "patch"}}};
}

enum class OutlierModel { kEpipolar, kRigid, kMajority };
constexpr auto enum_names(OutlierModel) {
  return EnumNames<OutlierModel, 3>{{{OutlierModel::kEpipolar, "epipolar"},
                                     {OutlierModel::kRigid, "rigid"},
                                     {OutlierModel::kMajority, "majority"}}};
}

/// Settings of the grid detector. Paper Sec. III-B; 7x8 from Sec. IV-C, the rest as in the published code.
struct GridDetectorConfig {
  int rows = 7;
  int cols = 8;
  int fast_threshold = 10;
  bool stop_early = true;  ///< the same corners, except in cells that are no longer searched
  int threads = 1;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, GridDetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("rows", config.rows, FieldInfo{"Rows of the grid.", "", 1, 64, "III-B; value: IV-C"});
  field("cols", config.cols, FieldInfo{"Columns of the grid.", "", 1, 64, "III-B; value: IV-C"});
  field("fast_threshold", config.fast_threshold,
        FieldInfo{"Difference of intensity that makes a FAST corner.", "grey levels", 1, 255, "III-B"});
  field(
      "stop_early", config.stop_early,
      FieldInfo{.text = "Whether cells are searched by ascending number of features until enough corners are "
                        "found, instead of all; not in the paper."});
  field("threads", config.threads,
        FieldInfo{"Size of the thread pool; does not affect the result.", "", 1, 64, "III-B"});
}

struct FrontendConfig {
  int max_features = 130;
  int min_distance_px = 20;
  int unstable_radius_px = 20;
  bool circular_mask = true;
  FeatureDetectorKind detector = FeatureDetectorKind::kGridFast;
  TrackerPrediction prediction = TrackerPrediction::kFull;
  TrackerKind tracker = TrackerKind::kPatch;  ///< as accurate as KLT windows, in a tenth of the time
  int window_px = 15;                         ///< faster than the published 21, without loss of tracks
  int pyramid_levels = 2;
  /// Without that prediction: disabled, visual odometry, a gap in the IMU data, or before the inertial start.
  /// Not a key: maxLevel = 3 of VINS.
  int unpredicted_pyramid_levels = 4;
  double min_correlation = 0.6;  ///< low: outliers are rejected by the motion model
  OutlierModel outlier_model = OutlierModel::kRigid;
  double ransac_threshold_px = 2.0;      ///< accuracy of the depth-to-color registration of real sensors
  double ransac_min_inlier_ratio = 0.5;  ///< a model with fewer inliers is not that of the static scene
  bool reject_static_only = true;        ///< else a person who fills the image determines the dominant motion
  double drift_min_correlation = 0.9;    ///< else errors of tracking from frame to frame accumulate
  bool recover_view = true;  ///< after large motions, blank images or a jump, tracks continue where they were
  double depth_max_spread = 0.05;  ///< depths at the edge of an object belong to either side
  GridDetectorConfig grid;
};
/// Keys of tracked and detected features. Paper Sec. III-A, III-B.
template <class Visitor, class Config>
void visit_feature_fields(Visitor&& field, Config& config) {
  field("max_features", config.max_features,
        FieldInfo{"Number of tracked features; missing ones are detected.", "features", 8, 2000,
                  "III-B; value: IV-C"});
  field("min_distance_px", config.min_distance_px,
        FieldInfo{"Radius of the circles around stable features, in which none is detected.", "px", 1, 200,
                  "III-A"});
  field("unstable_radius_px", config.unstable_radius_px,
        FieldInfo{"Radius of the circles around unstable (lost) features; 0 = none.", "px", 0, 200, "III-A"});
  field("circular_mask", config.circular_mask,
        FieldInfo{.text = "Whether both kinds of circles are masked for the detection.", .paper = "III-A"});
  field(
      "detector", config.detector,
      FieldInfo{
          .text = "FAST corners in the cells of a grid, or Shi-Tomasi corners of the whole image (VINS-Mono, "
                  "VINS-RGBD).",
          .paper = "III-B"});
  field("prediction", config.prediction,
        FieldInfo{.text = "What predicts the position of a feature: nothing, the rotation, or rotation and "
                          "translation of the IMU.",
                  .paper = "III-A"});
  field("tracker", config.tracker,
        FieldInfo{.text = "KLT of OpenCV, or 8x8 patches that are accepted by their correlation.",
                  .paper = "III-A"});
  field("window_px", config.window_px,
        FieldInfo{"Tracker opencv: side of the KLT window.", "px", 5, 63, "III-A"});
  field("pyramid_levels", config.pyramid_levels,
        FieldInfo{"Levels of the pyramid with a predicted motion, with the full resolution; 4 without one.",
                  "", 1, 8, "III-A"});
  field(
      "min_correlation", config.min_correlation,
      FieldInfo{"Tracker patch: smallest zero-mean normalized cross-correlation of a match.", "", -1.0, 1.0});
}

/// Keys of the matches: outliers, drift, depth.
template <class Visitor, class Config>
void visit_match_fields(Visitor&& field, Config& config) {
  field("outlier_model", config.outlier_model,
        FieldInfo{
            .text = "Motion of the static features: epipolar geometry, the rigid motion of measured depths "
                    "that explains most matches, or that with the least median of errors (not in the paper).",
            .paper = "III-A"});
  field(
      "ransac_threshold_px", config.ransac_threshold_px,
      FieldInfo{
          "Largest residual of a feature that follows the motion of `outlier_model`; px at the focal length.",
          "px", 0.1, 20.0});
  field("ransac_min_inlier_ratio", config.ransac_min_inlier_ratio,
        FieldInfo{"With a smaller fraction of inliers nothing is rejected; 0 = as published.", "", 0.0, 1.0});
  field("reject_static_only", config.reject_static_only,
        FieldInfo{
            .text = "Whether features labeled dynamic take no part in the motion of `outlier_model` and are "
                    "never rejected, so that a large dynamic object cannot determine it; not in the paper."});
  field(
      "drift_min_correlation", config.drift_min_correlation,
      FieldInfo{
          "Matches are aligned with the first image of their track, where the correlation is at least this; "
          "0 = off; not in the paper.",
          "", 0.0, 1.0});
  field("recover_view", config.recover_view,
        FieldInfo{
            .text =
                "Whether matched descriptors predict large motions between frames, and the tracks of a lost "
                "view continue when it returns; not in the paper."});
  field("depth_max_spread", config.depth_max_spread,
        FieldInfo{
            "Largest range of the depths in the 3x3 neighborhood of a feature, relative to its depth; 0 = no "
            "check, as published.",
            "", 0.0, 10.0});
  field("grid", config.grid);
}

template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, FrontendConfig>
void visit_fields(Visitor&& field, Config& config) {
  visit_feature_fields(field, config);
  visit_match_fields(field, config);
}

}  // namespace stillpoint
