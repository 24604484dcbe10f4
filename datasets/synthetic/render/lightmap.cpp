// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/lightmap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

constexpr float kNodeDistance_m = 0.2F;
constexpr int kMaxNodes = 96;  // along one edge
constexpr float kInset =
    0.02F;  // border nodes are moved inwards by this fraction of the edge, away from adjacent surfaces
constexpr float kLift_m = 0.03F;  // start of a shadow ray above the surface: in front of quads hung on a wall
constexpr float kLiftRatio = 0.05F;  // the same for small surfaces, as a fraction of the shorter edge
constexpr int kLampSamples = 3;      // per lamp and node
constexpr int kAmbientSamples = 12;  // per node
constexpr float kAmbientReach_m = 1.2F;
constexpr float kNearLamp_m = 7.0F;  // range of lamps that illuminate moving objects
constexpr float kFarLamp_m = 12.0F;  // lamps farther away are ignored

/// Irradiance from one point of a lamp that emits downwards, per unit of its power.
float lamp_irradiance(const Eigen::Vector3f& to_lamp, const Eigen::Vector3f& normal) {
  const float squared = std::max(to_lamp.squaredNorm(), 0.05F);
  const float length = std::sqrt(squared);
  const float at_surface = normal.dot(to_lamp) / length;
  const float at_lamp = to_lamp.z() / length;
  return at_surface > 0.0F && at_lamp > 0.0F ? at_surface * at_lamp / squared : 0.0F;
}

Eigen::Vector3f random_lamp_point(const Lamp& lamp, RandomSequence& random) {
  const auto x = static_cast<float>(random.uniform(-0.9, 0.9)),
             y = static_cast<float>(random.uniform(-0.9, 0.9));
  return lamp.center + Eigen::Vector3f(x * lamp.half_x, y * lamp.half_y, -0.02F);
}

struct SurfacePoint {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};

float lamp_light(const World& world, const RayTracer& tracer, const SurfacePoint& surface,
                 RandomSequence& random) {
  const auto& [point, normal] = surface;
  float sum = 0.0F;
  for (const Lamp& lamp : world.lamps) {
    if ((lamp.center - point).squaredNorm() > kFarLamp_m * kFarLamp_m) continue;
    for (int i = 0; i < kLampSamples; ++i) {
      const Eigen::Vector3f target = random_lamp_point(lamp, random);
      const float irradiance = lamp_irradiance(target - point, normal);
      if (irradiance > 0.0F && tracer.is_unoccluded(point, target))
        sum += lamp.power * irradiance / kLampSamples;
    }
  }
  return sum;
}

/// Cosine-weighted fraction of the hemisphere that is unoccluded within kAmbientReach_m.
float openness(const RayTracer& tracer, const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
               RandomSequence& random) {
  int open = 0;
  for (int i = 0; i < kAmbientSamples; ++i) {
    const double height = random.uniform(-1.0, 1.0), angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double radius = std::sqrt(1.0 - height * height);
    const Eigen::Vector3d sphere(radius * std::cos(angle), radius * std::sin(angle), height);
    const Eigen::Vector3f direction = (normal * 1.001F + sphere.cast<float>()).normalized();
    if (tracer.is_unoccluded(point, point + kAmbientReach_m * direction)) ++open;
  }
  return static_cast<float>(open) / kAmbientSamples;
}

int node_count(float length) {
  return std::clamp(static_cast<int>(std::ceil(length / kNodeDistance_m)) + 1, 2, kMaxNodes);
}

/// The point of a quad at the lightmap node (u, v).
SurfacePoint node_at(const Quad& quad, float u, float v) {
  const float inner_u = kInset + u * (1.0F - 2.0F * kInset), inner_v = kInset + v * (1.0F - 2.0F * kInset);
  const float lift = std::min(kLift_m, kLiftRatio * std::min(quad.edge_u.norm(), quad.edge_v.norm()));
  return {quad.origin + inner_u * quad.edge_u + inner_v * quad.edge_v + lift * quad.normal, quad.normal};
}

float node_light(const World& world, const RayTracer& tracer, const SurfacePoint& node,
                 RandomSequence& random) {
  const float lamps = lamp_light(world, tracer, node, random);
  return lamps + world.ambient * (0.25F + 0.75F * openness(tracer, node.point, node.normal, random));
}

}  // namespace

float unshadowed_light(const World& world, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  float sum = world.ambient;
  for (const Lamp& lamp : world.lamps) {
    const Eigen::Vector3f to_lamp = lamp.center - point;
    if (to_lamp.squaredNorm() < kNearLamp_m * kNearLamp_m)
      sum += lamp.power * lamp_irradiance(to_lamp, normal);
  }
  return sum;
}

void bake_light(World& world, const RayTracer& tracer, std::uint64_t seed) {
  world.light.clear();
  for (std::size_t i = 0; i < world.quads.size(); ++i) {
    Quad& quad = world.quads[i];
    RandomSequence random(random_key(seed, RandomStream::kScene, 1000 + i));
    quad.light_first = static_cast<int>(world.light.size());
    quad.light_columns = node_count(quad.edge_u.norm());
    quad.light_rows = node_count(quad.edge_v.norm());
    for (int row = 0; row < quad.light_rows; ++row) {
      for (int column = 0; column < quad.light_columns; ++column) {
        const float u = static_cast<float>(column) / static_cast<float>(quad.light_columns - 1);
        const float v = static_cast<float>(row) / static_cast<float>(quad.light_rows - 1);
        world.light.push_back(quad.emissive ? 1.0F : node_light(world, tracer, node_at(quad, u, v), random));
      }
    }
  }
}

}  // namespace stillpoint::synth
