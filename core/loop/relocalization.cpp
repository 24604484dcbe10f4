// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/relocalization.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/loop/loop_consistency.h"

namespace stillpoint {
namespace {

constexpr std::size_t kRecentFrames = 5;
constexpr int kAgreeingFrames = 2;
constexpr std::size_t kMaxPlaces = 4;  // more than for a keyframe, to notice places that look alike
constexpr double kSamePlace_m = 0.2;
constexpr double kSamePlace_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double kMaxGravityAngle_rad = 2.0 * std::numbers::pi / 180.0;

/// Whether the directions of gravity of both keyframes agree; true if one of them is unknown.
bool gravity_agrees(const Keyframe& query, const Keyframe& match, const Pose& T_bm_bq) {
  if (!query.gravity_b || !match.gravity_b) return true;
  return match.gravity_b->dot(T_bm_bq.q * *query.gravity_b) >= std::cos(kMaxGravityAngle_rad);
}

bool is_same_place(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() <= kSamePlace_m && a.q.angularDistance(b.q) <= kSamePlace_rad;
}

Pose pose_in_map(const MapLocation& location, std::span<const Keyframe> map) {
  return map[static_cast<std::size_t>(location.match)].T_w_b * location.T_bm_bq;
}

}  // namespace

std::optional<MapLocation> Relocalization::locate(const Keyframe& frame, std::span<const Keyframe> map,
                                                  const KeyframeParts& parts,
                                                  const PlaceRecognition& recognition) {
  records_.clear();
  std::optional<MapLocation> location = best_location(frame, map, parts, recognition);
  const bool confirmed = location && is_confirmed(*location, map);
  recent_.push_back(location);
  if (recent_.size() > kRecentFrames) recent_.pop_front();
  if (!confirmed) return std::nullopt;
  records_[location->record].outcome = LoopOutcome::kAccepted;
  return location;
}

/// Verifies one place, and records it.
std::optional<MapLocation> Relocalization::verify(const Keyframe& frame, const PlaceVotes& place,
                                                  const Keyframe& match) {
  const VerifiedLoop loop = verify_loop(frame, match, camera_, config_);
  LoopRecord& record = records_.emplace_back(loop.record);
  record.votes = place.votes;
  if (record.outcome != LoopOutcome::kAccepted) return std::nullopt;
  record.outcome = LoopOutcome::kUnconfirmed;
  if (!gravity_agrees(frame, match, loop.T_bm_bq)) {
    record.outcome = LoopOutcome::kOdometry;
    return std::nullopt;
  }
  return MapLocation{.record = records_.size() - 1,
                     .match = place.place,
                     .t = frame.t,
                     .T_w_b = frame.T_w_b,
                     .T_bm_bq = loop.T_bm_bq,
                     .covariance = loop.covariance};
}

/// The location at the most similar place; none if the frame is ambiguous.
std::optional<MapLocation> Relocalization::best_location(const Keyframe& frame, std::span<const Keyframe> map,
                                                         const KeyframeParts& parts,
                                                         const PlaceRecognition& recognition) {
  std::optional<MapLocation> best;
  std::size_t verified = 0;
  for (const PlaceVotes& place : recognition.similar_places(frame)) {
    const auto match = static_cast<std::size_t>(place.place);
    if (!parts.is_reference(match)) continue;
    if (++verified > kMaxPlaces) break;
    const std::optional<MapLocation> location = verify(frame, place, map[match]);
    records_.back().in_map = parts.is_loaded(match);
    if (!location) continue;
    if (!best) {
      best = location;
    } else if (!is_same_place(pose_in_map(*best, map), pose_in_map(*location, map))) {
      records_.back().outcome = LoopOutcome::kPairwise;
      return std::nullopt;
    }
  }
  return best;
}

bool Relocalization::is_confirmed(const MapLocation& location, std::span<const Keyframe> map) const {
  int agreeing = 0;
  for (const std::optional<MapLocation>& before : recent_) {
    if (!before) continue;
    if (distance(*before, location, map) > kMaxSquaredDistance) return false;
    ++agreeing;
  }
  return agreeing >= kAgreeingFrames;
}

/// As `pairwise_distance`, with the drift of the odometry between the frames, and of the map between the
/// matches. Times of the map may be those of several runs and are not used.
double Relocalization::distance(const MapLocation& a, const MapLocation& b,
                                std::span<const Keyframe> map) const {
  const std::array<Pose, 4> poses = {map[static_cast<std::size_t>(a.match)].T_w_b,
                                     map[static_cast<std::size_t>(b.match)].T_w_b, a.T_w_b, b.T_w_b};
  OdometryDrift drift;
  drift.add(a.t, poses[0]);
  drift.add(a.t, poses[1]);
  drift.add_unrelated(a.t, poses[2]);
  drift.add(b.t, poses[3]);
  return pairwise_distance({.match = 0, .query = 2, .T_bm_bq = a.T_bm_bq, .covariance = a.covariance},
                           {.match = 1, .query = 3, .T_bm_bq = b.T_bm_bq, .covariance = b.covariance}, poses,
                           drift);
}

}  // namespace stillpoint
