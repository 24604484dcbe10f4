// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/landmark_tracks.h"

#include <algorithm>

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
void remove_useless(Window& window) {
  const int newest = window.newest();
  std::erase_if(window.landmarks, [newest](const Landmark& landmark) {
    return landmark.observations.empty() || (landmark.observations.size() < 2 && landmark.last() < newest);
  });
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
  std::vector<Landmark> born;
  for (const TrackedFeature& feature : frame.features) {
    while (landmark != window.landmarks.end() && landmark->id < feature.id) ++landmark;
    const bool known =
        landmark != window.landmarks.end() && landmark->id == feature.id && landmark->last() == newest - 1;
    if (known) {
      landmark->observations.push_back(observe(feature, rig, config));
    } else if (landmark == window.landmarks.end() || landmark->id != feature.id) {
      born.push_back(
          Landmark{.id = feature.id, .host = newest, .observations = {observe(feature, rig, config)}});
    }
  }
  window.landmarks.insert(window.landmarks.end(), born.begin(), born.end());
  std::inplace_merge(
      window.landmarks.begin(), window.landmarks.end() - static_cast<std::ptrdiff_t>(born.size()),
      window.landmarks.end(), [](const Landmark& a, const Landmark& b) { return a.id < b.id; });
  remove_useless(window);
}

bool is_second_newest_keyframe(const Window& window, const BackendConfig& config, double focal_px) {
  const int second = window.newest() - 1;
  if (second < 1) return true;

  const double interval = seconds_between(window.frames[static_cast<std::size_t>(second - 1)].state.t,
                                          window.frames.back().state.t);
  if (interval > config.keyframe_max_interval_s) return true;

  int tracked = 0;
  int common = 0;
  double displacement_px = 0.0;
  for (const Landmark& landmark : window.landmarks) {
    tracked += landmark.host < window.newest() && landmark.last() == window.newest();
    if (landmark.dynamic || !landmark.seen_in(second - 1) || !landmark.seen_in(second)) continue;
    displacement_px += focal_px * (landmark.in(second).bearing - landmark.in(second - 1).bearing).norm();
    ++common;
  }
  if (tracked < config.keyframe_min_tracked || common == 0) return true;
  return displacement_px / common >= config.keyframe_parallax_px;
}

void remove_oldest_frame(Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host == 0) move_to_next_host(window, landmark);
    --landmark.host;
  }
  window.frames.erase(window.frames.begin());
  window.frames.front().from_previous.reset();
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
  window.frames.back().from_previous = merged(window.frames[static_cast<std::size_t>(second)].from_previous,
                                              window.frames.back().from_previous);
  window.frames.erase(window.frames.end() - 2);
  remove_useless(window);
}

std::optional<Preintegration> merged(const std::optional<Preintegration>& earlier,
                                     const std::optional<Preintegration>& later) {
  if (!earlier || !later) return std::nullopt;
  std::optional<Preintegration> both = earlier;
  both->integrate(later->samples());
  return both;
}

void forget_past(Landmark& landmark) {
  landmark.host = landmark.last();
  landmark.observations.erase(landmark.observations.begin(), std::prev(landmark.observations.end()));
  landmark.inverse_depth = 0.0;
  landmark.source = DepthSource::kNone;
}

}  // namespace stillpoint
