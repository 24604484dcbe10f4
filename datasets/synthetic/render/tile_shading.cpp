// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/tile_shading.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "datasets/synthetic/render/lightmap.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// log2 from the exponent and a linear approximation of the mantissa; error < 0.09.
float approximate_log2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return static_cast<float>((bits >> 23) - 127) + static_cast<float>(bits & 0x7fffff) * 0x1.0p-23F;
}

Vector3f normal_of(const StaticMesh& mesh, const MeshTriangle& triangle) {
  const Vector3f& corner = mesh.vertices[triangle.corners[0]];
  const Vector3f first = mesh.vertices[triangle.corners[1]] - corner;
  return first.cross(mesh.vertices[triangle.corners[2]] - corner);
}

/// Which of some pixels show a surface, as bits.
std::uint32_t lanes_of(std::int32_t surface, const std::int32_t* surfaces) {
  return lanes_where(load<Integers>(surfaces) == surface);
}

}  // namespace

/// Of a triangle.
std::array<TileShading::Linear<float>, 2> TileShading::texture_coordinates(
    const std::array<Vector2f, 3>& uv) {
  return {Linear<float>::through(uv[0].x(), uv[1].x(), uv[2].x()),
          Linear<float>::through(uv[0].y(), uv[1].y(), uv[2].y())};
}

float VisibleWorld::light(std::uint32_t vertex) {
  float& light = vertex_light[vertex];
  if (light < 0.0F) light = unshadowed_light(*world, movers->mesh.start[vertex], movers->normals[vertex]);
  return light;
}

const TileShading::Appearance& TileShading::appearance(std::int32_t surface, const Eigen::Matrix3f* R_w_c) {
  Appearance& kept = appearances_[static_cast<std::size_t>(surface) % kKept];
  if (kept.surface == surface && kept.R_w_c == R_w_c) return kept;
  kept = new_appearance(surface, *R_w_c);
  kept.surface = surface, kept.R_w_c = R_w_c;
  return kept;
}

TileShading::Appearance TileShading::new_appearance(std::int32_t surface, const Eigen::Matrix3f& R_w_c) {
  const World& world = *visible_.world;
  const auto number = static_cast<std::size_t>(surface & ~TileHits::kMoving);
  Appearance shown;
  if ((surface & TileHits::kMoving) != 0) {
    shown = mover_appearance(number);
  } else if (number < world.quads.size()) {
    const Quad& quad = world.quads[number];
    shown = {.normal = {quad.normal, Vector3f::Zero(), Vector3f::Zero()},
             .s = {quad.s, quad.s_per_u, 0.0F},
             .t = {quad.t, 0.0F, quad.t_per_v},
             .baked = &quad,
             .texture = quad.texture,
             .texels_per_m = quad.texels_per_m};
  } else {
    const MeshTriangle& triangle = world.mesh.triangles[number - world.quads.size()];
    const auto [s, t] = texture_coordinates(triangle.uv);
    shown = {.normal = {normal_of(world.mesh, triangle), Vector3f::Zero(), Vector3f::Zero()},
             .s = s,
             .t = t,
             .irradiance = {1.0F, 0.0F, 0.0F},
             .texture = triangle.texture,
             .texels_per_m = triangle.texels_per_m};
  }
  const Eigen::Matrix3f R_c_w = R_w_c.transpose();
  shown.normal.a = R_c_w * shown.normal.a;
  if ((surface & TileHits::kMoving) != 0)
    shown.normal.b = R_c_w * shown.normal.b, shown.normal.c = R_c_w * shown.normal.c;
  if (shown.texture >= 0)
    shown.highest_level = world.textures[static_cast<std::size_t>(shown.texture)].highest_level();
  return shown;
}

TileShading::Appearance TileShading::mover_appearance(std::size_t triangle) {
  const MoverTriangle& material = visible_.movers->appearance[triangle];
  const auto& [a, b, c] = visible_.movers->mesh.triangles[triangle];
  const std::vector<Vector3f>& normals = visible_.movers->normals;
  const auto [s, t] = texture_coordinates(material.uv);
  return {.normal = Linear<Vector3f>::through(normals[a], normals[b], normals[c]),
          .s = s,
          .t = t,
          .irradiance = Linear<float>::through(visible_.light(a), visible_.light(b), visible_.light(c)),
          .texture = material.texture,
          .texels_per_m = material.texels_per_m};
}

void TileShading::add(const TileSample& sample, float weight) {
  if (sample.hits.content == TileHits::Content::kOneSurface) {
    show_texels_of_one(sample);
  } else {
    find_texels(sample);
    find_mips();
  }
  read_texels(sample.hits);
  blend(weight);
}

void TileShading::find_texels(const TileSample& sample) {
  s_.fill(0.0F), t_.fill(0.0F);
  texture_.fill(-1), level_.fill(0);
  for (std::size_t first = 0; first < Tile::kPixels; first += kLanes) {
    const std::int32_t* const surfaces = sample.hits.surface.data() + first;
    std::uint32_t left = kAllLanes & ~lanes_of(-1, surfaces);
    while (left != 0) {
      const std::int32_t surface = surfaces[std::countr_zero(left)];
      const Appearance& shown = appearance(surface, sample.R_w_c[first / Tile::kColumns]);
      find_texels<kLanes>(shown, first, sample);
      light_up(shown, first, sample.hits);
      left &= ~lanes_of(surface, surfaces);
    }
  }
}

/// As `find_texels` and `find_mips`, of a tile that shows one surface.
void TileShading::show_texels_of_one(const TileSample& sample) {
  const Appearance& shown = appearance(sample.hits.surface[0], sample.R_w_c[0]);
  texture_.fill(shown.texture);
  find_texels<Tile::kPixels>(shown, 0, sample);
  light_up_all(shown, sample.hits);
  std::int32_t differing = 0;
  for (const std::int32_t level : level_) differing |= level ^ level_[0];
  if (differing != 0 || shown.texture < 0) return find_mips();
  const Texture::Level mip =
      visible_.world->textures[static_cast<std::size_t>(shown.texture)].level(level_[0]);
  mip_.fill(mip.texels), columns_.fill(mip.width), rows_.fill(mip.height);
}

/// Mip levels: the footprint of half a pixel at the hit, stretched by the slant of the surface (geometric
/// mean). @tparam kPixels all of a tile, or those of which some show the surface
template <std::size_t kPixels>
void TileShading::find_texels(const Appearance& shown, std::size_t first, const TileSample& sample) {
  const Linear<Vector3f> normal = shown.normal;
  const Linear<float> along_s = shown.s, along_t = shown.t;
  const float texels_per_depth = sample.pixel_size * shown.texels_per_m;
  const auto highest = static_cast<float>(shown.highest_level);
  const std::int32_t surface = shown.surface, texture = shown.texture;
  const float bias = sample.level_bias;
  const float *const rays_x = sample.rays.x.data() + first, *const rays_y = sample.rays.y.data() + first;
  const float *const inverse_z = sample.hits.inverse_z.data() + first,
                     *const hit_u = sample.hits.u.data() + first, *const hit_v = sample.hits.v.data() + first;
  const std::int32_t* const surfaces = sample.hits.surface.data() + first;
  float *const out_s = s_.data() + first, *const out_t = t_.data() + first;
  std::int32_t *const out_texture = texture_.data() + first, *const out_level = level_.data() + first;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kPixels; ++i) {
    const float x = rays_x[i], y = rays_y[i], u = hit_u[i], v = hit_v[i];
    const float n_x = normal.a.x() + u * normal.b.x() + v * normal.c.x();
    const float n_y = normal.a.y() + u * normal.b.y() + v * normal.c.y();
    const float n_z = normal.a.z() + u * normal.b.z() + v * normal.c.z();
    const float along = n_x * x + n_y * y + n_z;
    const float lengths = (n_x * n_x + n_y * n_y + n_z * n_z) * (x * x + y * y + 1.0F);
    const float cosine_squared = std::max(along * along / lengths, 0.0025F);
    const float size = texels_per_depth / inverse_z[i];
    const float level = approximate_log2(size) - 0.25F * approximate_log2(cosine_squared) + bias;
    const bool is_shown = kPixels == Tile::kPixels || surfaces[i] == surface;
    const float s = along_s.a + u * along_s.b + v * along_s.c, t = along_t.a + u * along_t.b + v * along_t.c;
    out_s[i] = is_shown ? s : out_s[i];
    out_t[i] = is_shown ? t : out_t[i];
    out_texture[i] = is_shown ? texture : out_texture[i];
    const auto whole_level = static_cast<std::int32_t>(std::clamp(level, 0.0F, highest));
    out_level[i] = is_shown ? whole_level : out_level[i];
  }
}

/// Keeps the irradiance of pixels that showed the same surface in the light sample before: it is smooth.
void TileShading::light_up(const Appearance& shown, std::size_t first, const TileHits& hits) {
  const std::uint32_t lit = lanes_of(shown.surface, lit_surface_.data() + first);
  if ((lanes_of(shown.surface, hits.surface.data() + first) & ~lit) == 0) return;
  one_is_lit_ = false;
  for (std::size_t at = first; at < first + kLanes; ++at) {
    if (hits.surface[at] != shown.surface || lit_surface_[at] == shown.surface) continue;
    const float u = hits.u[at], v = hits.v[at];
    irradiance_[at] = shown.baked != nullptr
                          ? baked_light(*visible_.world, *shown.baked, u, v)
                          : shown.irradiance.a + u * shown.irradiance.b + v * shown.irradiance.c;
    lit_surface_[at] = shown.surface;
  }
}

/// As `light_up`, of a tile that shows one surface whose light is baked.
void TileShading::light_up_all(const Appearance& shown, const TileHits& hits) {
  if (one_is_lit_ && lit_surface_[0] == shown.surface) return;
  PerPixel<std::int32_t> node;
  PerPixel<float> weight_x, weight_y;
  const Quad& quad = *shown.baked;
  for (std::size_t at = 0; at < Tile::kPixels; ++at) {
    const LightCell cell = light_cell(quad, hits.u[at], hits.v[at]);
    node[at] = cell.node, weight_x[at] = cell.weight_x, weight_y[at] = cell.weight_y;
  }
  for (std::size_t at = 0; at < Tile::kPixels; ++at)
    irradiance_[at] = light_in(*visible_.world, quad, {node[at], weight_x[at], weight_y[at]});
  lit_surface_.fill(shown.surface);
  one_is_lit_ = true;
}

void TileShading::find_mips() {
  static constexpr std::array<std::uint32_t, 2> kBlack{};
  Texture::Level mip{1, 1, kBlack.data()};
  std::int32_t texture = -1, level = 0;  // of `mip`
  const auto find = [&](std::size_t at, std::size_t count) {
    if (texture_[at] != texture || level_[at] != level) {
      texture = texture_[at], level = level_[at];
      mip = texture < 0 ? Texture::Level{1, 1, kBlack.data()}
                        : visible_.world->textures[static_cast<std::size_t>(texture)].level(level);
    }
    std::fill_n(mip_.begin() + at, count, mip.texels);
    std::fill_n(columns_.begin() + at, count, mip.width);
    std::fill_n(rows_.begin() + at, count, mip.height);
  };
  for (std::size_t first = 0; first < Tile::kPixels; first += kLanes) {
    const auto textures = load<Integers>(texture_.data() + first),
               levels = load<Integers>(level_.data() + first);
    if (lanes_where((textures == texture_[first]) & (levels == level_[first])) == kAllLanes) {
      find(first, kLanes);
    } else {
      for (std::size_t at = first; at < first + kLanes; ++at) find(at, 1);
    }
  }
}

void TileShading::read_texels(const TileHits& hits) {
  std::array<PerPixel<std::int32_t>, 2> index;
  for (std::size_t at = 0; at < Tile::kPixels; ++at) {
    const std::int32_t width = columns_[at], height = rows_[at];
    const float x = s_[at] * static_cast<float>(width) - 0.5F, y = t_[at] * static_cast<float>(height) - 0.5F;
    const float floor_x = std::floor(x), floor_y = std::floor(y);
    const std::int32_t column = static_cast<std::int32_t>(floor_x) & (width - 1);
    const auto row = static_cast<std::int32_t>(floor_y);
    index[0][at] = (row & (height - 1)) * (width + 1) + column;
    index[1][at] = ((row + 1) & (height - 1)) * (width + 1) + column;
    weight_x_[at] = x - floor_x, weight_y_[at] = y - floor_y;
  }
  for (std::size_t at = 0; at < Tile::kPixels; ++at) {
    for (std::size_t row = 0; row < 2; ++row)
      std::memcpy(&texels_[row][2 * at], mip_[at] + index[row][at], 2 * sizeof(std::uint32_t));
  }
  if (!visible_.world->mesh.triangles.empty()) read_corner_colors(hits);
}

/// Of triangles without a texture, see MeshTriangle::colors.
void TileShading::read_corner_colors(const TileHits& hits) {
  const World& world = *visible_.world;
  for (std::size_t at = 0; at < Tile::kPixels; ++at) {
    if (hits.surface[at] < 0 || texture_[at] >= 0) continue;
    const auto& colors =
        world.mesh.triangles[static_cast<std::size_t>(hits.surface[at]) - world.quads.size()].colors;
    for (std::size_t row = 0; row < 2; ++row)
      std::memcpy(&texels_[row][2 * at], &colors[2 * row], 2 * sizeof(std::uint32_t));
    weight_x_[at] = hits.u[at] / std::max(1.0F - hits.v[at], 1e-6F);
    weight_y_[at] = hits.v[at];
  }
}

/// Bilinear interpolation of square roots of reflectance, times the irradiance.
void TileShading::blend(float weight) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const int shift = 8 * static_cast<int>(channel);
    float* const light = light_[channel].data();
    for (std::size_t at = 0; at < Tile::kPixels; ++at) {
      const auto interpolated = [&](const std::array<std::uint32_t, 2 * Tile::kPixels>& texels) {
        const auto left = static_cast<float>(static_cast<std::int32_t>(texels[2 * at] >> shift & 0xffU));
        const auto right = static_cast<float>(static_cast<std::int32_t>(texels[2 * at + 1] >> shift & 0xffU));
        return left + (right - left) * weight_x_[at];
      };
      const float top = interpolated(texels_[0]), bottom = interpolated(texels_[1]);
      const float root = (top + (bottom - top) * weight_y_[at]) * (1.0F / 255.0F);
      light[at] += root * root * (irradiance_[at] * weight);
    }
  }
}

}  // namespace stillpoint::synth
