// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/error_growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillpoint {

double ErrorGrowth::next(const std::optional<MatchedPose>& pose) {
  const std::optional<MatchedPose> before = std::exchange(before_, pose);
  if (!before) return std::numeric_limits<double>::quiet_NaN();
  if (!pose) return std::numeric_limits<double>::infinity();
  const Pose T_before_now_true = before->gt.inverse() * pose->gt;
  const Pose T_before_now = before->est.inverse() * pose->est;
  return (T_before_now_true.inverse() * T_before_now).p.norm();
}

WorstFrames::Answer WorstFrames::offer(std::size_t frame, double value) {
  if (std::isnan(value)) return {};
  const auto place =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.value < value; });
  if (place == entries_.end() && entries_.size() >= room_) return {};
  entries_.insert(place, {frame, value});
  if (entries_.size() <= room_) return {.is_taken = true, .dropped = std::nullopt};
  const Answer answer{.is_taken = true, .dropped = entries_.back().frame};
  entries_.pop_back();
  return answer;
}

std::vector<std::size_t> WorstFrames::frames() const {
  std::vector<std::size_t> frames;
  for (const Entry& entry : entries_) frames.push_back(entry.frame);
  return frames;
}

}  // namespace stillpoint
