// SPDX-License-Identifier: BSD-3-Clause
/// Normalized innovation squared (NIS): consistency of a prediction and a measurement with their covariances,
/// without ground truth. Bar-Shalom et al., "Estimation with Applications to Tracking and Navigation", 2001,
/// Sec. 5.4. With an innovation v of n dimensions and its covariance S, v^T S^-1 v / n is 1 in the mean.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/window/window.h"
#include "core/geometry/covariance.h"

namespace stillpoint {

/// Of the static landmarks that are observed in the newest frame and whose depth was estimated before, at the
/// predicted camera pose. With P of that pose, and the standard deviation s of a residual, the difference of
/// the bearings u in this and in the host frame (see `BackendConfig::pixel_sigma_px`),
///
///   v = u - pi(T_w_c^-1 p_w),    S = J P J^T + s^2 I,    see `projection_covariance`.
///
/// Landmarks that move unrecognized hardly change it: it is the median of v^T S^-1 v over the landmarks,
/// divided by that of the chi-square distribution with two degrees of freedom.
/// @param residual_sigma s [normalized image plane]
/// @param distances buffer, whose content is ignored: v^T S^-1 v of each landmark
/// @return nothing if there are fewer than eight landmarks
[[nodiscard]] std::optional<double> reprojection_nis(const Window& window, const UncertainPose& camera,
                                                     double residual_sigma, std::vector<double>& distances);

/// Of a pose by vision alone, at the pose predicted by inertial data: the squared distance by the sum of both
/// covariances, divided by 6.
[[nodiscard]] double inertial_nis(const UncertainPose& predicted, const UncertainPose& visual);

}  // namespace stillpoint
