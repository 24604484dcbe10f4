// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence by folder, or by the name of a preset, which is rendered on demand into the sequence
/// cache and the frame cache.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "core/base/timestamp.h"
#include "datasets/cache/frame_cache_options.h"
#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// `synth::cached_sequence`; if the sequence is rendered now, its frames are written to the frame cache, too.
/// @param control without `on_images`
/// @return an empty path if stopped by `control`
/// @throws InputError as `synth::cached_sequence`
[[nodiscard]] std::filesystem::path rendered_sequence(
    const synth::SynthRequest& request, synth::RenderControl control,
    const std::optional<datasets::FrameCacheOptions>& frame_cache);

/// A frame that is rendered when it is loaded could not be, as on a full disk. An `InputError` would be taken
/// for a damaged frame, which a run skips.
class RenderingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Which frames of a preset are rendered, and when.
struct PresetPart {
  /// Number of frames, from the first one on, that will be loaded; empty: all.
  std::function<std::size_t(std::span<const Timestamp> frame_times)> frames = {};
  /// Render each frame when it is loaded. Its boxes are in `SensorStream::info` from then on; until then its
  /// sets have the state `kNone`. Only for frames that are loaded in order, from a stream of which no part is
  /// copied. Otherwise the part is rendered before the stream is returned.
  bool when_loaded = false;
};

/// Opens a folder, or a preset with its default settings; frames of a preset that are not in the cache are
/// rendered, and kept there.
/// @param name    path of a sequence folder, or a preset, e.g. "walking_xyz"
/// @param control of the rendering before the stream is returned, if that is necessary
/// @param part    of a preset
/// @return null if the rendering was stopped
/// @throws InputError if the name is neither, and errors of opening and rendering; `load_frame` of the stream
/// throws RenderingError if it renders
[[nodiscard]] std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                                    const datasets::OpenOptions& options,
                                                                    const synth::RenderControl& control,
                                                                    const PresetPart& part = {});

}  // namespace stillpoint::bench
