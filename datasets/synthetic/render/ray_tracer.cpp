// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/ray_tracer.h"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>

#include "core/base/error.h"
#include "datasets/synthetic/render/embree.h"

namespace stillpoint::synth {
namespace {

struct Vertex {
  float x, y, z;
};

Vertex vertex(const Eigen::Vector3f& point) { return {point.x(), point.y(), point.z()}; }

/// A scene with one quality of all its acceleration structures; to be committed.
RTCScene new_scene(RTCDevice device, RTCBuildQuality quality) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, quality);
  return scene;
}

/// Without the check, rays would hit nothing in a scene for which there is no memory.
void commit(RTCDevice device, RTCScene scene) {
  rtcCommitScene(scene);
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot build a scene; report this fault");
}

/// Takes ownership of `geometry`. @param number RTCHit::geomID of its hits
void attach(RTCScene scene, RTCGeometry geometry, unsigned number, RTCBuildQuality quality) {
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, number);
  rtcReleaseGeometry(geometry);
}

struct BufferKind {
  RTCBufferType type;
  unsigned slot;
  RTCFormat format;
};

template <class Element>
Element* new_buffer(RTCGeometry geometry, const BufferKind& kind, std::size_t count) {
  const auto& [type, slot, format] = kind;
  void* const buffer =
      rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(Element), std::max<std::size_t>(count, 1));
  if (buffer == nullptr) throw std::bad_alloc();
  return static_cast<Element*>(buffer);
}

RTCGeometry quads_of(RTCDevice device, const World& world) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
  const std::size_t count = world.quads.size();
  auto* corners = new_buffer<Vertex>(geometry, {RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3}, 4 * count);
  auto* indices =
      new_buffer<std::array<std::uint32_t, 4>>(geometry, {RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4}, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Quad& quad = world.quads[i];
    corners[4 * i] = vertex(quad.origin);
    corners[4 * i + 1] = vertex(quad.origin + quad.edge_u);
    corners[4 * i + 2] = vertex(quad.origin + quad.edge_u + quad.edge_v);
    corners[4 * i + 3] = vertex(quad.origin + quad.edge_v);
    const auto first = static_cast<std::uint32_t>(4 * i);
    indices[i] = {first, first + 1, first + 2, first + 3};
  }
  return geometry;
}

RTCGeometry triangles_of(RTCDevice device, const MovingMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, 2);
  const std::vector<Eigen::Vector3f>* const ends[2] = {&mesh.start, &mesh.end};
  for (unsigned step = 0; step < 2; ++step) {
    auto* corners =
        new_buffer<Vertex>(geometry, {RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3}, mesh.start.size());
    std::transform(ends[step]->begin(), ends[step]->end(), corners, vertex);
  }
  auto* indices = new_buffer<std::array<std::uint32_t, 3>>(
      geometry, {RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3}, mesh.triangles.size());
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
  return geometry;
}

RTCGeometry triangles_of(RTCDevice device, const StaticMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners =
      new_buffer<Vertex>(geometry, {RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3}, mesh.vertices.size());
  std::ranges::transform(mesh.vertices, corners, vertex);
  auto* indices = new_buffer<std::array<std::uint32_t, 3>>(
      geometry, {RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3}, mesh.triangles.size());
  std::ranges::transform(mesh.triangles, indices, &MeshTriangle::corners);
  return geometry;
}

/// The quads are geometry 0, the mesh is geometry 1.
RTCScene world_scene(RTCDevice device, const World& world) {
  constexpr RTCBuildQuality kQuality = RTC_BUILD_QUALITY_MEDIUM;
  RTCScene scene = new_scene(device, kQuality);
  if (!world.quads.empty()) attach(scene, quads_of(device, world), 0, kQuality);
  if (!world.mesh.triangles.empty()) attach(scene, triangles_of(device, world.mesh), 1, kQuality);
  commit(device, scene);
  return scene;
}

/// What a scene contains, for the numbers of its hits.
struct SceneContent {
  bool moving = false;          ///< for RayPacket::moving
  std::int32_t quad_count = 0;  ///< added to the numbers of hits in a second geometry
};

/// Traces the active lanes; lanes with a closer hit get its data.
void trace_scene(RTCScene scene, RayPacket& packet, const SceneContent& content) {
  alignas(32) RTCRayHit8 hits;
  alignas(32) int valid[kPacket];
  std::copy_n(packet.origin_x, kPacket, hits.ray.org_x);
  std::copy_n(packet.origin_y, kPacket, hits.ray.org_y);
  std::copy_n(packet.origin_z, kPacket, hits.ray.org_z);
  std::copy_n(packet.direction_x, kPacket, hits.ray.dir_x);
  std::copy_n(packet.direction_y, kPacket, hits.ray.dir_y);
  std::copy_n(packet.direction_z, kPacket, hits.ray.dir_z);
  for (int lane = 0; lane < kPacket; ++lane) {
    valid[lane] = packet.far[lane] >= 0.0F ? -1 : 0;
    hits.ray.tnear[lane] = 0.0F;
    hits.ray.tfar[lane] = packet.far[lane];
    hits.ray.time[lane] = packet.time[lane];
    hits.ray.mask[lane] = ~0U;
    hits.ray.flags[lane] = 0;
    hits.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  intersect_similar_rays(valid, scene, hits);
  for (int lane = 0; lane < kPacket; ++lane) {
    if (valid[lane] == 0 || hits.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
    packet.far[lane] = hits.ray.tfar[lane];
    packet.u[lane] = hits.hit.u[lane];
    packet.v[lane] = hits.hit.v[lane];
    packet.primitive[lane] = static_cast<std::int32_t>(hits.hit.primID[lane]) +
                             (hits.hit.geomID[lane] == 0 ? 0 : content.quad_count);
    packet.moving[lane] = content.moving;
  }
}

}  // namespace

struct RayTracer::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  SceneContent content;
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

struct RayTracer::Movers::Scene {
  RTCScene scene = nullptr;
  ~Scene() { rtcReleaseScene(scene); }
};

RayTracer::RayTracer(const World& world) : scene_(std::make_unique<Scene>()) {
  scene_->device = rtcNewDevice("threads=1");
  if (scene_->device == nullptr)
    throw std::runtime_error("cannot create an Embree device; check the Embree installation");
  scene_->scene = world_scene(scene_->device, world);
  scene_->content.quad_count = static_cast<std::int32_t>(world.quads.size());
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;

void RayTracer::trace(RayPacket& packet) const { trace_scene(scene_->scene, packet, scene_->content); }

bool RayTracer::is_unoccluded(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  RTCRay ray{};
  const Eigen::Vector3f direction = to - from;
  ray.org_x = from.x(), ray.org_y = from.y(), ray.org_z = from.z();
  ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
  ray.tfar = 1.0F;
  ray.mask = ~0U;
  find_occlusion(scene_->scene, ray);
  return ray.tfar >= 0.0F;
}

RayTracer::Movers::Movers(const RayTracer& tracer, const MovingMesh& mesh)
    : scene_(std::make_unique<Scene>()) {
  STILLPOINT_CHECK(mesh.start.size() == mesh.end.size());
  RTCDevice device = tracer.scene_->device;
  scene_->scene = new_scene(device, RTC_BUILD_QUALITY_LOW);
  attach(scene_->scene, triangles_of(device, mesh), 0, RTC_BUILD_QUALITY_LOW);
  commit(device, scene_->scene);
}

RayTracer::Movers::~Movers() = default;
RayTracer::Movers::Movers(Movers&&) noexcept = default;

void RayTracer::Movers::trace(RayPacket& packet) const {
  trace_scene(scene_->scene, packet, {.moving = true});
}

}  // namespace stillpoint::synth
