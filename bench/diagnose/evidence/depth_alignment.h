// SPDX-License-Identifier: BSD-3-Clause
/// Whether depth images belong to their gray images: recorded at the same time, and seen from the same place.
///
/// Surfaces end where gray values change. With the gradient g_i of the gray image i, clamped to 30 levels,
/// and the pixels D_j of depth image j where the depth changes by more than 5 % to a farther neighbor:
///   score(i, delay, shift) = mean of g_i(p - shift) over p in D_(i + delay) / mean of g_i.
/// Depth belongs to its image if the mean of the score over i is largest at delay 0 and shift 0. The
/// significance of another maximum is that of the differences to the score at 0, paired by image.
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// The delay and the shift with the largest mean score: the depth for pixel p of frame i is that of pixel
/// p + shift of frame i + delay.
struct DepthAlignment {
  int delay = 0;  ///< [frames]
  double delay_sigmas = 0.0;
  double delay_gain = 0.0;  ///< of the score to that without, relative
  Eigen::Vector2i shift_px = Eigen::Vector2i::Zero();
  double shift_sigmas = 0.0;
  double shift_gain = 0.0;
  int images = 0;  ///< with edges in gray and depth
};

/// @param stop_requested polled before each image; on true the rest is left out
/// @return nullopt with fewer than 10 images with edges in gray and depth
[[nodiscard]] std::optional<DepthAlignment> align_depth(const datasets::SensorStream& stream,
                                                        const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
