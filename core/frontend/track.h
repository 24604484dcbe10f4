// SPDX-License-Identifier: BSD-3-Clause
/// State of one feature track between two frames.
#pragma once

#include "core/frontend/patch/track_template.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// A feature in the image where its track began, see drift_correction.h.
struct FirstView {
  TrackTemplate patch;
  double depth = 0.0;                                         ///< [m]; 0 = not measured
  Eigen::Matrix3d R_now_first = Eigen::Matrix3d::Identity();  ///< rotation of the camera since
};

struct Track {
  TrackedFeature feature;    ///< observation in the last frame
  double known_depth = 0.0;  ///< last measured depth [m]; 0 = never measured
  /// Observation at the last detection. Outlier rejection compares with it instead of with the last frame, so
  /// that frames without detection leave no interval unchecked; the baseline is longer, too.
  Eigen::Vector2d reference_bearing = Eigen::Vector2d::Zero();
  double reference_depth = 0.0;  ///< depth at the last detection [m]; 0 = not measured
  FirstView first_view;
};

}  // namespace stillpoint
