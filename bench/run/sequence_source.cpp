// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "bench/config/spelling.h"
#include "core/base/error.h"
#include "datasets/cache/frame_cache.h"
#include "datasets/read_sequence.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Renders all frames into `folder`, and those of an uninterrupted rendering into the frame cache, too.
/// @return false if stopped by `control`
bool render_all(synth::SequenceRendering& rendering, const fs::path& folder, synth::RenderControl control,
                const std::optional<datasets::FrameCacheOptions>& frame_cache) {
  const std::size_t count = rendering.frame_count();
  if (!frame_cache) return synth::render_frames(rendering, count, control);
  datasets::FrameCacheFill fill(*frame_cache, folder.filename().string());
  control.on_images = [&fill](std::size_t index, const cv::Mat& color, const cv::Mat& depth) {
    fill.add(index, color, depth);
  };
  if (!synth::render_frames(rendering, count, control)) return false;
  if (fill.frames() == 0) return true;
  FaultLog strict;
  const datasets::SequenceContent content = datasets::read_sequence(folder, {}, strict);
  // Otherwise an earlier rendering was continued, and the first run decodes the images.
  if (fill.frames() == content.frame_files.size()) fill.finish(content);
  return true;
}

/// A sequence of the cache that is not complete: `load_frame` renders what is missing.
class RenderedStream final : public datasets::SensorStream {
 public:
  RenderedStream(const synth::SynthRequest& request, const fs::path& folder,
                 const datasets::OpenOptions& options)
      : rendering_(request, folder),
        stream_(datasets::open_sequence(folder, options)),
        info_(stream_->info()),
        has_boxes_(info_.frame_times.size()) {
    STILLPOINT_CHECK(rendering_.frame_count() == info_.frame_times.size());
    std::vector<DetectionSet> sets;
    for (const Timestamp t : info_.frame_times)
      sets.push_back({.t = t, .state = DetectionState::kNone, .detections = {}});
    info_.detections = sets;
    info_.true_boxes = std::move(sets);
  }

  /// Renders the first `count` frames. @return false if stopped
  [[nodiscard]] bool render(std::size_t count, const synth::RenderControl& control) {
    if (!synth::render_frames(rendering_, count, control)) return false;
    for (std::size_t i = 0; i < count; ++i) set_boxes(i);
    return true;
  }

  /// Renders all frames into `folder`, as `render_all`.
  [[nodiscard]] bool complete(const fs::path& folder, const synth::RenderControl& control,
                              const std::optional<datasets::FrameCacheOptions>& frame_cache) {
    return render_all(rendering_, folder, control, frame_cache);
  }

  [[nodiscard]] const datasets::SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    try {
      rendering_.render_until(index);
    } catch (const InputError& error) {
      throw RenderingError(error.what());
    }
    set_boxes(index);
    return stream_->load_frame(index);
  }
  [[nodiscard]] bool frames_are_cached() const override { return stream_->frames_are_cached(); }
  [[nodiscard]] std::optional<datasets::MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(index);
  }

 private:
  /// Sets the boxes of a frame when it is loaded for the first time. The times of the sets are not changed,
  /// so that the sets of earlier frames can be searched meanwhile.
  void set_boxes(std::size_t index) const {
    const std::scoped_lock lock(mutex_);
    if (has_boxes_[index]) return;
    synth::FrameBoxes boxes = rendering_.boxes(index);
    const auto set = [](DetectionSet& to, DetectionSet& from) {
      to.state = from.state;
      to.detections = std::move(from.detections);
    };
    set(info_.detections[index], boxes.detections);
    set(info_.true_boxes[index], boxes.truth);
    has_boxes_[index] = true;
  }

  mutable synth::SequenceRendering rendering_;
  std::unique_ptr<datasets::SensorStream> stream_;
  mutable std::mutex mutex_;
  mutable datasets::SequenceInfo info_;
  mutable std::vector<bool> has_boxes_;
};

}  // namespace

fs::path rendered_sequence(const synth::SynthRequest& request, synth::RenderControl control,
                           const std::optional<datasets::FrameCacheOptions>& frame_cache) {
  fs::path folder = synth::sequence_cache_folder(request);
  if (synth::is_complete_sequence(folder)) return folder;
  synth::SequenceRendering rendering(request, folder);
  return render_all(rendering, folder, std::move(control), frame_cache) ? folder : fs::path();
}

std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                      const datasets::OpenOptions& options,
                                                      const synth::RenderControl& control,
                                                      const PresetPart& part) {
  if (datasets::is_sequence_path(name)) return datasets::open_sequence(name, options);
  const std::vector<std::string> presets = synth::preset_names();
  if (std::find(presets.begin(), presets.end(), name) == presets.end()) {
    throw InputError("sequence \"" + name + "\"",
                     "is neither a folder nor a preset" + suggestion(name, presets));
  }
  const synth::SynthRequest request = synth::preset_request(name);
  const fs::path folder = synth::sequence_cache_folder(request);
  datasets::OpenOptions identified = options;
  identified.id = synth::sequence_id(request);
  if (!synth::is_complete_sequence(folder)) {
    if (part.when_loaded || part.frames) {
      auto stream = std::make_unique<RenderedStream>(request, folder, identified);
      const std::vector<Timestamp>& times = stream->info().frame_times;
      const std::size_t count = part.when_loaded ? 0 : part.frames(times);
      if (count < times.size()) return stream->render(count, control) ? std::move(stream) : nullptr;
      // All frames: also into the frame cache, so that a run in real time decodes nothing.
      if (!stream->complete(folder, control, options.frame_cache)) return nullptr;
    } else if (rendered_sequence(request, control, options.frame_cache).empty()) {
      return nullptr;
    }
  }
  return datasets::open_sequence(folder, identified);
}

}  // namespace stillpoint::bench
