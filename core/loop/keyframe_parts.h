// SPDX-License-Identifier: BSD-3-Clause
/// Parts of the keyframes: a loaded map, and the segments of the run. Each has an odometry of its own; the
/// motion between two parts is not known until a later one is located in the map.
#pragma once

#include <cstddef>
#include <vector>

#include "core/loop/loop_consistency.h"

namespace stillpoint {

class KeyframeParts {
 public:
  /// Begins the part of the next keyframes. The first one determines the frame of the map and is located.
  /// @param segment of the run; -1: a loaded map
  void begin(int segment) { parts_.push_back({.segment = segment, .located = parts_.empty()}); }

  /// Appends the next keyframe to the current part.
  void add() { part_of_.push_back(parts_.size() - 1); }

  /// Whether the poses of the current part are known in the map.
  void set_located(bool located) { parts_.back().located = located; }
  [[nodiscard]] bool is_located() const { return parts_.back().located; }

  [[nodiscard]] bool is_first_part() const { return parts_.size() == 1; }
  /// Whether the current part has no keyframe yet.
  [[nodiscard]] bool is_empty() const { return part_of_.empty() || part_of_.back() + 1 != parts_.size(); }

  [[nodiscard]] int segment_of(std::size_t keyframe) const { return parts_[part_of_[keyframe]].segment; }
  [[nodiscard]] bool is_loaded(std::size_t keyframe) const { return segment_of(keyframe) < 0; }
  [[nodiscard]] bool is_current(std::size_t keyframe) const {
    return part_of_[keyframe] + 1 == parts_.size();
  }
  [[nodiscard]] bool is_in_map(std::size_t keyframe) const { return parts_[part_of_[keyframe]].located; }
  [[nodiscard]] bool is_same_part(std::size_t i, std::size_t j) const { return part_of_[i] == part_of_[j]; }
  /// Whether a loop locates the current part in the map.
  [[nodiscard]] bool is_location(const GraphLoop& loop) const {
    return is_current(static_cast<std::size_t>(loop.query)) &&
           is_reference(static_cast<std::size_t>(loop.match));
  }
  /// Whether the odometry knows the motion between the queries of two loops, and that between the matches.
  [[nodiscard]] bool is_same_part(const GraphLoop& a, const GraphLoop& b) const {
    const auto is_same = [this](int i, int j) {
      return is_same_part(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    };
    return is_same(a.match, b.match) && is_same(a.query, b.query);
  }
  /// A keyframe of another part by which the current one can be located.
  [[nodiscard]] bool is_reference(std::size_t keyframe) const {
    return is_in_map(keyframe) && !is_current(keyframe);
  }

 private:
  struct Part {
    int segment = 0;
    bool located = false;
  };
  std::vector<Part> parts_;
  std::vector<std::size_t> part_of_;  ///< of each keyframe
};

}  // namespace stillpoint
