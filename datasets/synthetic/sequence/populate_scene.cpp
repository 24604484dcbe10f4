// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/populate_scene.h"

#include "core/base/error.h"
#include "datasets/synthetic/actors/movers.h"

namespace stillpoint::synth {
namespace {

constexpr double kTurnRadius_m = 0.5;
constexpr double kHandheldClearance_m = 0.75;  // minimum distance to a hand-held camera
constexpr double kRobotClearance_m = 1.2;
constexpr double kFastRobotClearance_m = 1.8;  // a robot that does not overtake retreating people

Walk make_walk(const std::vector<Eigen::Vector2d>& corners, WalkStyle style, const CameraMotion& camera,
               std::uint64_t key) {
  RandomSequence random(key);
  const ClosedRoute route(corners, kTurnRadius_m);
  style.start_m = random.uniform() * route.length_m();
  style.speed *= random.uniform(0.8, 1.2);
  return {route, style, camera, mix_bits(key)};
}

/// Moves an actor from z = 0 to the floor.
void lift(Actor& actor, double floor_m) {
  actor.poses_at = [poses_at = std::move(actor.poses_at), floor_m](double t_s) {
    std::vector<Pose> poses = poses_at(t_s);
    for (Pose& pose : poses) pose.p.z() += floor_m;
    return poses;
  };
}

void require_positions(int requested, std::size_t available, const std::string& what,
                       const std::string& option) {
  if (requested > 0 && available == 0) {
    throw InputError("synth: " + what, "this scene has no space for any; use " + option + " 0");
  }
}

}  // namespace

std::vector<Actor> populate_scene(const SynthRequest& request, Scene& scene, const CameraMotion& camera) {
  require_positions(request.walkers, scene.walking_routes.size(), "walkers", "--people");
  require_positions(request.seated, scene.seats.size(), "seated", "--seated");
  require_positions(request.unknown_movers, scene.cart_routes.size(), "unknown_movers", "--unknown");
  if (request.seated > static_cast<int>(scene.seats.size())) {
    throw InputError("synth: seated",
                     "the scene has " + std::to_string(scene.seats.size()) + " free chairs; use --seated");
  }
  Builder builder(scene.world);
  const bool office = request.preset.starts_with("walking") || is_hand_recording(request) || is_mesh(request);
  const double clearance_m = office                    ? kHandheldClearance_m
                             : is_loop_preset(request) ? kFastRobotClearance_m
                                                       : kRobotClearance_m;
  std::vector<Actor> actors;
  const auto key = [&] { return random_key(request.seed, RandomStream::kPeople, actors.size()); };
  const auto object = [&] { return static_cast<int>(actors.size()) + 1; };
  const WalkStyle style{.speed = 0.9, .stops_per_minute = 7.0, .camera_clearance_m = clearance_m};
  for (int i = 0; i < request.walkers; ++i) {
    const auto& corners = scene.walking_routes[static_cast<std::size_t>(i) % scene.walking_routes.size()];
    actors.push_back(make_walking_person(builder, object(), make_walk(corners, style, camera, key()), key()));
  }
  for (int i = 0; i < request.seated; ++i) {
    actors.push_back(make_seated_person(builder, object(), scene.seats[static_cast<std::size_t>(i)], key()));
  }
  const WalkStyle cart_style{
      .speed = 0.55, .stops_per_minute = 6.0, .stop_s = 3.0, .camera_clearance_m = clearance_m};
  for (int i = 0; i < request.unknown_movers; ++i) {
    const auto& corners = scene.cart_routes[static_cast<std::size_t>(i) % scene.cart_routes.size()];
    const Walk walk = make_walk(corners, cart_style, camera, key());
    const bool chair = office && i % 2 == 0;
    actors.push_back(
        chair ? make_rolling_chair(scene.palette, datasets::kFirstUndetectableObject + i, walk, key())
              : make_cart(scene.palette, datasets::kFirstUndetectableObject + i, walk, key()));
  }
  if (scene.floor_m != 0.0)
    for (Actor& actor : actors) lift(actor, scene.floor_m);
  return actors;
}

}  // namespace stillpoint::synth
