// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/landmark_tracks.h"

#include <optional>
#include <utility>

#include "core/backend/factors/reprojection_rows.h"

namespace stillpoint {
namespace {

/// What the observations of a frame share.
struct FrameCalibration {
  const Rig& rig;
  const DepthConfig& depth;
  Eigen::Vector4d lens;
};

Observation make_observation(const TrackedFeature& feature, const FrameCalibration& calibration) {
  const auto& [rig, config, lens] = calibration;
  const double row = feature.pixel.y() / rig.camera.height - 0.5;
  const bool valid_depth = config.usage != DepthUsage::kOff && feature.depth >= config.min_m;
  return Observation{.bearing = corrected_bearing(feature.bearing, lens),
                     .seen = feature.bearing,
                     .velocity = feature.velocity,
                     .depth = valid_depth ? feature.depth : 0.0,
                     .readout_offset_s = row * rig.rolling_shutter_s};
}

/// Lost tracks with a single observation constrain nothing.
bool is_expired(const Landmark& landmark, int newest) {
  return landmark.observations.empty() || (landmark.observations.size() < 2 && landmark.last() < newest);
}

void remove_expired(Window& window) {
  auto kept_end = window.landmarks.begin();
  for (Landmark& landmark : window.landmarks) {
    if (!is_expired(landmark, window.newest())) std::swap(*kept_end++, landmark);
  }
  for (auto expired = kept_end; expired != window.landmarks.end(); ++expired) {
    window.observation_pool.release(std::move(expired->observations));
  }
  window.landmarks.erase(kept_end, window.landmarks.end());
}

/// The tracker knows the velocity of a feature from its second observation on. With 0 the first one, the
/// host, would not be shifted to the time of its frame by the readout offset of its row.
void complete_first_velocity(const TrackedFeature& next, const Window& window, Landmark& landmark) {
  Observation& first = landmark.observations.front();
  const bool unknown = landmark.observations.size() == 1 && first.velocity.isZero(0.0);
  if (unknown && window.time_offset_model == TimeOffsetModel::kInertial) first.velocity = next.velocity;
}

Landmark make_landmark(const TrackedFeature& feature, const Observation& observation, Window& window) {
  Landmark landmark{
      .id = feature.id, .host = window.newest(), .observations = window.observation_pool.acquire()};
  landmark.observations.reserve(window.frames.size());
  landmark.observations.push_back(observation);
  return landmark;
}

void remove_preintegration(int frame, Window& window) {
  std::optional<Preintegration>& imu = window.frames[static_cast<std::size_t>(frame)].from_previous;
  if (imu) window.sample_pool.release(imu->release_samples());
  imu.reset();
}

/// Replaces the preintegration to frame + 1 by the one from frame - 1 on; by none if either is absent.
void merge_preintegrations(int frame, Window& window) {
  std::optional<Preintegration>& earlier = window.frames[static_cast<std::size_t>(frame)].from_previous;
  std::optional<Preintegration>& later = window.frames[static_cast<std::size_t>(frame) + 1].from_previous;
  if (earlier && later) earlier->append(*later);
  if (!later) remove_preintegration(frame, window);
  remove_preintegration(frame + 1, window);
  later = std::exchange(earlier, std::nullopt);
  window.frames[static_cast<std::size_t>(frame) + 1].imu_is_reliable &=
      window.frames[static_cast<std::size_t>(frame)].imu_is_reliable;
}

/// Removes the first observation and re-expresses the inverse depth in the next frame with the estimated
/// poses.
void move_to_next_host(const Window& window, Landmark& landmark) {
  if (landmark.inverse_depth > 0.0 && landmark.observations.size() > 1) {
    const double depth = (window.T_w_c(landmark.host + 1).inverse() * window.position(landmark)).z();
    landmark.inverse_depth = depth > 0.0 ? 1.0 / depth : 0.0;
    if (depth <= 0.0) landmark.source = DepthSource::kNone;
  }
  landmark.observations.erase(landmark.observations.begin());
  ++landmark.host;
}

}  // namespace

void set_lens(const Eigen::Vector4d& lens, Window& window) {
  if (lens == window.lens) return;
  window.lens = lens;
  for (Landmark& landmark : window.landmarks)
    for (Observation& observation : landmark.observations)
      observation.bearing = corrected_bearing(observation.seen, lens);
}

void add_observations(const TrackedFrame& frame, const Rig& rig, const DepthConfig& config, Window& window) {
  const int newest = window.newest();
  const FrameCalibration calibration{rig, config, window.lens};
  auto landmark = window.landmarks.begin();
  for (const TrackedFeature& feature : frame.features) {
    if (!feature.bearing.allFinite()) continue;
    while (landmark != window.landmarks.end() && landmark->id < feature.id) ++landmark;
    const bool known =
        landmark != window.landmarks.end() && landmark->id == feature.id && landmark->last() == newest - 1;
    if (known) {
      complete_first_velocity(feature, window, *landmark);
      landmark->observations.push_back(make_observation(feature, calibration));
    } else if (landmark == window.landmarks.end() || landmark->id != feature.id) {
      landmark = window.landmarks.insert(
          landmark, make_landmark(feature, make_observation(feature, calibration), window));
    } else {  // recognized after a loss
      landmark->observations.push_back(make_observation(feature, calibration));
      landmark->host = newest + 1 - static_cast<int>(landmark->observations.size());
      restart_track(*landmark);
    }
  }
  remove_expired(window);
}

bool is_second_newest_keyframe(const Window& window, const BackendConfig& config, double focal_px) {
  const int second = window.newest() - 1;
  if (second < 1) return true;

  const double interval = seconds_between(window.frames[static_cast<std::size_t>(second - 1)].state.t,
                                          window.frames.back().state.t);
  if (interval > config.keyframe_max_interval_s) return true;

  int in_newest = 0;
  int shared = 0;
  int common = 0;
  double displacement_px = 0.0;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic) continue;
    const bool observed_now = landmark.last() == window.newest();
    in_newest += observed_now;
    shared += observed_now && landmark.observed_in(second - 1);
    if (!landmark.observed_in(second - 1) || !landmark.observed_in(second)) continue;
    displacement_px +=
        focal_px *
        (landmark.observation_in(second).bearing - landmark.observation_in(second - 1).bearing).norm();
    ++common;
  }
  if (shared < config.keyframe_min_tracked || shared < config.keyframe_min_shared_ratio * in_newest ||
      common == 0)
    return true;
  return displacement_px / common >= config.keyframe_parallax_px;
}

void remove_oldest_frame(Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host == 0) move_to_next_host(window, landmark);
    --landmark.host;
  }
  window.frames.erase(window.frames.begin());
  remove_preintegration(0, window);
  remove_expired(window);
}

void remove_second_newest_frame(Window& window) {
  const int second = window.newest() - 1;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host == second) {
      move_to_next_host(window, landmark);
    } else if (landmark.observed_in(second)) {
      landmark.observations.erase(landmark.observations.begin() + (second - landmark.host));
    }
    if (landmark.host > second) --landmark.host;
  }
  merge_preintegrations(second, window);
  window.frames.erase(window.frames.end() - 2);
  remove_expired(window);
}

void remove_newest_frame(Window& window) {
  const int newest = window.newest();
  for (Landmark& landmark : window.landmarks) {
    if (landmark.last() == newest) landmark.observations.pop_back();
  }
  remove_preintegration(newest, window);
  window.frames.pop_back();
  remove_expired(window);
}

void restart_track(Landmark& landmark) {
  landmark.host = landmark.last();
  landmark.observations.erase(landmark.observations.begin(), std::prev(landmark.observations.end()));
  landmark.inverse_depth = 0.0;
  landmark.source = DepthSource::kNone;
}

std::vector<Landmark> landmarks_of_newest(const Window& window, const Eigen::Vector4d& lens) {
  std::vector<Landmark> landmarks;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest()) continue;
    Observation observation = landmark.observations.back();
    observation.information = 1.0;
    observation.bearing = corrected_bearing(observation.seen, lens);
    landmarks.push_back({.id = landmark.id, .observations = {observation}, .dynamic = landmark.dynamic});
  }
  return landmarks;
}

}  // namespace stillpoint
