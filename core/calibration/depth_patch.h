// SPDX-License-Identifier: BSD-3-Clause
/// The surface around a pixel of a depth image.
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "core/calibration/calibration_factors.h"

namespace stillpoint {

/// Least-squares fit of an affine inverse depth, that is, of a plane, to the 9x9 pixels around `pixel`.
/// @param depth CV_16UC1; 0 = not measured
/// @return nullopt where less than 60 of the pixels are measured, or they are no plane: an edge
[[nodiscard]] std::optional<DepthFactor::Measurement> depth_patch(const cv::Mat& depth, double units_per_m,
                                                                  const Eigen::Vector2d& pixel);

}  // namespace stillpoint
