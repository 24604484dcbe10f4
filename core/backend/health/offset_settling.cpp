// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/offset_settling.h"

#include <algorithm>

namespace stillpoint {
namespace {

constexpr double kSettlingInterval_s = 0.5;
constexpr double kSettledChange_s = 0.0015;
constexpr double kMaxSettling_s = 3.0;

}  // namespace

bool OffsetSettling::update(Timestamp t, double offset_s) {
  if (settled_) return true;
  if (!first_) first_ = t;
  while (estimates_.size() > 1 && seconds_between(estimates_[1].t, t) >= kSettlingInterval_s) {
    estimates_.erase(estimates_.begin());
  }
  estimates_.push_back({t, offset_s});
  if (seconds_between(estimates_.front().t, t) < kSettlingInterval_s) return false;
  const auto [least, greatest] = std::ranges::minmax(estimates_, {}, &Estimate::offset_s);
  settled_ =
      greatest.offset_s - least.offset_s < kSettledChange_s || seconds_between(*first_, t) >= kMaxSettling_s;
  return settled_;
}

void OffsetSettling::reset() {
  estimates_.clear();
  first_.reset();
  settled_ = false;
}

}  // namespace stillpoint
