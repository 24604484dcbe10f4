// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/landmark_tracks.h"

#include <optional>
#include <utility>

namespace stillpoint {
namespace {

Observation observe(const TrackedFeature& feature, const Rig& rig, const DepthConfig& config) {
  const double row = feature.pixel.y() / rig.camera.height - 0.5;
  const bool believed = config.usage != DepthUsage::kOff && feature.depth >= config.min_m;
  return Observation{.bearing = feature.bearing,
                     .velocity = feature.velocity,
                     .depth = believed ? feature.depth : 0.0,
                     .read_out_s = row * rig.rolling_shutter_s};
}

/// Landmarks of ended tracks with one observation tie nothing together any more.
bool is_useless(const Landmark& landmark, int newest) {
  return landmark.observations.empty() || (landmark.observations.size() < 2 && landmark.last() < newest);
}

void remove_useless(Window& window) {
  auto kept = window.landmarks.begin();
  for (Landmark& landmark : window.landmarks) {
    if (!is_useless(landmark, window.newest())) std::swap(*kept++, landmark);
  }
  for (auto gone = kept; gone != window.landmarks.end(); ++gone) {
    window.spare_observations.give(std::move(gone->observations));
  }
  window.landmarks.erase(kept, window.landmarks.end());
}

Landmark born(const TrackedFeature& feature, const Observation& seen, Window& window) {
  Landmark landmark{
      .id = feature.id, .host = window.newest(), .observations = window.spare_observations.take()};
  landmark.observations.reserve(window.frames.size());
  landmark.observations.push_back(seen);
  return landmark;
}

void remove(std::optional<Preintegration>& imu, Window& window) {
  if (imu) window.spare_samples.give(imu->take_samples());
  imu.reset();
}

/// Appends the inertial samples of `later` to `earlier`, and puts them in its place; nothing if either is
/// absent.
void merge(std::optional<Preintegration>& earlier, std::optional<Preintegration>& later, Window& window) {
  if (earlier && later) earlier->integrate(later->samples());
  if (!later) remove(earlier, window);
  remove(later, window);
  later = std::exchange(earlier, std::nullopt);
}

/// Takes the first observation away; the inverse depth is expressed anew in the next frame, by the estimated
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

void add_observations(const TrackedFrame& frame, const Rig& rig, const DepthConfig& config, Window& window) {
  const int newest = window.newest();
  auto landmark = window.landmarks.begin();
  for (const TrackedFeature& feature : frame.features) {
    while (landmark != window.landmarks.end() && landmark->id < feature.id) ++landmark;
    const bool known =
        landmark != window.landmarks.end() && landmark->id == feature.id && landmark->last() == newest - 1;
    if (known) {
      landmark->observations.push_back(observe(feature, rig, config));
    } else if (landmark == window.landmarks.end() || landmark->id != feature.id) {
      landmark = window.landmarks.insert(landmark, born(feature, observe(feature, rig, config), window));
    }
  }
  remove_useless(window);
}

bool is_second_newest_keyframe(const Window& window, const BackendConfig& config, double focal_px) {
  const int second = window.newest() - 1;
  if (second < 1) return true;

  const double interval = seconds_between(window.frames[static_cast<std::size_t>(second - 1)].state.t,
                                          window.frames.back().state.t);
  if (interval > config.keyframe_max_interval_s) return true;

  int seen = 0;
  int shared = 0;
  int common = 0;
  double displacement_px = 0.0;
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic) continue;
    const bool now = landmark.last() == window.newest();
    seen += now;
    shared += now && landmark.seen_in(second - 1);
    if (!landmark.seen_in(second - 1) || !landmark.seen_in(second)) continue;
    displacement_px += focal_px * (landmark.in(second).bearing - landmark.in(second - 1).bearing).norm();
    ++common;
  }
  if (shared < config.keyframe_min_tracked || shared < config.keyframe_min_shared * seen || common == 0)
    return true;
  return displacement_px / common >= config.keyframe_parallax_px;
}

void remove_oldest_frame(Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host == 0) move_to_next_host(window, landmark);
    --landmark.host;
  }
  window.frames.erase(window.frames.begin());
  remove(window.frames.front().from_previous, window);
  remove_useless(window);
}

void remove_second_newest_frame(Window& window) {
  const int second = window.newest() - 1;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host == second) {
      move_to_next_host(window, landmark);
    } else if (landmark.seen_in(second)) {
      landmark.observations.erase(landmark.observations.begin() + (second - landmark.host));
    }
    if (landmark.host > second) --landmark.host;
  }
  merge(window.frames[static_cast<std::size_t>(second)].from_previous, window.frames.back().from_previous,
        window);
  window.frames.erase(window.frames.end() - 2);
  remove_useless(window);
}

void forget_past(Landmark& landmark) {
  landmark.host = landmark.last();
  landmark.observations.erase(landmark.observations.begin(), std::prev(landmark.observations.end()));
  landmark.inverse_depth = 0.0;
  landmark.source = DepthSource::kNone;
}

}  // namespace stillpoint
