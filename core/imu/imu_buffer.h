// SPDX-License-Identifier: BSD-3-Clause
/// Inertial samples in order of time, and cuts out of them whose ends are interpolated.
#pragma once

#include <limits>
#include <vector>

#include "core/types/imu_sample.h"

namespace stillpoint {

/// What adding and cutting met that is not as it should be; reported with the run, never hidden.
struct ImuHealth {
  int rejected_samples = 0;  ///< not finite, out of order or repeated
  int gaps = 0;              ///< holes longer than `max_gap_s` met while cutting; each counts once
};

class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s = 0.05) : max_gap_s_(max_gap_s) {}

  /// Appends a sample; one that is not finite or not later than the last is counted and dropped.
  void add(const ImuSample& sample);
  /// Forgets samples that no cut from `t` on needs.
  void forget_before(Timestamp t);

  /// Samples from `begin` to `end`, both ends interpolated so that the first is at begin and the last at end.
  /// Empty if the buffer does not reach over both ends. Valid until the next cut.
  [[nodiscard]] const std::vector<ImuSample>& samples_between(Timestamp begin, Timestamp end);

  /// Like `samples_between`, but the newest sample is held up to `end` when the buffer ends at most
  /// `max_gap_s` before. Ends found this way are a guess: use them for predictions, not for factors.
  [[nodiscard]] const std::vector<ImuSample>& samples_up_to(Timestamp begin, Timestamp end);

  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] Timestamp newest() const { return samples_.back().t; }
  [[nodiscard]] const ImuHealth& health() const { return health_; }

 private:
  void cut_between(Timestamp begin, Timestamp end);
  void count_gaps(std::size_t first, std::size_t last);

  double max_gap_s_;
  std::vector<ImuSample> samples_;
  std::vector<ImuSample> cut_;  ///< handed out last
  Timestamp gaps_counted_until_{std::numeric_limits<std::int64_t>::min()};
  ImuHealth health_;
};

}  // namespace stillpoint
