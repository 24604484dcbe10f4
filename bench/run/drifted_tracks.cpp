// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/drifted_tracks.h"

#include <algorithm>
#include <optional>

namespace stillpoint::bench {
namespace {

constexpr double kMaxDrift_px = 4.0;

std::optional<Pose> true_T_w_c(const datasets::GroundTruth& truth, Timestamp t) {
  const std::vector<StampedPose>& poses = truth.trajectory.poses;
  const auto later = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (later == poses.end()) return std::nullopt;
  const Pose T_f_c = truth.T_c_f.inverse();
  if (later->t == t) return later->T_w_f * T_f_c;
  if (later == poses.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(later);
  const double ratio = seconds_between(before.t, t) / seconds_between(before.t, later->t);
  return interpolate(before.T_w_f, later->T_w_f, ratio) * T_f_c;
}

}  // namespace

bool DriftedTracks::exceeds_drift(const Eigen::Vector3d& p_w, const Observation& observation) const {
  const Eigen::Vector3d p_c = observation.T_w_c.inverse() * p_w;
  return p_c.z() > 0.0 && (info_.rig.camera.project(p_c) - observation.pixel).norm() > kMaxDrift_px;
}

void DriftedTracks::add(const TrackedFrame& frame) {
  std::map<std::int64_t, Track> updated;
  const std::optional<Pose> T_w_c = true_T_w_c(info_.ground_truth, frame.t);
  for (const TrackedFeature& feature : frame.features) {
    if (!T_w_c) break;
    const Observation now{.T_w_c = *T_w_c, .pixel = feature.pixel};
    const auto known = tracks_.find(feature.id);
    Track track = known != tracks_.end() ? known->second : Track{.first = now};
    if (!track.p_w && feature.depth > 0.0) {
      track.p_w = *T_w_c * Eigen::Vector3d(feature.depth * feature.bearing.homogeneous());
    }
    track.drifted = track.p_w && (exceeds_drift(*track.p_w, now) || exceeds_drift(*track.p_w, track.first));
    updated.emplace(feature.id, track);
  }
  tracks_ = std::move(updated);
}

bool DriftedTracks::contains(std::int64_t id) const {
  const auto track = tracks_.find(id);
  return track != tracks_.end() && track->second.drifted;
}

}  // namespace stillpoint::bench
