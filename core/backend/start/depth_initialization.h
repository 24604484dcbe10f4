// SPDX-License-Identifier: BSD-3-Clause
/// Initial landmark depth: from measured depths that are consistent with other views, else by triangulation.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Initializes the inverse depth of every static landmark that has none and at least two observations.
///
/// Each measured depth Z is transformed to the host and accepted if its reprojection error r in at least one
/// other view is small; the landmark is initialized at the mean of the accepted depths. Without any, it is
/// triangulated if the parallax suffices, else left uninitialized. Small is below `agreement_px` or, with
/// `agreement_probability` p, within the quantile of the chi-square distribution with two degrees of freedom,
///
///   r^T S^-1 r <= -2 ln(1 - p),    S = 2 s^2 I + sigma_Z^2 J J^T,
///
/// with s = `feature_sigma_px`, the standard deviation sigma_Z of the depth (`inverse_sigma`), and J = dr/dZ.
void initialize_depths(const BackendConfig& config, double focal_px, Window& window);

/// Depth z in the host by linear triangulation over all observations [m]. With a = R_cj_chost m (m the
/// bearing in the host, z = 1), t = p_cj_chost and u the bearing in j, the projection u = (z a + t)_xy / (z a
/// + t)_z is linear in z: z s_j + o_j = 0 with s_j = a_xy - u a_z, o_j = t_xy - u t_z, so
///
///   z = -sum_j s_j . o_j / sum_j |s_j|^2,    sigma(z) / z = bearing_sigma / sqrt(sum_j |s_j|^2).
///
/// @param bearing_sigma standard deviation of a bearing [normalized image plane]
/// @return 0 if sigma(z) > z / 3 or z is negative
[[nodiscard]] double triangulate_depth(const Window& window, const Landmark& landmark, double bearing_sigma);

}  // namespace stillpoint
