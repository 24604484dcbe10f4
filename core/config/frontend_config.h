// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the tracker and the feature detectors. Paper Sec. III-A, III-B; defaults are those of the
/// published Dynamic-VINS code, except for checks that it lacks; its config disables them.
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

enum class OutlierModel { kEpipolar, kRigid };
constexpr auto enum_names(OutlierModel) {
  return EnumNames<OutlierModel, 2>{{{OutlierModel::kEpipolar, "epipolar"}, {OutlierModel::kRigid, "rigid"}}};
}

/// Settings of the grid detector. Paper Sec. III-B; 7x8 from Sec. IV-C, the rest as in the published code.
struct GridDetectorConfig {
  int rows = 7;
  int cols = 8;
  int padding_px = 3;        ///< border added to each cell; FAST needs 3
  int fast_threshold = 10;   ///< intensity difference [grey levels]
  bool skip_empty = true;    ///< skip a cell without corners at the next detection
  bool stop_early = false;   ///< search the cells with the fewest features first; stop when enough are found
  int extra_candidates = 2;  ///< candidates kept per cell beyond its quota
  int threads = 1;           ///< size of the thread pool; does not affect the result
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, GridDetectorConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("rows", config.rows, 1, 64);
  field("cols", config.cols, 1, 64);
  field("padding_px", config.padding_px, 3, 32);
  field("fast_threshold", config.fast_threshold, 1, 255);
  field("skip_empty", config.skip_empty);
  field("stop_early", config.stop_early);
  field("extra_candidates", config.extra_candidates, 0, 64);
  field("threads", config.threads, 1, 64);
}

struct FrontendConfig {
  int max_features = 130;
  int min_distance_px = 30;     ///< radius of the circles around stable features
  int unstable_radius_px = 30;  ///< radius of the circles around unstable (lost) features; 0 = none
  bool circular_mask = true;    ///< both circles. Paper Sec. III-A
  FeatureDetectorKind detector = FeatureDetectorKind::kGridFast;
  TrackerPrediction prediction = TrackerPrediction::kRotation;
  TrackerKind tracker = TrackerKind::kOpenCv;
  int window_px = 21;                  ///< opencv: side of the KLT window
  int pyramid_levels = 2;              ///< with predicted motion; includes the full resolution
  int unpredicted_pyramid_levels = 4;  ///< without prediction: disabled, VO, or a gap in the IMU data
  int max_iterations = 30;             ///< per level
  double min_correlation = 0.8;        ///< patch: zero-mean normalized cross-correlation with the match
  bool forward_backward = false;       ///< forward-backward check
  double forward_backward_px = 0.5;
  OutlierModel outlier_model =
      OutlierModel::kEpipolar;       ///< motion model of RANSAC; rigid uses the measured depths
  double ransac_threshold_px = 1.0;  ///< residual of an inlier, px at the camera's focal length
  double ransac_confidence = 0.99;
  double ransac_min_inlier_ratio = 0.5;  ///< models with fewer inliers are discarded: nothing is rejected; 0
                                         ///< = as published
  bool reject_static_only = false;  ///< exclude features labeled dynamic from RANSAC and never reject them,
                                    ///< so that a large dynamic object cannot become the consensus; not in
                                    ///< the paper
  double drift_min_correlation = 0.0;  ///< align matches with the first image of their track, where the
                                       ///< correlation is at least this; 0 = off; not in the paper
  bool recover_view = false;  ///< continue the tracks of a lost view when it returns; not in the paper
  int border_px = 1;
  double depth_max_spread =
      0.05;               ///< range of the depths in the 3x3 neighborhood over the depth; 0 = no check
  bool equalize = false;  ///< CLAHE(3, 8x8) before tracking
  double shi_tomasi_quality = 0.01;
  GridDetectorConfig grid;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, FrontendConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("max_features", config.max_features, 8, 2000);
  field("min_distance_px", config.min_distance_px, 1, 200);
  field("unstable_radius_px", config.unstable_radius_px, 0, 200);
  field("circular_mask", config.circular_mask);
  field("detector", config.detector);
  field("prediction", config.prediction);
  field("tracker", config.tracker);
  field("window_px", config.window_px, 5, 63);
  field("pyramid_levels", config.pyramid_levels, 1, 8);
  field("unpredicted_pyramid_levels", config.unpredicted_pyramid_levels, 1, 8);
  field("max_iterations", config.max_iterations, 1, 100);
  field("min_correlation", config.min_correlation, -1.0, 1.0);
  field("forward_backward", config.forward_backward);
  field("forward_backward_px", config.forward_backward_px, 0.01, 10.0);
  field("outlier_model", config.outlier_model);
  field("ransac_threshold_px", config.ransac_threshold_px, 0.1, 20.0);
  field("ransac_confidence", config.ransac_confidence, 0.5, 0.99999);
  field("ransac_min_inlier_ratio", config.ransac_min_inlier_ratio, 0.0, 1.0);
  field("reject_static_only", config.reject_static_only);
  field("drift_min_correlation", config.drift_min_correlation, 0.0, 1.0);
  field("recover_view", config.recover_view);
  field("border_px", config.border_px, 0, 100);
  field("depth_max_spread", config.depth_max_spread, 0.0, 10.0);
  field("equalize", config.equalize);
  field("shi_tomasi_quality", config.shi_tomasi_quality, 1e-4, 0.5);
  field("grid", config.grid);
}

}  // namespace stillpoint
