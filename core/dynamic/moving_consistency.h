// SPDX-License-Identifier: BSD-3-Clause
/// How far each feature's positions disagree with a world that stands still. Paper Sec. III-E, Eq. (6).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose.h"

namespace stillpoint {

/// One feature in one picture of the window.
struct ConsistencyObservation {
  int frame = 0;                                      ///< position in ConsistencyView::T_w_c
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< normalised plane
  double depth = 0.0;                                 ///< [m]; 0 = not measured
};

struct ConsistencyFeature {
  std::int64_t id = 0;
  double inverse_depth = 0.0;  ///< estimated, in the frame of the first observation [1/m]; 0 = unknown
  std::size_t first = 0;       ///< of its observations, in ConsistencyView::observations
  std::size_t count = 0;       ///< of them, > 0
};

/// What the check needs of the window. Features of any verdict take part.
struct ConsistencyView {
  std::vector<Pose> T_w_c;  ///< of each picture, oldest first
  double focal_px = 0.0;    ///< of the camera, > 0: residuals are in its pixels
  std::vector<ConsistencyFeature> features;
  std::vector<ConsistencyObservation> observations;  ///< feature by feature, each by rising frame

  [[nodiscard]] std::span<const ConsistencyObservation> seen_of(const ConsistencyFeature& feature) const {
    return std::span(observations).subspan(feature.first, feature.count);
  }
};

struct ConsistencyResidual {
  std::int64_t id = 0;
  double mean_px = 0.0;  ///< r_k
  int compared = 0;      ///< pairs of pictures in the mean: m
};

/// Eq. (6): the mean, over the later observations j, of the distance between the first observation and where
/// the feature as seen in j should have been in the first picture.
///
/// The place in j is its measured depth along its bearing; where none was measured, the depth that the
/// estimate implies there; where neither is known, the pair is left out. A point that comes out behind the
/// camera counts with `focal_px`, the error of half a right angle.
/// @param memory for the result: a list that nobody needs any more
/// @return one entry for each feature with at least one pair, in the order of the features
[[nodiscard]] std::vector<ConsistencyResidual> consistency_residuals(
    const ConsistencyView& view, std::vector<ConsistencyResidual> memory = {});

/// The same for the newest picture alone, whose pose is a prediction: the mean, over the earlier observations
/// j, of the distance between the newest observation and where the feature as seen in j should be now.
/// Features that the newest picture does not see have no entry.
[[nodiscard]] std::vector<ConsistencyResidual> gate_on_prediction(
    const ConsistencyView& view, std::vector<ConsistencyResidual> memory = {});

}  // namespace stillpoint
