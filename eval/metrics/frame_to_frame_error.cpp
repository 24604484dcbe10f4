// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/frame_to_frame_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillpoint::eval {

double FrameToFrameError::next(const std::optional<MatchedPose>& pose) {
  const std::optional<MatchedPose> previous = std::exchange(previous_, pose);
  if (!previous) return std::numeric_limits<double>::quiet_NaN();
  if (!pose) return std::numeric_limits<double>::infinity();
  const Pose gt_motion = previous->gt.inverse() * pose->gt;
  const Pose est_motion = previous->est.inverse() * pose->est;
  return (gt_motion.inverse() * est_motion).p.norm();
}

WorstFrames::Insertion WorstFrames::insert(std::size_t frame, double value) {
  if (std::isnan(value)) return {};
  const auto position =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.value < value; });
  if (position == entries_.end() && entries_.size() >= capacity_) return {};
  entries_.insert(position, {frame, value});
  if (entries_.size() <= capacity_) return {.inserted = true, .evicted = std::nullopt};
  const Insertion insertion{.inserted = true, .evicted = entries_.back().frame};
  entries_.pop_back();
  return insertion;
}

std::vector<std::size_t> WorstFrames::frames() const {
  std::vector<std::size_t> frames;
  for (const Entry& entry : entries_) frames.push_back(entry.frame);
  return frames;
}

}  // namespace stillpoint::eval
