// SPDX-License-Identifier: BSD-3-Clause
/// Format-independent access to a recorded or rendered sequence: metadata at once, images on demand.
#pragma once

#include <cstddef>
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

}  // namespace stillpoint::datasets
