// SPDX-License-Identifier: BSD-3-Clause
/// Renders a whole sequence with multiple threads, and keeps rendered sequences in a cache on disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/sequence_rendering.h"

namespace stillpoint::synth {

/// Progress reporting, cancellation and thread count of a rendering; every member is optional.
struct RenderControl {
  std::function<void(int done, int total)> progress = {};  ///< called after each frame, serialized
  std::function<bool()> stop_requested = {};               ///< called before each frame, from any thread
  ImageCallback on_images = {};
  int threads = 0;  ///< 0 = hardware concurrency; does not affect the result
};

/// Renders the missing ones of the first `count` frames.
/// @return false if stopped by `control`
bool render_frames(SequenceRendering& rendering, std::size_t count, const RenderControl& control);

/// Writes the sequence into `folder`, which is created atomically when the sequence is complete. Besides the
/// files of the layout:
///   request.toml    the request
///   true_boxes.txt  bounding boxes of the visible pixels of each moving object; only timestamps in a static
///                   scene
///   detections.txt  output of a simulated person detector; likewise
///   labels/         on request: one 8-bit instance mask per frame; 0 = static, 1..127 = a person, 128.. = a
///                   moving object of a class that the detector does not report
///   motion/         with the labels: world-frame speed of the visible surface [cm/s], 8 bits, saturated
/// @return false if stopped by `control`; no files remain in that case
/// @throws InputError if the request is out of range, `folder` exists already, or a file cannot be written
bool render_sequence(const SynthRequest& request, const std::filesystem::path& folder,
                     const RenderControl& control = {});

/// Folder of a sequence in the cache; it may be missing or incomplete.
/// @throws InputError if the request is out of range or there is no folder for the cache
[[nodiscard]] std::filesystem::path sequence_cache_folder(const SynthRequest& request);

/// Whether a folder of the cache has all frames.
[[nodiscard]] bool is_complete_sequence(const std::filesystem::path& folder);

/// Folder of the sequence; frames that are not in the cache are rendered first. Safe to call from several
/// processes.
/// @return an empty path if stopped by `control`; the cache keeps the frames that were rendered
/// @throws InputError as `SequenceRendering` and `sequence_cache_folder`
[[nodiscard]] std::filesystem::path cached_sequence(const SynthRequest& request,
                                                    const RenderControl& control = {});

}  // namespace stillpoint::synth
