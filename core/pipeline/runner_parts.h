// SPDX-License-Identifier: BSD-3-Clause
/// What the runners have in common: feeding inertial samples, loading pictures, closing a picture.
#pragma once

#include <optional>
#include <span>

#include "core/pipeline/runner.h"

namespace stillpoint {

/// Samples up to this long after an exposure are handed over before it: the cut at the exposure is
/// interpolated, and the time offset may grow.
constexpr double kImuLead_s = 0.02;

/// Pictures that wait for the tracker when they come by the clock; when more come, the oldest is dropped.
constexpr std::size_t kWaitingPictures = 2;

/// Share of the picture interval in which the optimisation waits for boxes, when pictures come by the clock.
constexpr double kDetectionWait = 0.3;

/// Between successive pictures; 0 for fewer than two.
[[nodiscard]] double median_interval_s(std::span<const Timestamp> times);

/// Hands a stage the samples that a picture needs.
class ImuFeed {
 public:
  explicit ImuFeed(std::span<const ImuSample> samples) : samples_(samples) {}

  template <class Stage>
  void up_to(Timestamp end, Stage& stage) {
    for (; next_ < samples_.size() && samples_[next_].t <= end; ++next_) stage.add_imu(samples_[next_]);
  }

 private:
  std::span<const ImuSample> samples_;
  std::size_t next_ = 0;
};

/// What the optimisation gives back to the tracker: what it says, and a frame for its memory.
struct Returned {
  Feedback said;
  TrackedFrame spent;
};

/// A picture on its way through the stages.
struct PictureOnWay {
  Frame frame;
  bool full = false;  ///< enters the window
  Feedback told;      ///< to the tracker, before; goes back for its memory
  TrackedFrame tracked;
  ModuleSpan decoding;
};

/// What was found in a picture, and how long that took.
struct DetectionOnWay {
  DetectionSet set;
  std::optional<ModuleSpan> search;  ///< absent where none ended in time
};

/// The picture, or nothing and the reason in `skipped`.
[[nodiscard]] std::optional<PictureOnWay> load_picture(const SensorInput& input, std::size_t index,
                                                       std::vector<SkippedFrame>& skipped);

[[nodiscard]] DetectionOnWay detect_objects(ObjectDetector& detector, const Frame& frame);

/// The last steps of a picture: optimisation, and the callbacks.
/// @param detections nothing where the picture does not enter the window
void close_picture(const PictureOnWay& picture, const std::optional<DetectionOnWay>& detections,
                   OptimizationStage& optimization, const RunControl& control, RunSummary& summary);

/// Writes what the stages know at the end into the summary.
/// @throws InputError if not one picture could be read
void close_run(const Stages& stages, RunSummary& summary);

}  // namespace stillpoint
