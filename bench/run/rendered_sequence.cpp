// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/rendered_sequence.h"

#include "datasets/cache/frame_cache_fill.h"
#include "datasets/read_sequence.h"
#include "datasets/synthetic/sequence/sequence_cache.h"

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

}  // namespace stillpoint::bench
