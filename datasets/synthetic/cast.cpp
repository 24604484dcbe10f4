// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/cast.h"

#include "core/base/error.h"
#include "datasets/synthetic/person.h"
#include "datasets/synthetic/unknown_movers.h"

namespace stillpoint {
namespace {

constexpr double kTurnRadius_m = 0.5;
constexpr double kYieldToHand_m = 0.75;  // from a camera in somebody's hand
constexpr double kYieldToRobot_m = 1.2;

/// Where things move, and what they keep away from.
struct Surroundings {
  const std::function<Eigen::Vector2d(double t_s)>& camera_at;
  double from_s, to_s;
  double yield_m;
};

Walk walk_along(const std::vector<Eigen::Vector2d>& way, WalkStyle style, const Surroundings& around,
                std::uint64_t key) {
  RandomSequence random(key);
  const ClosedRoute route(way, kTurnRadius_m);
  style.start_m = random.uniform() * route.length_m();
  style.speed *= random.uniform(0.8, 1.2);
  style.yield_m = around.yield_m;
  return {route, style, around.camera_at, mix_bits(key), around.from_s, around.to_s};
}

void require_places(int wanted, std::size_t places, const std::string& what, const std::string& option) {
  if (wanted > 0 && places == 0) {
    throw InputError("synth: " + what, "there is no place for any in this scene; use " + option + " 0");
  }
}

}  // namespace

std::vector<Actor> cast_actors(const SynthRequest& request, Scene& scene,
                               const std::function<Eigen::Vector2d(double t_s)>& camera_at, double from_s,
                               double to_s) {
  require_places(request.walkers, scene.walkways.size(), "walkers", "--people");
  require_places(request.seated, scene.seats.size(), "seated", "--seated");
  require_places(request.unknown_movers, scene.cartways.size(), "unknown_movers", "--unknown");
  if (request.seated > static_cast<int>(scene.seats.size())) {
    throw InputError("synth: seated",
                     "the scene has " + std::to_string(scene.seats.size()) + " free chairs; use --seated");
  }
  Builder builder(scene.world);
  const bool office = request.preset.starts_with("walking");
  const Surroundings around{camera_at, from_s, to_s, office ? kYieldToHand_m : kYieldToRobot_m};
  std::vector<Actor> actors;
  const auto key = [&] { return random_key(request.seed, RandomStream::kPeople, actors.size()); };
  const auto object = [&] { return static_cast<int>(actors.size()) + 1; };
  for (int i = 0; i < request.walkers; ++i) {
    const auto& way = scene.walkways[static_cast<std::size_t>(i) % scene.walkways.size()];
    actors.push_back(make_walker(
        builder, object(), walk_along(way, {.speed = 0.9, .stops_per_minute = 7.0}, around, key()), key()));
  }
  for (int i = 0; i < request.seated; ++i) {
    actors.push_back(make_sitter(builder, object(), scene.seats[static_cast<std::size_t>(i)], key()));
  }
  for (int i = 0; i < request.unknown_movers; ++i) {
    const auto& way = scene.cartways[static_cast<std::size_t>(i) % scene.cartways.size()];
    const WalkStyle style{.speed = 0.55, .stops_per_minute = 6.0, .stop_s = 3.0};
    const Walk walk = walk_along(way, style, around, key());
    const bool chair = office && i % 2 == 0;
    actors.push_back(chair ? make_rolling_chair(scene.palette, kFirstUnknownMover + i, walk, key())
                           : make_cart(scene.palette, kFirstUnknownMover + i, walk, key()));
  }
  return actors;
}

}  // namespace stillpoint
