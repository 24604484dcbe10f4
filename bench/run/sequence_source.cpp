// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include <algorithm>

#include "bench/config/spelling.h"
#include "core/base/error.h"
#include "datasets/cache/frame_cache.h"
#include "datasets/read_sequence.h"

namespace stillpoint::bench {

std::filesystem::path rendered_sequence(const synth::SynthRequest& request, synth::RenderControl control,
                                        const std::optional<datasets::FrameCacheOptions>& frame_cache) {
  if (!frame_cache) return synth::cached_sequence(request, control);
  datasets::FrameCacheFill fill(*frame_cache, request.preset + "_" + std::to_string(request.seed));
  control.on_images = [&fill](std::size_t index, const cv::Mat& color, const cv::Mat& depth) {
    fill.add(index, color, depth);
  };
  std::filesystem::path folder = synth::cached_sequence(request, control);
  if (!folder.empty() && fill.has_frames()) {
    FaultLog strict;
    fill.finish(datasets::read_sequence(folder, {}, strict));
  }
  return folder;
}

std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                      const datasets::OpenOptions& options,
                                                      const synth::RenderControl& control) {
  if (datasets::is_sequence_path(name)) return datasets::open_sequence(name, options);
  const std::vector<std::string> presets = synth::preset_names();
  if (std::find(presets.begin(), presets.end(), name) == presets.end()) {
    throw InputError("sequence \"" + name + "\"",
                     "is neither a folder nor a preset" + suggestion(name, presets));
  }
  const std::filesystem::path folder =
      rendered_sequence(synth::preset_request(name), control, options.frame_cache);
  return folder.empty() ? nullptr : datasets::open_sequence(folder, options);
}

}  // namespace stillpoint::bench
