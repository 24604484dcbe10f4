// SPDX-License-Identifier: BSD-3-Clause
/// Renders a whole sequence into a folder, on all cores.
#pragma once

#include <filesystem>
#include <functional>

#include "datasets/synthetic/presets.h"

namespace stillpoint {

/// How a long rendering talks with its caller; every member may be left out.
struct RenderControl {
  std::function<void(int done, int total)> progress =
      {};                                     ///< after each frame, never from two threads at once
  std::function<bool()> stop_requested = {};  ///< asked before each frame, from any of the threads
  int threads = 0;                            ///< 0 = as many as the machine has; the result is the same
};

/// Writes the sequence into `folder`, which appears only when it is complete. Besides the files of the
/// layout:
///   request.toml    what was asked for
///   true_boxes.txt  boxes around what is seen of each person, cart and chair that moves (if there are any)
///   detections.txt  what a simulated detector of people found (likewise)
///   labels/         on request: one 8-bit picture per frame; 0 = stands still, 1..127 = a person, 128.. = a
///                   mover that no detector knows
///   motion/         with the labels: how fast what is seen moves in the world [cm/s], 8 bits, cut at 255
/// @return false if it was stopped: then nothing is left behind
/// @throws InputError if the request is out of range, `folder` exists already, or anything cannot be written
bool render_sequence(const SynthRequest& request, const std::filesystem::path& folder,
                     const RenderControl& control = {});

}  // namespace stillpoint
