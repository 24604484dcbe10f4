// SPDX-License-Identifier: BSD-3-Clause
/// Format-independent access to a recorded or rendered sequence: metadata at once, images on demand.
#pragma once

#include <cstddef>
#include <optional>

#include "core/types/frame.h"
#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

/// A sequence opened for reading. Implementations do not cache images.
class SensorStream {
 public:
  virtual ~SensorStream() = default;
  [[nodiscard]] virtual const SequenceInfo& info() const = 0;

  /// Decodes the images of one frame; thread-safe.
  /// @param index position in `info().frame_times`
  /// @throws InputError with the file name if an image is missing, truncated, or its size differs from the
  /// calibrated size
  [[nodiscard]] virtual Frame load_frame(std::size_t index) const = 0;

  /// Decodes the labels of one frame; empty if the sequence has none. Otherwise like `load_frame`.
  [[nodiscard]] virtual std::optional<MotionLabels> load_labels(std::size_t index) const = 0;
};

}  // namespace stillpoint::datasets
