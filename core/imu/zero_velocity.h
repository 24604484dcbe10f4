// SPDX-License-Identifier: BSD-3-Clause
/// Test of inertial samples for a sensor at rest. Skog, Haendel, Nilsson and Rantakokko, "Zero-velocity
/// detection - an algorithm evaluation", IEEE TBME 57(11), 2010, Sec. II: stance hypothesis optimal detector.
#pragma once

#include <span>

#include "core/types/nav_state.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Logarithm of the generalized likelihood ratio of "moving" against "at rest", up to a factor:
///
///   T = 1/N sum_k ( |a_k - g u|^2 / s_a^2 + |w_k|^2 / s_w^2 ),    u = a~ / |a~|,  a~ = 1/N sum_k a_k
///
/// a_k, w_k: specific force and angular rate less the biases of `state`; g: norm of gravity; s_a, s_w:
/// standard deviations of one sample, the noise densities over the square root of the mean interval. T is
/// about 6 at rest, less if the densities of `noise` are larger than the noise, and does not distinguish rest
/// from constant velocity.
/// @param samples of a short interval, in temporal order
/// @param state   its biases
/// @param noise   densities of white noise
/// @param gravity norm [m/s^2]
/// @return infinity for fewer than two samples, or without noise densities
[[nodiscard]] double zero_velocity_statistic(std::span<const ImuSample> samples, const NavState& state,
                                             const ImuNoise& noise, double gravity);

}  // namespace stillpoint
