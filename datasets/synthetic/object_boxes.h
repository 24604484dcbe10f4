// SPDX-License-Identifier: BSD-3-Clause
/// Boxes around what is seen of each moving object in a rendered frame, and what a detector would make of
/// them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/detection.h"
#include "datasets/synthetic/actor.h"
#include "datasets/synthetic/frame_renderer.h"

namespace stillpoint {

/// A detector's faults. Misses come in bursts: a two-state Markov chain for each object (Gilbert 1960).
struct DetectorModel {
  double miss_share = 0.15;    ///< of the frames in which an object is seen
  double burst_frames = 4.0;   ///< mean length of a run of misses
  double jitter_share = 0.02;  ///< standard deviation of each edge, of the box's size
  double false_share = 0.02;   ///< of the frames, with a box around nothing
  int min_height_px = 24;      ///< smaller objects are not found
};

/// What is seen of one object.
struct SeenObject {
  int object = 0;
  int pixels = 0;
  Box box;  ///< edges of its pixels: the last column's right edge is its index + 0.5
};

/// All objects with at least one pixel, in order of their numbers.
[[nodiscard]] std::vector<SeenObject> seen_objects(const RenderedFrame& frame);

/// True boxes as detections of full score, named by the actors' classes.
[[nodiscard]] std::vector<Detection> true_detections(std::span<const SeenObject> seen,
                                                     std::span<const Actor> actors);

/// What a detector of people reports over a whole sequence.
/// @param frames what was seen in each frame
[[nodiscard]] std::vector<std::vector<Detection>> simulate_detector(
    std::span<const std::vector<SeenObject>> frames, const DetectorModel& model, int width, int height,
    std::uint64_t seed);

}  // namespace stillpoint
