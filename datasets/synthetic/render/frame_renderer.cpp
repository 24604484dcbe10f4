// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/frame_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <optional>

#include "datasets/synthetic/render/mover_tiles.h"
#include "datasets/synthetic/render/surface_tiles.h"

namespace stillpoint::synth {
namespace {

constexpr int kBlockColumns = 4;  // a packet covers a compact block of pixels for coherent rays
constexpr int kBlockRows = 2;
constexpr float kFar_m = 1000.0F;
/// Sample positions in the pixel [px]: the first in the center, the others spread; their mean is the center.
constexpr std::array<double, kLightSamples> kOffset_x{0.0, -0.45, 0.2, 0.25};
constexpr std::array<double, kLightSamples> kOffset_y{0.0, -0.05, 0.4, -0.35};
/// Sample times in units of the exposure time: mean 0, variance 1/12 as for a box shutter.
constexpr std::array<double, kLightSamples> kTimeOffsets{0.0, 0.0, -0.408, 0.408};
/// Number of the sample's time among all different ones, and the first sample of each time.
constexpr std::array<std::size_t, kLightSamples> kTimeOfSample{0, 0, 1, 2};
constexpr std::array<std::size_t, kSampleTimes> kSampleOfTime{0, 2, 3};
/// Added to the mip level before rounding down: averaging over the samples blends two levels (trilinear).
constexpr std::array<float, kLightSamples> kLevelDither{0.625F, 0.125F, 0.875F, 0.375F};
/// Each sample covers about half a pixel's width; a filter width of sqrt(1/2) px trades blur for aliasing.
constexpr float kLevelBias = -0.5F;

/// Ray time of a light sample.
float sample_time(const Exposure& exposure, std::size_t pose_row, std::size_t sample) {
  const auto offset = static_cast<float>(kTimeOffsets[sample]);
  return std::clamp(exposure.mid_times[pose_row] + offset * exposure.exposure_fraction_of_span, 0.0F, 1.0F);
}

struct View {
  Eigen::Matrix3f R_w_c;
  Eigen::Vector3f p_w;
};

View view_of(const Pose& T_w_c) { return {T_w_c.R().cast<float>(), T_w_c.p.cast<float>()}; }

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
  [[nodiscard]] std::size_t in_tile(int lane) const {
    return static_cast<std::size_t>(row_of(lane) % Tile::kRows * Tile::kColumns +
                                    column_of(lane) % Tile::kColumns);
  }
};

/// A light sample of each pixel of a tile.
struct FrameRenderer::LightSample {
  Tile tile;
  std::size_t number;
  TileRays rays;
  /// In camera coordinates, of length 1 along the optical axis. @param at pixel of the tile
  [[nodiscard]] Eigen::Vector3f ray(std::size_t at) const { return {rays.x[at], rays.y[at], 1.0F}; }
};

struct FrameRenderer::Job {
  const Exposure* exposure;
  const RayTracer::Movers* movers;
  std::vector<std::array<View, kLightSamples>> views;  // per row
  VisibleWorld visible;
  std::vector<MoverTiles> tiles;         // one, or one per light sample
  const SurfaceTiles* quads = nullptr;   // without, rays are traced
  const SurfaceTiles* moving = nullptr;  // without, nothing moves
  [[nodiscard]] bool may_show_movers(const Block& block, std::size_t sample) const {
    return movers != nullptr && tiles[std::min(sample, tiles.size() - 1)].is_marked(block.row, block.column);
  }
  [[nodiscard]] const View& view(int row, std::size_t sample) const {
    return views[views.size() == 1 ? 0 : static_cast<std::size_t>(row)][kSampleOfTime[kTimeOfSample[sample]]];
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
    if (i > 0 && kTimeOfSample[i] == kTimeOfSample[i - 1]) {
      tiles.push_back(tiles.back());
    } else {
      tiles.emplace_back(mesh, camera,
                         std::array{Instant{exposure.poses.front()[i], sample_time(exposure, 0, i)}});
    }
  }
  return tiles;
}

}  // namespace

double sample_time_offset(int index) { return kTimeOffsets[static_cast<std::size_t>(index)]; }

FrameRenderer::FrameRenderer(const World& world, const RayTracer& tracer, const Camera& camera)
    : world_(world), tracer_(tracer), camera_(camera) {
  for (std::size_t at = 0; at < kLightSamples; ++at) {
    for (int column = 0; column < camera.width + Tile::kColumns; ++column)
      column_x_[at].push_back(static_cast<float>((column + kOffset_x[at] - camera.cx) / camera.fx));
    for (int row = 0; row < camera.height + Tile::kRows; ++row)
      row_y_[at].push_back(static_cast<float>((row + kOffset_y[at] - camera.cy) / camera.fy));
  }
  for (std::size_t at = 0; camera.has_distortion() && at < kLightSamples; ++at) {
    const Eigen::Vector2d offset(kOffset_x[at], kOffset_y[at]);
    for (int row = 0; row < camera.height; ++row) {
      for (int column = 0; column < camera.width; ++column) {
        directions_[at].push_back(camera.unproject(Eigen::Vector2d(column, row) + offset).cast<float>());
      }
    }
  }
}

const RenderedFrame& FrameRenderer::render(const Exposure& exposure, const MoverFrame* movers,
                                           RenderBuffers& buffers) const {
  Job job{&exposure, nullptr, {}, {&world_, movers}, {}};
  for (const std::array<Pose, kLightSamples>& poses : exposure.poses) {
    std::array<View, kLightSamples> views;
    std::transform(poses.begin(), poses.end(), views.begin(), view_of);
    job.views.push_back(views);
  }
  const bool has_movers = movers != nullptr && !movers->mesh.triangles.empty();
  if (has_movers) job.visible.vertex_light.assign(movers->mesh.start.size(), -1.0F);
  std::optional<RayTracer::Movers> mover_scene;
  if (exposure.poses.size() == 1 && !camera_.has_distortion() && world_.mesh.triangles.empty()) {
    see_surfaces(exposure, has_movers ? &movers->mesh : nullptr, buffers);
    job.quads = &buffers.quads;
    if (has_movers) job.moving = &buffers.moving;
  } else if (has_movers) {
    mover_scene.emplace(tracer_, movers->mesh);
    job.movers = &*mover_scene;
    job.tiles = mover_tiles(exposure, movers->mesh, camera_);
  }
  RenderedFrame& frame = buffers.frame;
  frame.width = camera_.width, frame.height = camera_.height;
  const auto pixels = static_cast<std::size_t>(std::ptrdiff_t{camera_.width} * camera_.height);
  frame.radiance.resize(pixels);
  frame.depth_m.resize(pixels);
  frame.object.assign(pixels, 0);
  frame.speed_m_per_s.assign(pixels, 0.0F);
  for (int row = 0; row < camera_.height; row += Tile::kRows) {
    for (int column = 0; column < camera_.width; column += Tile::kColumns)
      render_tile(job, {row, column}, frame);
  }
  return frame;
}

void FrameRenderer::see_surfaces(const Exposure& exposure, const MovingMesh* movers,
                                 RenderBuffers& buffers) const {
  SampleInstants instants;
  for (std::size_t time = 0; time < kSampleTimes; ++time) {
    const std::size_t sample = kSampleOfTime[time];
    instants[time] = {exposure.poses.front()[sample], sample_time(exposure, 0, sample)};
  }
  buffers.quads.see_quads(world_.quads, camera_, instants);
  if (movers != nullptr) buffers.moving.see_triangles(*movers, instants, buffers.quads);
}

template <class Function>
void FrameRenderer::for_each_pixel(const Tile& tile, Function&& function) const {
  const int rows = std::min(Tile::kRows, camera_.height - tile.row);
  const int columns = std::min(Tile::kColumns, camera_.width - tile.column);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      function(static_cast<std::size_t>(row * Tile::kColumns + column), tile.row + row, tile.column + column);
  }
}

template <class Function>
void FrameRenderer::for_each_block(const Tile& tile, Function&& function) const {
  const int bottom = std::min(tile.row + Tile::kRows, camera_.height);
  const int right = std::min(tile.column + Tile::kColumns, camera_.width);
  for (int row = tile.row; row < bottom; row += kBlockRows) {
    for (int column = tile.column; column < right; column += kBlockColumns) function(Block{row, column});
  }
}

void FrameRenderer::render_tile(Job& job, const Tile& tile, RenderedFrame& frame) const {
  TileShading shading(job.visible);
  TileHits hits;
  for (std::size_t sample = 0; sample < kLightSamples; ++sample) {
    const LightSample at{tile, sample, rays_through(tile, sample)};
    find_surfaces(job, at, hits);
    if (sample == 0) record_geometry(job, tile, hits, frame);
    TileSample shown{.rays = at.rays,
                     .hits = hits,
                     .R_w_c = {},
                     .pixel_size = 1.0F / static_cast<float>(camera_.fx),
                     .level_bias = kLevelBias + kLevelDither[sample]};
    for (int row = 0; row < Tile::kRows; ++row) {
      shown.R_w_c[static_cast<std::size_t>(row)] =
          &job.view(std::min(tile.row + row, camera_.height - 1), sample).R_w_c;
    }
    shading.add(shown, 1.0F / kLightSamples);
  }
  for_each_pixel(tile, [&](std::size_t at, int row, int column) {
    frame.radiance[pixel_at(row, column)] = shading.light(at);
  });
}

TileRays FrameRenderer::rays_through(const Tile& tile, std::size_t sample) const {
  TileRays rays;
  if (directions_[sample].empty()) {
    for (std::size_t first = 0; first < Tile::kPixels; first += Tile::kColumns) {
      std::copy_n(column_x_[sample].begin() + tile.column, Tile::kColumns, rays.x.begin() + first);
      std::fill_n(rays.y.begin() + first, Tile::kColumns,
                  row_y_[sample][static_cast<std::size_t>(tile.row) + first / Tile::kColumns]);
    }
    return rays;
  }
  for (int at = 0; at < Tile::kPixels; ++at) {
    const int row = tile.row + at / Tile::kColumns, column = tile.column + at % Tile::kColumns;
    const Eigen::Vector2f& point =
        directions_[sample][pixel_at(std::min(row, camera_.height - 1), std::min(column, camera_.width - 1))];
    const auto i = static_cast<std::size_t>(at);
    rays.x[i] = point.x(), rays.y[i] = point.y();
  }
  return rays;
}

void FrameRenderer::find_surfaces(const Job& job, const LightSample& sample, TileHits& hits) const {
  hits.clear();
  if (job.quads != nullptr) {
    const SurfaceTiles::Query query{sample.tile, kTimeOfSample[sample.number], sample.rays};
    job.quads->find(query, hits);
    if (job.moving != nullptr) job.moving->find(query, hits);
    return;
  }
  hits.content = TileHits::Content::kAny;
  for_each_block(sample.tile, [&](const Block& block) {
    RayPacket packet = aim(job, block, sample);
    tracer_.trace(packet);
    if (job.may_show_movers(block, sample.number)) job.movers->trace(packet);
    store(packet, block, hits);
  });
}

RayPacket FrameRenderer::aim(const Job& job, const Block& block, const LightSample& sample) const {
  RayPacket packet;
  for (int lane = 0; lane < kPacket; ++lane) {
    const int row = std::min(block.row_of(lane), camera_.height - 1);
    const bool inside = row == block.row_of(lane) && block.column_of(lane) < camera_.width;
    const View& view = job.view(row, sample.number);
    const Eigen::Vector3f direction = view.R_w_c * sample.ray(block.in_tile(lane));
    packet.origin_x[lane] = view.p_w.x(), packet.direction_x[lane] = direction.x();
    packet.origin_y[lane] = view.p_w.y(), packet.direction_y[lane] = direction.y();
    packet.origin_z[lane] = view.p_w.z(), packet.direction_z[lane] = direction.z();
    const std::size_t pose_row = job.views.size() == 1 ? 0 : static_cast<std::size_t>(row);
    packet.time[lane] = sample_time(*job.exposure, pose_row, sample.number);
    packet.far[lane] = inside ? kFar_m : -1.0F;
    packet.primitive[lane] = -1;
    packet.moving[lane] = false;
  }
  return packet;
}

void FrameRenderer::store(const RayPacket& packet, const Block& block, TileHits& hits) {
  for (int lane = 0; lane < kPacket; ++lane) {
    if (packet.primitive[lane] < 0) continue;
    const std::size_t at = block.in_tile(lane);
    hits.inverse_z[at] = 1.0F / packet.far[lane];  // the ray has length 1 along the optical axis
    hits.u[at] = packet.u[lane];
    hits.v[at] = packet.v[lane];
    hits.surface[at] = packet.primitive[lane] | (packet.moving[lane] ? TileHits::kMoving : 0);
  }
}

void FrameRenderer::record_geometry(const Job& job, const Tile& tile, const TileHits& hits,
                                    RenderedFrame& frame) const {
  for_each_pixel(tile, [&](std::size_t at, int row, int column) {
    frame.depth_m[pixel_at(row, column)] = hits.surface[at] >= 0 ? 1.0F / hits.inverse_z[at] : 0.0F;
  });
  if (*std::ranges::max_element(hits.surface) < TileHits::kMoving) return;
  std::int32_t shown = -1;  // the last surface that moves
  float speed_m_per_s = 0.0F;
  std::uint16_t object = 0;
  for_each_pixel(tile, [&](std::size_t at, int row, int column) {
    const std::int32_t surface = hits.surface[at];
    if (surface < TileHits::kMoving) return;
    if (surface != shown) {
      const auto triangle = static_cast<std::size_t>(surface & ~TileHits::kMoving);
      const MoverFrame& movers = *job.visible.movers;
      object = static_cast<std::uint16_t>(movers.appearance[triangle].object);
      speed_m_per_s = displacement_m(movers.mesh, triangle) / job.exposure->span_s;
      shown = surface;
    }
    const std::size_t pixel = pixel_at(row, column);
    frame.object[pixel] = object;
    frame.speed_m_per_s[pixel] = speed_m_per_s;
  });
}

}  // namespace stillpoint::synth
