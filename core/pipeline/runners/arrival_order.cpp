// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/arrival_order.h"

#include "core/base/error.h"

namespace stillpoint {
namespace {

void require_order_of_arrivals(const SensorInput& input) {
  const FrameArrival* before = nullptr;
  for (const FrameArrival& arrival : input.arrivals) {
    const bool exists = arrival.index < input.frame_times.size();
    if ((exists && arrival.t < input.frame_times[arrival.index]) ||
        (before != nullptr && arrival.t < before->t)) {
      throw InputError("arrival of frame " + std::to_string(arrival.index),
                       "must not precede its timestamp or the previous arrival");
    }
    before = &arrival;
  }
}

}  // namespace

ArrivalOrder::ArrivalOrder(const SensorInput& input) {
  require_order_of_arrivals(input);
  if (input.arrivals.empty()) {
    for (std::size_t i = 0; i < input.frame_times.size(); ++i) entering_.push_back({i, input.frame_times[i]});
    return;
  }
  std::vector<bool> enters(input.frame_times.size(), false);
  for (const FrameArrival& arrival : input.arrivals) {
    if (arrival.index >= enters.size()) continue;
    if (!entering_.empty() && arrival.index <= entering_.back().index) continue;
    entering_.push_back(arrival);
    enters[arrival.index] = true;
  }
  for (std::size_t i = 0; i < enters.size(); ++i) {
    if (!enters[i]) skipped_.push_back({i, "arrived after a later frame, or not at all"});
  }
}

}  // namespace stillpoint
