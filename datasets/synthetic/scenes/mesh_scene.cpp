// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/scenes/mesh_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/base/error.h"
#include "datasets/synthetic/render/ray_tracer.h"
#include "datasets/synthetic/scenes/mesh_file.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kLampHeight_m = 2.4;
constexpr double kLampPower = 1.9;  // as in the rendered rooms
constexpr double kAmbient = 0.45;   // people are lit about as strongly as on a bright scan

Eigen::AlignedBox3f bounds_of(const StaticMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

void require_meters(const std::filesystem::path& file, const Eigen::AlignedBox3f& box) {
  constexpr float kLargest_m = 1000.0F;
  const float size = box.sizes().maxCoeff();
  if (size <= kLargest_m) return;
  throw InputError(file.string(), fmt::format("is {:.0f} m long, so that its unit is probably not the meter; "
                                              "scale it to meters",
                                              size));
}

/// The camera must be in or beside the mesh, with z up.
void require_common_frame(const std::filesystem::path& file, const Eigen::AlignedBox3f& box,
                          std::span<const Pose> path) {
  constexpr float kFar_m = 10.0F;
  constexpr double kLevel = 0.25;  // sine of the angle between the camera's upward axis and the horizon
  constexpr double kSteep = 0.7;   // the upward axis of a camera that looks up or down says nothing
  float distance = std::numeric_limits<float>::infinity();
  double up = 0.0, ahead = 0.0;
  for (const Pose& T_w_c : path) {
    distance = std::min(distance, box.exteriorDistance(Vector3f(T_w_c.p.cast<float>())));
    up -= (T_w_c.q * Vector3d::UnitY()).z() / static_cast<double>(path.size());
    ahead += (T_w_c.q * Vector3d::UnitZ()).z() / static_cast<double>(path.size());
  }
  if (distance > kFar_m) {
    throw InputError(file.string(), fmt::format("the camera is never closer than {:.0f} m to the mesh; give "
                                                "its path in the frame of the mesh",
                                                distance));
  }
  if (up < kLevel && std::abs(ahead) < kSteep) {
    throw InputError(file.string(),
                     "the camera is on its side or upside down, if z points up; rotate mesh and "
                     "path (`stillpoint trajectory transform`)");
  }
}

/// Distance to the surface in a direction; `most_m` if there is none closer.
double free_distance(const RayTracer& tracer, const Vector3d& from, const Vector3d& direction,
                     double most_m) {
  RayPacket packet{};
  std::ranges::fill(packet.far, -1.0F);
  std::ranges::fill(packet.primitive, -1);
  const Vector3f origin = from.cast<float>(), ray = direction.cast<float>();
  packet.origin_x[0] = origin.x(), packet.origin_y[0] = origin.y(), packet.origin_z[0] = origin.z();
  packet.direction_x[0] = ray.x(), packet.direction_y[0] = ray.y(), packet.direction_z[0] = ray.z();
  packet.far[0] = static_cast<float>(most_m);
  tracer.trace(packet);
  return packet.primitive[0] < 0 ? most_m : static_cast<double>(packet.far[0]);
}

/// @throws InputError if no camera of the path sees a surface along rays over a view of 90 degrees
void require_visible(const std::filesystem::path& file, const RayTracer& tracer, std::span<const Pose> path) {
  constexpr int kRays = 65;  // per row and column: 1.4 degrees apart
  constexpr double kAnyDistance_m = 1e4;
  const auto sees = [&](const Pose& T_w_c) {
    for (int ray = 0; ray < kRays * kRays; ++ray) {
      const Vector3d direction_c(2.0 * (ray % kRays) / (kRays - 1) - 1.0,
                                 2.0 * (ray / kRays) / (kRays - 1) - 1.0, 1.0);
      if (free_distance(tracer, T_w_c.p, T_w_c.q * direction_c, kAnyDistance_m) < kAnyDistance_m) return true;
    }
    return false;
  };
  if (std::ranges::any_of(path, sees)) return;
  throw InputError(file.string(),
                   "is not in view of the camera at any time; check the order of the quaternions and the "
                   "frame of the path, and that the faces have an area");
}

/// Height of the floor: the median of what is below the camera or, where most of that is missing, that below
/// which a hundredth of the vertices is.
double floor_height(const StaticMesh& mesh, const RayTracer& tracer, std::span<const Pose> path) {
  constexpr double kLowest_m = 4.0;  // below the camera
  std::vector<double> heights;
  for (const Pose& T_w_c : path) {
    const double distance = free_distance(tracer, T_w_c.p, -Vector3d::UnitZ(), kLowest_m);
    if (distance < kLowest_m) heights.push_back(T_w_c.p.z() - distance);
  }
  std::size_t rank = heights.size() / 2;
  if (2 * heights.size() < path.size()) {
    heights.clear();
    for (const Vector3f& vertex : mesh.vertices) heights.push_back(static_cast<double>(vertex.z()));
    rank = heights.size() / 100;
  }
  std::ranges::nth_element(heights, heights.begin() + static_cast<std::ptrdiff_t>(rank));
  return heights[rank];
}

/// A closed route around `center`, above the floor z = `floor`: at half of the free distance in each
/// direction.
std::optional<std::vector<Vector2d>> route_around(const RayTracer& tracer, const Vector3d& center,
                                                  double floor) {
  constexpr int kDirections = 12;
  constexpr double kMost_m = 5.0, kLeast_m = 1.0;
  std::vector<Vector2d> route;
  int narrow = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDirections;
    const Vector3d direction(std::cos(angle), std::sin(angle), 0.0);
    double free_m = kMost_m;
    for (const double height : {0.3, 0.8, 1.3, 1.7}) {
      const Vector3d from(center.x(), center.y(), floor + height);
      free_m = std::min(free_m, free_distance(tracer, from, direction, kMost_m));
    }
    narrow += free_m < kLeast_m ? 1 : 0;
    route.emplace_back(center.head<2>() + 0.5 * free_m * direction.head<2>());
  }
  if (2 * narrow > kDirections) return {};
  return route;
}

}  // namespace

Scene build_mesh_scene(const std::filesystem::path& file, std::span<const Pose> path) {
  Scene scene;
  read_mesh(file, scene.world);
  const Eigen::AlignedBox3f box = bounds_of(scene.world.mesh);
  require_meters(file, box);
  require_common_frame(file, box, path);
  scene.world.ambient = static_cast<float>(kAmbient);
  Vector3d center = Vector3d::Zero();
  for (const Pose& T_w_c : path) center += T_w_c.p / static_cast<double>(path.size());
  const RayTracer tracer(scene.world);
  require_visible(file, tracer, path);
  scene.floor_m = floor_height(scene.world.mesh, tracer, path);
  scene.world.lamps.push_back({.center = {static_cast<float>(center.x()), static_cast<float>(center.y()),
                                          static_cast<float>(scene.floor_m + kLampHeight_m)},
                               .power = static_cast<float>(kLampPower)});
  if (const auto route = route_around(tracer, center, scene.floor_m)) scene.walking_routes = {*route};
  return scene;
}

}  // namespace stillpoint::synth
