// SPDX-License-Identifier: BSD-3-Clause
/// Bounding boxes of moving objects in a rendered frame, and a simulated person detector.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/detection.h"
#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/render/frame_renderer.h"

namespace stillpoint::synth {

/// Detector errors. Misses occur in bursts: a two-state Markov chain per object (Gilbert 1960).
struct DetectorModel {
  double miss_rate = 0.15;            ///< fraction of missed frames among those in which an object is visible
  double burst_frames = 4.0;          ///< mean length of a run of misses [frames]
  double jitter_ratio = 0.02;         ///< standard deviation of each edge / box size
  double false_positive_rate = 0.02;  ///< fraction of frames with a false positive
  int min_height_px = 24;             ///< smaller objects are not detected
};

/// The visible part of one object.
struct VisibleObject {
  int object = 0;
  int pixels = 0;
  Box box;  ///< outer pixel edges: pixel i covers [i - 0.5, i + 0.5]
};

/// All objects with at least one pixel, ordered by instance number.
[[nodiscard]] std::vector<VisibleObject> visible_objects(const RenderedFrame& frame);

/// True boxes as detections of score 1 with the actors' class names.
[[nodiscard]] std::vector<Detection> true_detections(std::span<const VisibleObject> visible,
                                                     std::span<const Actor> actors);

/// Output of a simulated person detector over a whole sequence.
/// @param frames visible objects of each frame
[[nodiscard]] std::vector<std::vector<Detection>> simulate_detector(
    std::span<const std::vector<VisibleObject>> frames, const DetectorModel& model, const cv::Size& image,
    std::uint64_t seed);

}  // namespace stillpoint::synth
