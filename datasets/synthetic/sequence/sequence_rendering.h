// SPDX-License-Identifier: BSD-3-Clause
/// Renders the frames of a sequence one by one into a folder, which keeps them, so that a later rendering
/// continues an earlier one.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/types/detection.h"
#include "datasets/io/file_descriptor.h"
#include "datasets/synthetic/sensors/sensor_models.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/sequence_writer.h"

namespace stillpoint::synth {

/// Receives the images of each frame that is rendered, from any thread.
using ImageCallback = std::function<void(std::size_t index, const cv::Mat& color, const cv::Mat& depth)>;

/// The boxes of one frame, as they are read from the files of the complete sequence.
struct FrameBoxes {
  DetectionSet truth;
  DetectionSet detections;  ///< of the simulated detector; without boxes in a static scene
};

/// A sequence folder that is being rendered.
///
/// At first the folder has all files but images and boxes. Each rendered frame adds its images, and then a
/// row to `rendering.txt`, the log by which another object continues: the frame's time and visible objects.
/// With the last frame the files of boxes are written, `detections.txt` last, and the log is removed. Images
/// and boxes of a frame do not depend on which frames are rendered, nor on their order, so that several
/// processes may render into the same folder: they write the same bits. One object per folder and process.
///
/// Thread-safe.
class SequenceRendering {
 public:
  /// Continues the rendering in `folder`, or begins one.
  /// @param request accepted by `check_request`
  /// @throws InputError if the scene of the request cannot be built, or a file cannot be read or written
  SequenceRendering(const SynthRequest& request, std::filesystem::path folder);
  ~SequenceRendering();
  SequenceRendering(const SequenceRendering&) = delete;
  SequenceRendering& operator=(const SequenceRendering&) = delete;

  [[nodiscard]] std::size_t frame_count() const { return frames_.size(); }
  [[nodiscard]] bool is_rendered(std::size_t index) const;

  /// Renders a frame, unless that was done or another thread does it.
  void render(std::size_t index, const ImageCallback& on_images = {});

  /// Returns when all frames up to `index` are rendered; renders those that no other thread does.
  void render_until(std::size_t index);

  /// Boxes of a frame. All frames up to `index` must be rendered: the errors of the detector form a sequence.
  [[nodiscard]] FrameBoxes boxes(std::size_t index);

 private:
  enum class State { kMissing, kInProgress, kRendered };
  struct FrameRecord {
    State state = State::kMissing;
    Timestamp t;
    std::vector<VisibleObject> visible;
  };
  class Scenery;

  [[nodiscard]] bool continue_log();
  void begin();
  void open_log();
  [[nodiscard]] Scenery& scenery();
  void render_claimed(std::size_t index, const ImageCallback& on_images);
  void add_boxes_until(std::size_t index);
  void write_boxes();

  SynthRequest request_;
  std::filesystem::path folder_;
  SequenceWriter writer_;
  std::once_flag scenery_once_;
  std::unique_ptr<Scenery> scenery_;  ///< built for the first frame that is rendered
  ObjectClasses classes_;             ///< of all moving objects
  std::optional<datasets::FileDescriptor> log_;

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  std::vector<FrameRecord> frames_;
  std::size_t rendered_ = 0;
  SimulatedPersonDetector detector_;
  std::vector<DetectionSet> truth_, detections_;  ///< of the first frames
};

}  // namespace stillpoint::synth
