// SPDX-License-Identifier: BSD-3-Clause
/// Buffer of inertial samples in temporal order; extracts intervals with interpolated ends.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/types/rig.h"

namespace stillpoint {

/// A step between successive samples that is longer than theirs are: samples are missing, or the clock
/// jumped.
struct ImuGap {
  bool is_long = false;      ///< more than `max_gap_s` and 2.5 T: the motion is not known
  bool may_be_jump = false;  ///< more than 10 ms and 4.5 T: interpolated, but doubtful
};

class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s = 0.05) : max_gap_s_(max_gap_s) {}

  /// Appends a sample; samples that are not finite or not later than the last one are counted and dropped.
  void add(const ImuSample& sample);
  /// Drops samples that are not needed for intervals from `t` on.
  void drop_before(Timestamp t);

  /// Samples from `begin` to `end`; the first and last one are interpolated at exactly these times. Empty if
  /// the buffer does not cover the interval. Valid until the next call.
  [[nodiscard]] const std::vector<ImuSample>& samples_between(Timestamp begin, Timestamp end);

  /// Like `samples_between`, but extrapolates the newest sample (zero-order hold) to `end` if the buffer ends
  /// at most `max_gap_s` before. For predictions only, not for factors.
  [[nodiscard]] const std::vector<ImuSample>& samples_up_to(Timestamp begin, Timestamp end);

  /// Of the longest step between successive samples that cover a part of an interval, with the mean period T
  /// of the buffer.
  [[nodiscard]] ImuGap gap_in(Timestamp begin, Timestamp end) const;

  /// Mean of the samples within `half_width_s` of `t`, or of the largest interval around `t` that the buffer
  /// covers; nullopt if it does not cover `t`.
  [[nodiscard]] std::optional<ImuSample> mean_around(Timestamp t, double half_width_s) const;

  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] Timestamp newest() const { return samples_.back().t; }
  [[nodiscard]] const ImuHealth& health() const { return health_; }

 private:
  void extract_interval(Timestamp begin, Timestamp end);
  void count_gaps(std::size_t first, std::size_t last);

  double max_gap_s_;
  std::vector<ImuSample> samples_;
  std::vector<ImuSample> interval_;  ///< last returned interval
  Timestamp gaps_counted_until_{std::numeric_limits<std::int64_t>::min()};
  ImuHealth health_;
};

}  // namespace stillpoint
