// SPDX-License-Identifier: BSD-3-Clause
/// Location of single frames in a map. A keyframe of the odometry is final when it leaves the window, seconds
/// after the start; until then, current frames are looked up.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/loop/loop_consistency.h"
#include "core/loop/loop_verification.h"
#include "core/loop/place_recognition.h"

namespace stillpoint {

/// Pose of a frame relative to a keyframe of the map.
struct MapLocation {
  std::size_t record = 0;  ///< index in the records of the frame
  int match = 0;           ///< keyframe of the map
  Timestamp t;             ///< of the frame
  Pose T_w_b;              ///< of the frame, by the odometry
  Pose T_bm_bq;
  Matrix6 covariance = Matrix6::Identity();  ///< of `T_bm_bq`: p + rho, q * Exp(theta)
};

class Relocalization {
 public:
  Relocalization(const LoopConfig& config, const Camera& camera) : config_(config), camera_(camera) {}

  /// Verifies the places of the map that look like the frame. Its location is certain if it and at least two
  /// of the five frames before agree with each other over the motion of the odometry, and none contradicts.
  /// A frame that fits two places more than 0.2 m or 5 degrees apart is ambiguous, and has no location; nor
  /// has one whose direction of gravity differs from that of the map by more than 2 degrees.
  /// @param frame the next one: described, with its pose by the odometry
  /// @param map keyframes with their poses in the map, at least the places of `recognition`
  /// @param parts those of `map`; only references of the current part are used
  /// @return nullopt without a certain location
  [[nodiscard]] std::optional<MapLocation> locate(const Keyframe& frame, std::span<const Keyframe> map,
                                                  const KeyframeParts& parts,
                                                  const PlaceRecognition& recognition);

  /// The candidates of the last frame; accepted is that of the location, if it is certain.
  [[nodiscard]] const std::vector<LoopRecord>& records() const { return records_; }

 private:
  [[nodiscard]] std::optional<MapLocation> verify(const Keyframe& frame, const PlaceVotes& place,
                                                  const Keyframe& match);
  [[nodiscard]] std::optional<MapLocation> best_location(const Keyframe& frame, std::span<const Keyframe> map,
                                                         const KeyframeParts& parts,
                                                         const PlaceRecognition& recognition);
  [[nodiscard]] bool is_confirmed(const MapLocation& location, std::span<const Keyframe> map) const;
  [[nodiscard]] double distance(const MapLocation& a, const MapLocation& b,
                                std::span<const Keyframe> map) const;

  LoopConfig config_;
  Camera camera_;
  std::deque<std::optional<MapLocation>> recent_;  ///< of the frames before
  std::vector<LoopRecord> records_;
};

}  // namespace stillpoint
