// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error between consecutive frames, independent of the alignment, and the frames where it is
/// largest.
///
///   e_k = |p((G_(k-1)^-1 G_k)^-1 (E_(k-1)^-1 E_k))|
///
/// G: ground truth; E: estimate; p(.): translation.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

class FrameToFrameError {
 public:
  /// To be called for every frame in order.
  /// @param pose estimate and ground truth of the frame; nullopt if either is missing
  /// @return e_k [m]; infinity at the first frame without a pose after one with a pose; NaN at other frames
  ///         where this frame or the previous one has no pose
  [[nodiscard]] double next(const std::optional<MatchedPose>& pose);

 private:
  std::optional<MatchedPose> previous_;
};

/// The `capacity` frames with the largest values.
class WorstFrames {
 public:
  explicit WorstFrames(std::size_t capacity) : capacity_(capacity) {}

  struct Insertion {
    bool inserted = false;
    std::optional<std::size_t> evicted;  ///< frame removed to stay within the capacity
  };

  /// Among equal values, frames inserted earlier rank higher. NaN is ignored.
  Insertion insert(std::size_t frame, double value);

  /// In order of decreasing value.
  [[nodiscard]] std::vector<std::size_t> frames() const;

 private:
  struct Entry {
    std::size_t frame = 0;
    double value = 0.0;
  };
  std::size_t capacity_;
  std::vector<Entry> entries_;  ///< in order of decreasing value
};

}  // namespace stillpoint::eval
