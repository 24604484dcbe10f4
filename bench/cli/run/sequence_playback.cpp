// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/sequence_playback.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "bench/cli/console.h"
#include "bench/run/frame_cache.h"
#include "bench/run/sequence_source.h"
#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/gray_noise.h"
#include "datasets/faults/rig_faults.h"

namespace stillpoint::bench {

std::unique_ptr<datasets::SensorStream> open_with_progress(const std::string& name,
                                                           const datasets::OpenOptions& options) {
  std::unique_ptr<ProgressLine> progress;
  const auto on_rendered = [&](int done, int total) {
    if (!progress) {
      progress =
          std::make_unique<ProgressLine>("rendering " + name, static_cast<std::size_t>(total), "frames");
    }
    progress->update(static_cast<std::size_t>(done));
  };
  return find_sequence(name, options, {.progress = on_rendered, .stop_requested = interrupt_requested});
}

std::unique_ptr<datasets::SensorStream> played(std::unique_ptr<datasets::SensorStream> stream,
                                               const Playback& playback) {
  stream = datasets::start_at(std::move(stream), playback.start_s);
  stream = datasets::every_nth_frame(std::move(stream), playback.every);
  if (playback.passes > 1) stream = datasets::ping_pong_playback(std::move(stream), playback.passes);
  stream = datasets::with_gray_noise(std::move(stream), playback.gray_noise);
  return datasets::with_faults(std::move(stream), playback.faults);
}

std::optional<datasets::FrameCacheOptions> logged_frame_cache(bool enabled, int max_frames) {
  if (!enabled) return std::nullopt;
  return frame_cache_options(static_cast<std::size_t>(max_frames),
                             [](const std::string& text) { spdlog::warn("{}", text); });
}

std::vector<datasets::SensorFault> parsed_faults(const std::vector<std::string>& texts) {
  std::vector<datasets::SensorFault> faults;
  faults.reserve(texts.size());
  for (const std::string& text : texts) faults.push_back(datasets::parse_fault(text));
  return datasets::expanded_rigs(faults);
}

}  // namespace stillpoint::bench
