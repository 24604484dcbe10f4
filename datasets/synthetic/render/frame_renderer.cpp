// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/frame_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/render/mover_tiles.h"

namespace stillpoint::synth {
namespace {

constexpr int kBlockColumns = 4;  // a packet covers a compact block of pixels for coherent rays
constexpr int kBlockRows = 2;
constexpr float kFar_m = 1000.0F;
/// Sample positions in the pixel [px]: the first in the center, the others spread; their mean is the center.
constexpr std::array<double, kLightSamples> kOffset_x{0.0, -0.45, 0.2, 0.25};
constexpr std::array<double, kLightSamples> kOffset_y{0.0, -0.05, 0.4, -0.35};
/// Sample times in units of the exposure time: mean 0, variance 1/12 as for a box shutter.
constexpr std::array<double, kLightSamples> kSampleTimes{0.0, 0.0, -0.408, 0.408};
/// Added to the mip level before rounding down: averaging over the samples blends two levels (trilinear).
constexpr std::array<float, kLightSamples> kLevelDither{0.625F, 0.125F, 0.875F, 0.375F};
/// Each sample covers about half a pixel's width; a filter width of sqrt(1/2) px trades blur for aliasing.
constexpr float kLevelBias = -0.5F;

/// log2 from the exponent and a linear approximation of the mantissa; error < 0.09.
float approximate_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float exponent = static_cast<float>(static_cast<int>(bits >> 23) - 127);
  return exponent + static_cast<float>(bits & 0x7fffffU) * 0x1.0p-23F;
}

/// Ray time of a light sample.
float sample_time(const Exposure& exposure, std::size_t pose_row, std::size_t sample) {
  const auto offset = static_cast<float>(kSampleTimes[sample]);
  return std::clamp(exposure.mid_times[pose_row] + offset * exposure.exposure_fraction_of_span, 0.0F, 1.0F);
}

struct View {
  Eigen::Matrix3f R_w_c;
  Eigen::Vector3f p_w;
};

View view_of(const Pose& T_w_c) { return {T_w_c.R().cast<float>(), T_w_c.p.cast<float>()}; }

Eigen::Vector3f normal_of(const StaticMesh& mesh, const MeshTriangle& triangle) {
  const Eigen::Vector3f& corner = mesh.vertices[triangle.corners[0]];
  const Eigen::Vector3f first = mesh.vertices[triangle.corners[1]] - corner;
  return first.cross(mesh.vertices[triangle.corners[2]] - corner).normalized();
}

/// The texels whose bilinear interpolation is that of the corners' colors, see MeshTriangle::colors.
Texture::Cell corner_colors(const MeshTriangle& triangle, float u, float v) {
  return {.upper = triangle.colors.data(),
          .lower = triangle.colors.data() + 2,
          .column = 0,
          .next_column = 1,
          .weight_x = u / std::max(1.0F - v, 1e-6F),
          .weight_y = v};
}

/// Displacement of the triangle's centroid over the motion interval [m].
float displacement_m(const MovingMesh& mesh, std::size_t triangle) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const std::uint32_t corner : mesh.triangles[triangle]) sum += mesh.end[corner] - mesh.start[corner];
  return sum.norm() / 3.0F;
}

}  // namespace

/// The pixels of one packet; lanes outside the image are inactive.
struct FrameRenderer::Block {
  int row, column;
  [[nodiscard]] int row_of(int lane) const { return row + lane / kBlockColumns; }
  [[nodiscard]] int column_of(int lane) const { return column + lane % kBlockColumns; }
};

/// Where a ray hits: texels, and irradiance.
struct FrameRenderer::SurfacePoint {
  Texture::Cell texels;
  float light;
};

struct FrameRenderer::Job {
  const Exposure* exposure;
  const MoverFrame* mover_frame;
  const RayTracer::Movers* movers;
  std::vector<std::array<View, kLightSamples>> views;  // per row
  std::vector<float> vertex_light;
  std::vector<MoverTiles> tiles;  // one, or one per light sample
  [[nodiscard]] bool may_show_movers(const Block& block, std::size_t sample) const {
    return movers != nullptr && tiles[std::min(sample, tiles.size() - 1)].is_marked(block.row, block.column);
  }
};

namespace {

/// Where each light sample may show movers; with a rolling shutter, where any may.
std::vector<MoverTiles> mover_tiles(const Exposure& exposure, const MovingMesh& mesh, const Camera& camera) {
  if (exposure.poses.size() > 1) {
    const Pose &first = exposure.poses.front().front(), &last = exposure.poses.back().back();
    const std::array<Instant, 4> between{{{first, 0.0F}, {first, 1.0F}, {last, 0.0F}, {last, 1.0F}}};
    return {MoverTiles(mesh, camera, between)};
  }
  std::vector<MoverTiles> tiles;
  for (std::size_t i = 0; i < kLightSamples; ++i) {
    if (i > 0 && kSampleTimes[i] == kSampleTimes[i - 1]) {
      tiles.push_back(tiles.back());
    } else {
      tiles.emplace_back(mesh, camera,
                         std::array{Instant{exposure.poses.front()[i], sample_time(exposure, 0, i)}});
    }
  }
  return tiles;
}

}  // namespace

double sample_time_offset(int index) { return kSampleTimes[static_cast<std::size_t>(index)]; }

FrameRenderer::FrameRenderer(const World& world, const RayTracer& tracer, const Camera& camera)
    : world_(world), tracer_(tracer), camera_(camera) {
  for (std::size_t at = 0; at < kLightSamples; ++at) {
    const Eigen::Vector2d offset(kOffset_x[at], kOffset_y[at]);
    for (int row = 0; row < camera.height; ++row) {
      for (int column = 0; column < camera.width; ++column) {
        directions_[at].push_back(camera.unproject(Eigen::Vector2d(column, row) + offset).cast<float>());
      }
    }
  }
}

RenderedFrame FrameRenderer::render(const Exposure& exposure, const MoverFrame* movers) const {
  Job job{&exposure, movers, nullptr, {}, {}, {}};
  for (const std::array<Pose, kLightSamples>& poses : exposure.poses) {
    std::array<View, kLightSamples> views;
    std::transform(poses.begin(), poses.end(), views.begin(), view_of);
    job.views.push_back(views);
  }
  std::optional<RayTracer::Movers> mover_scene;
  if (movers != nullptr && !movers->mesh.triangles.empty()) {
    mover_scene.emplace(tracer_, movers->mesh);
    job.movers = &*mover_scene;
    job.tiles = mover_tiles(exposure, movers->mesh, camera_);
    for (std::size_t i = 0; i < movers->mesh.start.size(); ++i) {
      job.vertex_light.push_back(unshadowed_light(world_, movers->mesh.start[i], movers->normals[i]));
    }
  }
  const auto pixels = static_cast<std::size_t>(std::ptrdiff_t{camera_.width} * camera_.height);
  RenderedFrame frame{camera_.width,
                      camera_.height,
                      std::vector<Float4>(pixels),
                      std::vector<float>(pixels),
                      std::vector<std::uint16_t>(pixels),
                      std::vector<float>(pixels)};
  for (int row = 0; row < camera_.height; row += kBlockRows) {
    for (int column = 0; column < camera_.width; column += kBlockColumns)
      render_block(job, row, column, frame);
  }
  return frame;
}

RayPacket FrameRenderer::aim(const Job& job, const Block& block, int sample) const {
  RayPacket packet;
  const std::vector<Eigen::Vector2f>& table = directions_[static_cast<std::size_t>(sample)];
  for (int lane = 0; lane < kPacket; ++lane) {
    const int row = std::min(block.row_of(lane), camera_.height - 1);
    const int column = std::min(block.column_of(lane), camera_.width - 1);
    const bool inside = row == block.row_of(lane) && column == block.column_of(lane);
    const std::size_t pose_row = job.views.size() == 1 ? 0 : static_cast<std::size_t>(row);
    const View& view = job.views[pose_row][static_cast<std::size_t>(sample)];
    const Eigen::Vector2f& point =
        table[static_cast<std::size_t>(std::ptrdiff_t{row} * camera_.width + column)];
    const Eigen::Vector3f direction = view.R_w_c * Eigen::Vector3f(point.x(), point.y(), 1.0F);
    packet.origin_x[lane] = view.p_w.x(), packet.direction_x[lane] = direction.x();
    packet.origin_y[lane] = view.p_w.y(), packet.direction_y[lane] = direction.y();
    packet.origin_z[lane] = view.p_w.z(), packet.direction_z[lane] = direction.z();
    packet.time[lane] = sample_time(*job.exposure, pose_row, static_cast<std::size_t>(sample));
    packet.far[lane] = inside ? kFar_m : -1.0F;
    packet.primitive[lane] = -1;
    packet.moving[lane] = false;
  }
  return packet;
}

inline FrameRenderer::SurfacePoint FrameRenderer::surface_at(const Job& job, const RayPacket& packet,
                                                             int lane, int sample) const {
  const Eigen::Vector3f direction(packet.direction_x[lane], packet.direction_y[lane],
                                  packet.direction_z[lane]);
  const float u = packet.u[lane], v = packet.v[lane];
  const auto primitive = static_cast<std::size_t>(packet.primitive[lane]);
  // Footprint of half a pixel at the hit, stretched by the slant of the surface (geometric mean).
  const float pixel_m = packet.far[lane] / static_cast<float>(camera_.fx);
  const auto level_of = [&](float texels_per_m, const Eigen::Vector3f& normal) {
    const float cosine = std::max(std::abs(normal.dot(direction)) / direction.norm(), 0.05F);
    const float level =
        approximate_log2(pixel_m * texels_per_m) - 0.5F * approximate_log2(cosine) + kLevelBias;
    return std::max(0.0F, level + kLevelDither[static_cast<std::size_t>(sample)]);
  };
  if (!packet.moving[lane] && primitive >= world_.quads.size()) {
    const MeshTriangle& triangle = world_.mesh.triangles[primitive - world_.quads.size()];
    if (triangle.texture < 0) return {corner_colors(triangle, u, v), 1.0F};
    const float w = 1.0F - u - v;
    const Eigen::Vector2f st = w * triangle.uv[0] + u * triangle.uv[1] + v * triangle.uv[2];
    return {world_.textures[static_cast<std::size_t>(triangle.texture)].cell_at(
                st.x(), st.y(), level_of(triangle.texels_per_m, normal_of(world_.mesh, triangle))),
            1.0F};
  }
  if (!packet.moving[lane]) {
    const Quad& quad = world_.quads[primitive];
    return {
        world_.textures[static_cast<std::size_t>(quad.texture)].cell_at(
            quad.s + u * quad.s_per_u, quad.t + v * quad.t_per_v, level_of(quad.texels_per_m, quad.normal)),
        baked_light(world_, quad, u, v)};
  }
  const MoverTriangle& appearance = job.mover_frame->appearance[primitive];
  const std::array<std::uint32_t, 3>& corners = job.mover_frame->mesh.triangles[primitive];
  const float w = 1.0F - u - v;
  const auto blend = [&](const auto& values) {
    using Value = std::decay_t<decltype(values[0])>;
    return Value(w * values[corners[0]] + u * values[corners[1]] + v * values[corners[2]]);
  };
  const Eigen::Vector3f normal = blend(job.mover_frame->normals).normalized();
  const Eigen::Vector2f st = w * appearance.uv[0] + u * appearance.uv[1] + v * appearance.uv[2];
  return {world_.textures[static_cast<std::size_t>(appearance.texture)].cell_at(
              st.x(), st.y(), level_of(appearance.texels_per_m, normal)),
          blend(job.vertex_light)};
}

void FrameRenderer::render_block(const Job& job, int block_row, int block_column,
                                 RenderedFrame& frame) const {
  const Block block{block_row, block_column};
  // All texels are requested from memory before the first one is used.
  std::array<std::array<SurfacePoint, kPacket>, kLightSamples> points;
  std::array<std::uint32_t, kLightSamples> hits{};
  for (int sample = 0; sample < kLightSamples; ++sample) {
    RayPacket packet = aim(job, block, sample);
    tracer_.trace(packet);
    if (job.may_show_movers(block, static_cast<std::size_t>(sample))) job.movers->trace(packet);
    const auto at = static_cast<std::size_t>(sample);
    for (int lane = 0; lane < kPacket; ++lane) {
      if (packet.primitive[lane] < 0) continue;
      hits[at] |= 1U << lane;
      SurfacePoint& point = points[at][static_cast<std::size_t>(lane)];
      point = surface_at(job, packet, lane, sample);
      __builtin_prefetch(point.texels.upper + point.texels.column);
      __builtin_prefetch(point.texels.lower + point.texels.column);
    }
    if (sample == 0) record_geometry(job, block, packet, frame);
  }
  std::array<Float4, kPacket> light{};
  for (std::size_t sample = 0; sample < kLightSamples; ++sample) {
    for (std::size_t lane = 0; lane < kPacket; ++lane) {
      if ((hits[sample] >> lane & 1U) == 0) continue;
      const SurfacePoint& point = points[sample][lane];
      const Float4 root = point.texels.value();
      light[lane] += root * root * point.light * (1.0F / kLightSamples);
    }
  }
  for (int lane = 0; lane < kPacket; ++lane) {
    const int row = block.row_of(lane), column = block.column_of(lane);
    if (row >= camera_.height || column >= camera_.width) continue;
    frame.radiance[static_cast<std::size_t>(std::ptrdiff_t{row} * camera_.width + column)] =
        light[static_cast<std::size_t>(lane)];
  }
}

void FrameRenderer::record_geometry(const Job& job, const Block& block, const RayPacket& packet,
                                    RenderedFrame& frame) const {
  for (int lane = 0; lane < kPacket; ++lane) {
    const int row = block.row_of(lane), column = block.column_of(lane);
    if (packet.primitive[lane] < 0 || row >= camera_.height || column >= camera_.width) continue;
    const auto pixel = static_cast<std::size_t>(std::ptrdiff_t{row} * camera_.width + column);
    const auto primitive = static_cast<std::size_t>(packet.primitive[lane]);
    frame.depth_m[pixel] = packet.far[lane];  // the direction has length 1 along the optical axis
    if (!packet.moving[lane]) continue;
    frame.object[pixel] = static_cast<std::uint16_t>(job.mover_frame->appearance[primitive].object);
    frame.speed_m_per_s[pixel] = displacement_m(job.mover_frame->mesh, primitive) / job.exposure->span_s;
  }
}

}  // namespace stillpoint::synth
