// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/arrival_faults.h"

#include <algorithm>

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kAfterSuccessor_ns = 1000;

std::vector<FrameArrival> at_timestamps(std::span<const Timestamp> frame_times) {
  std::vector<FrameArrival> arrivals;
  for (std::size_t i = 0; i < frame_times.size(); ++i) arrivals.push_back({i, frame_times[i]});
  return arrivals;
}

}  // namespace

std::vector<FrameArrival> arrivals_with_fault(std::vector<FrameArrival> arrivals, const SensorFault& fault,
                                              std::span<const Timestamp> frame_times) {
  if (arrivals.empty()) arrivals = at_timestamps(frame_times);
  std::vector<FrameArrival> repeated;
  for (FrameArrival& arrival : arrivals) {
    if (!fault.is_active(seconds_between(frame_times.front(), frame_times[arrival.index]))) continue;
    if (fault.kind == FaultKind::kFrameLate) {
      arrival.t = after(arrival.t, fault.amount);
      continue;
    }
    const bool chosen = fault.random(arrival.index).chance(fault.amount);
    if (!chosen || arrival.index + 1 == frame_times.size()) continue;
    const Timestamp later{frame_times[arrival.index + 1].ns + kAfterSuccessor_ns};
    if (fault.kind == FaultKind::kFrameReordered) {
      arrival.t = std::max(arrival.t, later);
    } else {
      repeated.push_back({arrival.index, std::max(arrival.t, later)});
    }
  }
  arrivals.insert(arrivals.end(), repeated.begin(), repeated.end());
  std::ranges::stable_sort(arrivals, {}, &FrameArrival::t);
  return arrivals;
}

}  // namespace stillpoint::datasets
