// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/imu_buffer.h"

#include <algorithm>

namespace stillpoint {
namespace {

// Of `gap_in`. A clock that jumped by 0.02 s misled estimates by up to 0.11 m (room3, an IMU of 200 Hz). No
// interval in the recordings of EuRoC and TUM-VI is longer than 1.1 periods.
constexpr double kMissingPeriods = 2.5;
constexpr double kJumpPeriods = 4.5;
constexpr double kMinJump_s = 0.01;

bool earlier(const ImuSample& sample, Timestamp t) { return sample.t < t; }

/// Linear interpolation at `t`; requires before.t <= t <= behind.t and before.t < behind.t.
ImuSample interpolate_at(const ImuSample& before, const ImuSample& behind, Timestamp t) {
  const double fraction = seconds_between(before.t, t) / seconds_between(before.t, behind.t);
  return {.t = t,
          .gyro_b = (1.0 - fraction) * before.gyro_b + fraction * behind.gyro_b,
          .accel_b = (1.0 - fraction) * before.accel_b + fraction * behind.accel_b};
}

ImuSample zero_order_hold(const ImuSample& sample, Timestamp t) {
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

void ImuBuffer::drop_before(Timestamp t) {
  std::size_t expired = 0;
  while (expired + 1 < samples_.size() && samples_[expired + 1].t <= t) ++expired;
  samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(expired));
}

const std::vector<ImuSample>& ImuBuffer::samples_between(Timestamp begin, Timestamp end) {
  interval_.clear();
  extract_interval(begin, end);
  return interval_;
}

void ImuBuffer::extract_interval(Timestamp begin, Timestamp end) {
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

  if (!exact_begin) interval_.push_back(interpolate_at(samples_[at_begin - 1], samples_[at_begin], begin));
  for (std::size_t i = at_begin; i < at_end; ++i) interval_.push_back(samples_[i]);
  const bool exact_end = samples_[at_end].t == end;
  interval_.push_back(exact_end ? samples_[at_end]
                                : interpolate_at(samples_[at_end - 1], samples_[at_end], end));
}

const std::vector<ImuSample>& ImuBuffer::samples_up_to(Timestamp begin, Timestamp end) {
  interval_.clear();
  if (samples_.empty() || begin >= end || samples_.front().t > begin) return interval_;
  const ImuSample last = samples_.back();
  if (last.t >= end) {
    extract_interval(begin, end);
  } else if (seconds_between(last.t, end) <= max_gap_s_) {
    extract_interval(begin, last.t);
    if (interval_.empty()) interval_.push_back(zero_order_hold(last, begin));
    interval_.push_back(zero_order_hold(last, end));
  }
  return interval_;
}

ImuGap ImuBuffer::gap_in(Timestamp begin, Timestamp end) const {
  if (samples_.size() < 2) return {};
  const double period_s =
      seconds_between(samples_.front().t, samples_.back().t) / static_cast<double>(samples_.size() - 1);
  double step_s = 0.0;
  auto next = std::upper_bound(samples_.begin() + 1, samples_.end(), begin,
                               [](Timestamp t, const ImuSample& sample) { return t < sample.t; });
  for (; next != samples_.end() && std::prev(next)->t < end; ++next)
    step_s = std::max(step_s, seconds_between(std::prev(next)->t, next->t));
  return {.is_long = step_s > std::max(max_gap_s_, kMissingPeriods * period_s),
          .may_be_jump = step_s > std::max(kMinJump_s, kJumpPeriods * period_s)};
}

std::optional<ImuSample> ImuBuffer::mean_around(Timestamp t, double half_width_s) const {
  if (samples_.empty() || samples_.front().t > t || samples_.back().t < t) return std::nullopt;
  const double covered =
      std::min(seconds_between(samples_.front().t, t), seconds_between(t, samples_.back().t));
  const double half_width = std::min(half_width_s, covered);
  const auto begin = std::lower_bound(samples_.begin(), samples_.end(), after(t, -half_width), earlier);
  ImuSample sum{.t = t, .gyro_b = Eigen::Vector3d::Zero(), .accel_b = Eigen::Vector3d::Zero()};
  int count = 0;
  for (auto sample = begin; sample != samples_.end() && sample->t <= after(t, half_width); ++sample) {
    sum.gyro_b += sample->gyro_b;
    sum.accel_b += sample->accel_b;
    ++count;
  }
  if (count == 0) {
    const auto next = std::lower_bound(samples_.begin(), samples_.end(), t, earlier);
    return next->t == t ? *next : interpolate_at(*std::prev(next), *next, t);
  }
  sum.gyro_b /= count;
  sum.accel_b /= count;
  return sum;
}

/// Counts the gaps between samples_[first] and samples_[last] that were not counted before.
void ImuBuffer::count_gaps(std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const bool is_gap = seconds_between(samples_[i].t, samples_[i + 1].t) > max_gap_s_;
    if (!is_gap || samples_[i].t < gaps_counted_until_) continue;
    ++health_.gaps;
    gaps_counted_until_ = samples_[i + 1].t;
  }
}

}  // namespace stillpoint
