// SPDX-License-Identifier: BSD-3-Clause
/// Format-independent access to a recorded or rendered sequence: metadata at once, images on demand. A stream
/// can be played from a later time on, at a lower frame rate, or forwards and backwards alternately.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "core/types/frame.h"
#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

/// A sequence opened for reading. Images are not cached in memory.
class SensorStream {
 public:
  virtual ~SensorStream() = default;
  [[nodiscard]] virtual const SequenceInfo& info() const = 0;

  /// Decodes the images of one frame; thread-safe. The color image may be deferred, see `color_image`: then
  /// the frame must not outlive the stream.
  /// @param index position in `info().frame_times`
  /// @throws InputError with the file name if an image is missing, truncated, or its size differs from the
  /// calibrated size
  [[nodiscard]] virtual Frame load_frame(std::size_t index) const = 0;

  /// Whether `load_frame` takes a few milliseconds only, because all frames were decoded in an earlier run.
  [[nodiscard]] virtual bool frames_are_cached() const { return false; }

  /// Decodes the labels of one frame; empty if the sequence has none. Otherwise like `load_frame`.
  [[nodiscard]] virtual std::optional<MotionLabels> load_labels(std::size_t index) const = 0;
};

/// Plays a sequence from a later time on, as if the recording started there. Everything earlier than
/// `start_s` after the first frame is left out: frames, IMU samples, boxes and true poses. The stamps are
/// those of the sequence, frames are numbered from 0.
/// @param stream without injected faults
/// @param start_s >= 0 [s]; 0 or a stream without frames: the stream as it is
/// @throws InputError if no frame is left
[[nodiscard]] std::unique_ptr<SensorStream> start_at(std::unique_ptr<SensorStream> stream, double start_s);

/// Plays the first frame and every `step`-th after it, as a camera of a lower frame rate would record them.
/// The frames are numbered from 0. IMU samples, boxes and true poses stay.
/// @param stream without injected faults
/// @param step 1: the stream as it is
/// @throws InputError if step < 1
[[nodiscard]] std::unique_ptr<SensorStream> every_nth_frame(std::unique_ptr<SensorStream> stream, int step);

/// Plays the first `count` frames, as if the recording ended there: with the IMU samples until 0.1 s after
/// the last one, and the true poses and boxes until 0.02 s after it.
/// @param stream without injected faults
/// @param count 0, or at least the number of frames: the stream as it is
[[nodiscard]] std::unique_ptr<SensorStream> first_frames(std::unique_ptr<SensorStream> stream,
                                                         std::size_t count);

/// Plays a sequence forwards and backwards alternately: an arbitrarily long sequence with continuous motion.
/// Frames, boxes and ground-truth poses continue without a jump in pose or time; the frame at a turning point
/// occurs once. IMU samples are dropped: time-reversed accelerometer samples are not physically valid.
/// @param stream decoded on demand
/// @param passes >= 1; the first is forwards
/// @throws InputError if passes < 1, or the sequence has fewer than two frames
[[nodiscard]] std::unique_ptr<SensorStream> ping_pong_playback(std::unique_ptr<SensorStream> stream,
                                                               int passes);

}  // namespace stillpoint::datasets
