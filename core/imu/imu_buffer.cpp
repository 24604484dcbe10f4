// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/imu_buffer.h"

#include <algorithm>

namespace stillpoint {
namespace {

bool earlier(const ImuSample& sample, Timestamp t) { return sample.t < t; }

/// Sample at `t` on the straight line from `before` to `behind`; before.t <= t <= behind.t, before.t <
/// behind.t.
ImuSample interpolate_at(const ImuSample& before, const ImuSample& behind, Timestamp t) {
  const double share = seconds_between(before.t, t) / seconds_between(before.t, behind.t);
  return {.t = t,
          .gyro_b = (1.0 - share) * before.gyro_b + share * behind.gyro_b,
          .accel_b = (1.0 - share) * before.accel_b + share * behind.accel_b};
}

ImuSample held_at(const ImuSample& sample, Timestamp t) {
  return {.t = t, .gyro_b = sample.gyro_b, .accel_b = sample.accel_b};
}

}  // namespace

void ImuBuffer::add(const ImuSample& sample) {
  const bool finite = sample.gyro_b.allFinite() && sample.accel_b.allFinite();
  const bool later = samples_.empty() || sample.t > samples_.back().t;
  if (finite && later) {
    samples_.push_back(sample);
  } else {
    ++health_.rejected_samples;
  }
}

void ImuBuffer::forget_before(Timestamp t) {
  std::size_t spent = 0;
  while (spent + 1 < samples_.size() && samples_[spent + 1].t <= t) ++spent;
  samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(spent));
}

const std::vector<ImuSample>& ImuBuffer::samples_between(Timestamp begin, Timestamp end) {
  cut_.clear();
  cut_between(begin, end);
  return cut_;
}

void ImuBuffer::cut_between(Timestamp begin, Timestamp end) {
  if (samples_.empty() || begin >= end) return;
  if (samples_.front().t > begin || samples_.back().t < end) return;

  const auto position = [this](Timestamp t) {  // of the first sample at or after t
    const auto found = std::lower_bound(samples_.begin(), samples_.end(), t, earlier);
    return static_cast<std::size_t>(found - samples_.begin());
  };
  const std::size_t at_begin = position(begin);
  const std::size_t at_end = position(end);
  const bool exact_begin = samples_[at_begin].t == begin;
  count_gaps(exact_begin ? at_begin : at_begin - 1, at_end);

  if (!exact_begin) cut_.push_back(interpolate_at(samples_[at_begin - 1], samples_[at_begin], begin));
  for (std::size_t i = at_begin; i < at_end; ++i) cut_.push_back(samples_[i]);
  const bool exact_end = samples_[at_end].t == end;
  cut_.push_back(exact_end ? samples_[at_end] : interpolate_at(samples_[at_end - 1], samples_[at_end], end));
}

const std::vector<ImuSample>& ImuBuffer::samples_up_to(Timestamp begin, Timestamp end) {
  cut_.clear();
  if (samples_.empty() || begin >= end || samples_.front().t > begin) return cut_;
  const ImuSample last = samples_.back();
  if (last.t >= end) {
    cut_between(begin, end);
  } else if (seconds_between(last.t, end) <= max_gap_s_) {
    cut_between(begin, last.t);
    if (cut_.empty()) cut_.push_back(held_at(last, begin));
    cut_.push_back(held_at(last, end));
  }
  return cut_;
}

/// Counts the holes between samples_[first] and samples_[last] that no cut has counted before.
void ImuBuffer::count_gaps(std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const bool hole = seconds_between(samples_[i].t, samples_[i + 1].t) > max_gap_s_;
    if (!hole || samples_[i].t < gaps_counted_until_) continue;
    ++health_.gaps;
    gaps_counted_until_ = samples_[i + 1].t;
  }
}

}  // namespace stillpoint
