// SPDX-License-Identifier: BSD-3-Clause
/// Where a run goes wrong: by how much its error grows from picture to picture, and where it grows most.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "eval/trajectory/association.h"

namespace stillpoint {

/// Told of every picture in turn.
class ErrorGrowth {
 public:
  /// @param pose of the picture beside the true one; nothing where either is missing
  /// @return length [m] of the error of the motion since the picture before, whatever the alignment;
  ///         infinite at the first picture after the pose was lost; NaN where there is nothing to say
  [[nodiscard]] double next(const std::optional<MatchedPose>& pose);

 private:
  std::optional<MatchedPose> before_;
};

/// The frames of the largest values, and no more of them than it has room for.
class WorstFrames {
 public:
  explicit WorstFrames(std::size_t room) : room_(room) {}

  struct Answer {
    bool is_taken = false;
    std::optional<std::size_t> dropped;  ///< frame that made room
  };

  /// Of equal values the earlier frame is worse. NaN is never taken.
  Answer offer(std::size_t frame, double value);

  /// Worst first.
  [[nodiscard]] std::vector<std::size_t> frames() const;

 private:
  struct Entry {
    std::size_t frame = 0;
    double value = 0.0;
  };
  std::size_t room_;
  std::vector<Entry> entries_;  ///< worst first
};

}  // namespace stillpoint
