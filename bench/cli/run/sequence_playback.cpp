// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/sequence_playback.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "bench/cli/console.h"
#include "bench/record/sequence_checksum.h"
#include "bench/run/frame_cache.h"
#include "bench/run/sequence_source.h"
#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/gray_noise.h"
#include "datasets/faults/rig_faults.h"

namespace stillpoint::bench {

std::unique_ptr<datasets::SensorStream> open_with_progress(const std::string& name,
                                                           const datasets::OpenOptions& options,
                                                           const PresetPart& part) {
  std::unique_ptr<ProgressLine> progress;
  const auto on_rendered = [&](int done, int total) {
    if (!progress) {
      progress =
          std::make_unique<ProgressLine>("rendering " + name, static_cast<std::size_t>(total), "frames");
    }
    progress->update(static_cast<std::size_t>(done));
  };
  return find_sequence(name, options, {.progress = on_rendered, .stop_requested = interrupt_requested}, part);
}

namespace {

/// Index of the first frame that is not earlier than `seconds` after the frame `first`.
std::size_t frame_at(std::span<const Timestamp> times, std::size_t first, double seconds) {
  const auto found = std::ranges::lower_bound(times, after(times[first], seconds));
  return static_cast<std::size_t>(found - times.begin());
}

}  // namespace

std::size_t frames_to_load(std::span<const Timestamp> frame_times, const Playback& playback) {
  if (frame_times.empty() || playback.passes > 1 || !playback.faults.empty()) return frame_times.size();
  const std::size_t first = frame_at(frame_times, 0, playback.start_s);
  if (first == frame_times.size()) return 0;  // `start_at` reports it
  std::size_t end = frame_times.size();
  if (playback.frames > 0)
    end = std::min(end, first + (playback.frames - 1) * static_cast<std::size_t>(playback.every) + 1);
  if (playback.seconds > 0.0) end = std::min(end, frame_at(frame_times, first, playback.seconds));
  return end;
}

std::size_t frames_to_play(std::span<const Timestamp> frame_times, const Playback& playback) {
  std::size_t frames = frame_times.size();
  if (playback.frames > 0) frames = std::min(frames, playback.frames);
  if (playback.seconds > 0.0 && frames > 0)
    frames = std::min(frames, frame_at(frame_times, 0, playback.seconds));
  return frames;
}

std::unique_ptr<datasets::SensorStream> played(std::unique_ptr<datasets::SensorStream> stream,
                                               const Playback& playback) {
  stream = datasets::start_at(std::move(stream), playback.start_s);
  stream = datasets::every_nth_frame(std::move(stream), playback.every);
  if (playback.passes > 1) stream = datasets::ping_pong_playback(std::move(stream), playback.passes);
  stream = datasets::with_gray_noise(std::move(stream), playback.gray_noise);
  return datasets::with_faults(std::move(stream), playback.faults);
}

std::string sequence_identity(const datasets::SequenceInfo& info, const std::string& rig_file) {
  std::string id = info.id.empty() ? remembered_checksum(info.folder, checksum_folder()) : info.id;
  if (!rig_file.empty()) id.append(kRigSuffix).append(sequence_checksum(rig_file));
  return id;
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
