// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/surface_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace stillpoint::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kFar_m = 1000.0F;
constexpr float kSameDepth =
    1.0F - 1e-5F;                      // ratio; coincident surfaces differ by less, labels on boxes by more
constexpr float kSeam_m = 2e-5F;       // by which surfaces are larger, so that nothing shows between two
constexpr float kNearest_m = 1e-3F;    // surfaces are clipped here
constexpr float kDepthMargin = 1e-3F;  // relative; more than rounding errors of planes farther than
constexpr float kEdgeOn_m = 0.02F;     // this from the camera
constexpr float kMargin_px = 0.75F;    // light samples are up to 0.45 px beside the center of their pixel
constexpr int kLanes = 8;              // pixels that are tested together
constexpr float kFlat = 1e-12F;        // ratio of a squared area: a triangle without an inside

/// Convex polygon in normalized image coordinates; a parallelogram or triangle, clipped by one plane.
struct Polygon {
  std::array<Vector2f, 5> points;
  std::size_t count = 0;

  void add(const Vector3f& p_c) { points[count++] = p_c.head<2>() / p_c.z(); }
};

template <std::size_t kCorners>
Polygon clipped(const std::array<Vector3f, kCorners>& corners_c) {
  Polygon polygon;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const Vector3f &from = corners_c[i], &to = corners_c[(i + 1) % kCorners];
    if (from.z() >= kNearest_m) polygon.add(from);
    if ((from.z() >= kNearest_m) == (to.z() >= kNearest_m)) continue;
    Vector3f crossing = from + (kNearest_m - from.z()) / (to.z() - from.z()) * (to - from);
    crossing.z() = kNearest_m;
    polygon.add(crossing);
  }
  return polygon;
}

float signed_area(const Polygon& polygon) {
  float area = 0.0F;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vector2f &a = polygon.points[i], &b = polygon.points[(i + 1) % polygon.count];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

LinearForm edge_between(const Vector2f& from, const Vector2f& to, float orientation) {
  const Vector2f along = orientation * (to - from);
  return {-along.y(), along.x(), along.y() * from.x() - along.x() * from.y()};
}

LinearForm linear_form(const Vector3f& coefficients) {
  return {coefficients.x(), coefficients.y(), coefficients.z()};
}

/// See SeenSurface.
template <std::size_t kCorners>
SeenSurface seen_surface(const std::array<Vector3f, kCorners>& corners_c, std::int32_t surface) {
  const Vector3f& origin = corners_c[0];
  const Vector3f edge_u = corners_c[1] - origin, edge_v = corners_c[kCorners - 1] - origin;
  const Vector3f cross = edge_u.cross(edge_v);
  const Vector3f dual_u = edge_v.cross(cross) / cross.squaredNorm();
  const Vector3f dual_v = cross.cross(edge_u) / cross.squaredNorm();
  const Vector3f inverse_depth = cross / cross.dot(origin);
  const Vector3f u = dual_u - dual_u.dot(origin) * inverse_depth;
  const Vector3f v = dual_v - dual_v.dot(origin) * inverse_depth;
  const float seam_u = kSeam_m / edge_u.norm(), seam_v = kSeam_m / edge_v.norm();
  const Vector3f above_u = (1.0F + seam_u) * inverse_depth - u, above_v = (1.0F + seam_v) * inverse_depth - v;
  return {.inverse_depth = linear_form(inverse_depth),
          .u = linear_form(u),
          .v = linear_form(v),
          .inside = {linear_form(u + seam_u * inverse_depth), linear_form(v + seam_v * inverse_depth),
                     linear_form(kCorners == 3 ? Vector3f(above_u - v) : above_u),
                     linear_form(kCorners == 3 ? Vector3f(above_u - v) : above_v)},
          .surface = surface};
}

/// Eight pixels or tiles of a row.
using Floats = float __attribute__((vector_size(32)));
using Integers = std::int32_t __attribute__((vector_size(32)));

template <class Vector, class T>
Vector load(const T* from) {
  Vector values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

/// Smallest and largest values of a linear form in eight rectangles of a row.
struct Ranges {
  Floats smallest, largest;
  Ranges(const LinearForm& form, const Floats& low_x, const Floats& high_x, const Vector2f& low_high_y) {
    const Floats x_low = form.a * low_x, x_high = form.a * high_x;
    const auto [y_low, y_high] = std::minmax({form.b * low_high_y.x(), form.b * low_high_y.y()});
    smallest = (x_low < x_high ? x_low : x_high) + y_low + form.c;
    largest = (x_low < x_high ? x_high : x_low) + y_high + form.c;
  }
};

/// A linear form along a row.
struct AlongRow {
  float slope, first;
  AlongRow(const LinearForm& form, float y) : slope(form.a), first(form.b * y + form.c) {}
  float operator()(float x) const { return slope * x + first; }
};

/// A linear form at eight columns of a row.
struct AlongColumns {
  Floats at_y_0, slope;
  AlongColumns(const LinearForm& form, const Floats& x)
      : at_y_0(form.a * x + form.c), slope(Floats{} + form.b) {}
  Floats operator()(float y) const { return at_y_0 + slope * y; }
};

/// Rows of a tile, and the first of eight columns.
struct Window {
  int first_row, end_row, column;
};

/// The search for the nearest surfaces in a tile.
struct Search {
  const TileRays& rays;
  TileHits& hits;
  /// Number of the nearest surface so far; -1: none.
  alignas(64) std::array<std::int32_t, Tile::kPixels> seen;
};

/// Tests eight columns of a tile. What is linear in x is computed once for all rows.
void test(const SeenSurface& surface, std::int32_t number, const Window& window, Search& search) {
  const auto x = load<Floats>(search.rays.x.data() + window.column);
  float* const inverse_z = search.hits.inverse_z.data();
  std::int32_t* const seen = search.seen.data();
  const AlongColumns inverse_depth(surface.inverse_depth, x), side_0(surface.inside[0], x),
      side_1(surface.inside[1], x), side_2(surface.inside[2], x), side_3(surface.inside[3], x);
  for (int row = window.first_row; row < window.end_row; ++row) {
    const int first = row * Tile::kColumns + window.column;
    const float y = search.rays.y[static_cast<std::size_t>(first)];
    const Floats w = inverse_depth(y);
    const auto before = load<Floats>(inverse_z + first);
    const Integers is_hit = (side_0(y) >= 0.0F) & (side_1(y) >= 0.0F) & (side_2(y) >= 0.0F) &
                            (side_3(y) >= 0.0F) & (w * kSameDepth > before) & (w <= 1.0F / kNearest_m);
    const Floats nearest = is_hit ? w : before;
    const Integers shown = is_hit ? number : load<Integers>(seen + first);
    std::memcpy(inverse_z + first, &nearest, sizeof nearest);
    std::memcpy(seen + first, &shown, sizeof shown);
  }
}

/// Records what some pixels of a row show, for those that show a surface.
void record(const SeenSurface& surface, std::int32_t number, std::size_t first, Search& search) {
  const TileRays& rays = search.rays;
  TileHits& hits = search.hits;
  const AlongRow along_u(surface.u, rays.y[first]), along_v(surface.v, rays.y[first]);
  const std::int32_t* const seen = search.seen.data() + first;
  const float* const rays_x = rays.x.data() + first;
  const float* const inverse_z = hits.inverse_z.data() + first;
  float *const hit_u = hits.u.data() + first, *const hit_v = hits.v.data() + first;
  std::int32_t* const hit_surface = hits.surface.data() + first;
  const std::int32_t shown = surface.surface;
#pragma GCC unroll 1
#pragma GCC ivdep
  for (int i = 0; i < kLanes; ++i) {
    const float z = 1.0F / inverse_z[i];
    const float u = along_u(rays_x[i]) * z, v = along_v(rays_x[i]) * z;
    const bool is_shown = seen[i] == number;
    hit_u[i] = is_shown ? u : hit_u[i];
    hit_v[i] = is_shown ? v : hit_v[i];
    hit_surface[i] = is_shown ? shown : hit_surface[i];
  }
}

/// Records the only surface in a tile; by the operations of `test` and `record`, for equal rounding.
void show_one(const SeenSurface& surface, const TileRays& rays, TileHits& hits) {
  hits.content = TileHits::Content::kOneSurface;
  hits.surface.fill(surface.surface);
  for (std::size_t column = 0; column < Tile::kColumns; column += kLanes) {
    const auto x = load<Floats>(rays.x.data() + column);
    const AlongColumns inverse_depth(surface.inverse_depth, x);
    for (std::size_t first = column; first < Tile::kPixels; first += Tile::kColumns) {
      const float y = rays.y[first];
      const AlongRow along_u(surface.u, y), along_v(surface.v, y);
      const Floats inverse_z = inverse_depth(y), z = 1.0F / inverse_z;
      const Floats u = (along_u.slope * x + along_u.first) * z, v = (along_v.slope * x + along_v.first) * z;
      std::memcpy(hits.inverse_z.data() + first, &inverse_z, sizeof inverse_z);
      std::memcpy(hits.u.data() + first, &u, sizeof u);
      std::memcpy(hits.v.data() + first, &v, sizeof v);
    }
  }
}

/// Camera coordinates of points in the world.
struct ToCamera {
  Eigen::Matrix3f R_c_w;
  Vector3f center;

  explicit ToCamera(const Pose& T_w_c)
      : R_c_w(T_w_c.R().transpose().cast<float>()), center(T_w_c.p.cast<float>()) {}
  Vector3f operator()(const Vector3f& point) const { return R_c_w * (point - center); }
};

}  // namespace

void TileHits::clear() {
  content = Content::kNothing;
  inverse_z.fill(1.0F / kFar_m);
  surface.fill(-1);
}

/// A surface in the image: pixels that contain it, and its edges.
struct SurfaceTiles::Outline {
  std::array<LinearForm, 5> edges{};  ///< positive inside
  std::size_t edge_count = 0;
  int left, right, top, bottom;

  Outline(const Polygon& polygon, const Camera& camera) : edge_count(polygon.count) {
    Vector2f low = polygon.points[0], high = low;
    const float orientation = signed_area(polygon) >= 0.0F ? 1.0F : -1.0F;
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const Vector2f& point = polygon.points[i];
      low = low.cwiseMin(point), high = high.cwiseMax(point);
      edges[i] = edge_between(point, polygon.points[(i + 1) % polygon.count], orientation);
    }
    const auto pixel = [](double center, int size) {
      return static_cast<int>(std::clamp(std::floor(center), -1.0, static_cast<double>(size)));
    };
    left = std::max(0, pixel(low.x() * camera.fx + camera.cx - kMargin_px, camera.width));
    right =
        std::min(camera.width - 1, pixel(high.x() * camera.fx + camera.cx + kMargin_px + 1, camera.width));
    top = std::max(0, pixel(low.y() * camera.fy + camera.cy - kMargin_px, camera.height));
    bottom =
        std::min(camera.height - 1, pixel(high.y() * camera.fy + camera.cy + kMargin_px + 1, camera.height));
  }
  [[nodiscard]] bool is_visible() const { return left <= right && top <= bottom; }
};

void SurfaceTiles::begin(const Camera& camera) {
  camera_ = camera;
  columns_ = (camera.width + Tile::kColumns - 1) / Tile::kColumns;
  rows_ = (camera.height + Tile::kRows - 1) / Tile::kRows;
  left_ = static_cast<float>((camera.cx + 1.0) / camera.fx);
  right_ = static_cast<float>((camera.width - camera.cx) / camera.fx);
  top_ = static_cast<float>((camera.cy + 1.0) / camera.fy);
  bottom_ = static_cast<float>((camera.height - camera.cy) / camera.fy);
  seen_.clear(), entries_.clear();
  const auto fx = static_cast<float>(camera.fx), cx = static_cast<float>(camera.cx);
  low_x_.assign(static_cast<std::size_t>(columns_ + kLanes), 0.0F), high_x_ = low_x_;
  for (int column = 0; column < columns_; ++column) {
    const auto x = static_cast<float>(column * Tile::kColumns);
    low_x_[static_cast<std::size_t>(column)] = (x - kMargin_px - cx) / fx;
    high_x_[static_cast<std::size_t>(column)] = (x + Tile::kColumns - 1 + kMargin_px - cx) / fx;
  }
}

void SurfaceTiles::see_quads(std::span<const Quad> quads, const Camera& camera, const Pose& T_w_c) {
  begin(camera);
  covered_.assign(static_cast<std::size_t>(columns_ * rows_ + kLanes), 0.0F);
  const ToCamera to_camera(T_w_c);
  for (std::size_t i = 0; i < quads.size(); ++i) {
    if (quads[i].one_sided && quads[i].normal.dot(to_camera.center - quads[i].origin) <= 0.0F) continue;
    const Vector3f origin = to_camera(quads[i].origin);
    const Vector3f edge_u = to_camera.R_c_w * quads[i].edge_u, edge_v = to_camera.R_c_w * quads[i].edge_v;
    add(std::array<Vector3f, 4>{origin, origin + edge_u, origin + edge_u + edge_v, origin + edge_v},
        static_cast<std::int32_t>(i));
  }
  sort_entries();
}

void SurfaceTiles::see_triangles(const MovingMesh& mesh, float time, const Pose& T_w_c,
                                 const SurfaceTiles& before) {
  begin(before.camera_);
  covered_ = before.covered_;
  const ToCamera to_camera(T_w_c);
  points_c_.resize(mesh.start.size());
  for (std::size_t i = 0; i < points_c_.size(); ++i)
    points_c_[i] = to_camera(mesh.start[i] + time * (mesh.end[i] - mesh.start[i]));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Vector3f &at_a = points_c_[a], &at_b = points_c_[b], &at_c = points_c_[c];
    if ((at_b - at_a).cross(at_c - at_a).dot(at_a) >= 0.0F) continue;  // its back
    add(std::array{at_a, at_b, at_c}, TileHits::kMoving | static_cast<std::int32_t>(i));
  }
  sort_entries();
}

template <std::size_t kCorners>
void SurfaceTiles::add(const std::array<Vector3f, kCorners>& corners_c, std::int32_t surface) {
  const auto beyond = [&](float x, float y, float z) {
    return std::ranges::all_of(corners_c, [&](const Vector3f& p) { return p.dot(Vector3f(x, y, z)) < 0.0F; });
  };
  if (beyond(1, 0, left_) || beyond(-1, 0, right_) || beyond(0, 1, top_) || beyond(0, -1, bottom_)) return;
  const Polygon polygon = clipped(corners_c);
  if (polygon.count < 3) return;
  const Outline outline(polygon, camera_);
  const Vector3f edge_u = corners_c[1] - corners_c[0], edge_v = corners_c[kCorners - 1] - corners_c[0];
  const float area = edge_u.cross(edge_v).squaredNorm();
  if (!outline.is_visible() || area <= kFlat * edge_u.squaredNorm() * edge_v.squaredNorm()) return;
  const SeenSurface seen = seen_surface(corners_c, surface);
  add_to_tiles(outline, seen);
  seen_.push_back(seen);
}

void SurfaceTiles::add_to_tiles(const Outline& outline, const SeenSurface& seen) {
  const LinearForm& inverse_depth = seen.inverse_depth;
  const float inverse_height = Vector3f(inverse_depth.a, inverse_depth.b, inverse_depth.c).norm();
  const bool edge_on = !(inverse_height * kEdgeOn_m <= 1.0F);  // the inverse depth is not known well
  for (int row = outline.top / Tile::kRows; row <= outline.bottom / Tile::kRows; ++row)
    add_to_row(row, outline, seen, edge_on);
}

void SurfaceTiles::add_to_row(int row, const Outline& outline, const SeenSurface& seen, bool edge_on) {
  const auto fy = static_cast<float>(camera_.fy), cy = static_cast<float>(camera_.cy);
  const auto y = static_cast<float>(row * Tile::kRows);
  const Vector2f low_high_y((y - kMargin_px - cy) / fy, (y + Tile::kRows - 1 + kMargin_px - cy) / fy);
  const int last = outline.right / Tile::kColumns;
  for (int first = outline.left / Tile::kColumns; first <= last; first += kLanes) {
    const auto low_x = load<Floats>(low_x_.data() + first), high_x = load<Floats>(high_x_.data() + first);
    const int first_tile = row * columns_ + first;
    const Ranges depths(seen.inverse_depth, low_x, high_x, low_high_y);
    Integers covers = Integers{} - (edge_on ? 0 : 1);
    Integers seen_in = ~covers | (depths.largest >= load<Floats>(covered_.data() + first_tile));
    for (std::size_t i = 0; i < outline.edge_count; ++i) {
      const Ranges distances(outline.edges[i], low_x, high_x, low_high_y);
      covers &= distances.smallest > 0.0F;
      seen_in &= distances.largest >= 0.0F;
    }
    for (int lane = 0; lane < std::min(kLanes, last + 1 - first); ++lane) {
      if (seen_in[lane] == 0) continue;
      const float nearest = edge_on ? std::numeric_limits<float>::infinity() : depths.largest[lane];
      const auto tile = static_cast<std::uint32_t>(first_tile + lane);
      add_to_tile({row * Tile::kRows, (first + lane) * Tile::kColumns}, outline,
                  {.tile = tile, .covers = covers[lane] != 0, .nearest = nearest});
      if (covers[lane] != 0)
        covered_[tile] = std::max(covered_[tile], depths.smallest[lane] * (1.0F - kDepthMargin));
    }
  }
}

/// Completes an entry.
void SurfaceTiles::add_to_tile(const Tile& tile, const Outline& outline, Entry entry) {
  entry.seen = static_cast<std::uint32_t>(seen_.size());
  entry.first_row = static_cast<std::uint8_t>(std::max(0, outline.top - tile.row));
  entry.end_row = static_cast<std::uint8_t>(std::min(Tile::kRows, outline.bottom + 1 - tile.row));
  entry.first_column = static_cast<std::uint8_t>(std::max(0, outline.left - tile.column));
  entry.end_column = static_cast<std::uint8_t>(std::min(Tile::kColumns, outline.right + 1 - tile.column));
  entries_.push_back(entry);
}

/// Sorts those that are not hidden.
void SurfaceTiles::sort_entries() {
  std::erase_if(entries_, [this](const Entry& entry) { return entry.nearest < covered_[entry.tile]; });
  const auto tiles = static_cast<std::size_t>(columns_ * rows_);
  first_.assign(tiles + 2, 0);
  for (const Entry& entry : entries_) ++first_[entry.tile + 2];
  for (std::size_t tile = 0; tile < tiles; ++tile) first_[tile + 2] += first_[tile + 1];
  sorted_.resize(entries_.size());
  for (const Entry& entry : entries_) sorted_[first_[entry.tile + 1]++] = entry;  // then the end of the tile
}

void SurfaceTiles::find(const Tile& tile, const TileRays& rays, TileHits& hits) const {
  const auto number =
      static_cast<std::size_t>(tile.row / Tile::kRows * columns_ + tile.column / Tile::kColumns);
  const std::size_t begin = first_[number], end = first_[number + 1];
  if (begin == end) return;
  const SeenSurface& only = seen_[sorted_[begin].seen];
  const bool is_moving = (only.surface & TileHits::kMoving) != 0;  // its light is not baked
  if (hits.content == TileHits::Content::kNothing && end == begin + 1 && sorted_[begin].covers && !is_moving)
    return show_one(only, rays, hits);
  hits.content = TileHits::Content::kAny;
  Search search{.rays = rays, .hits = hits, .seen = {}};
  search.seen.fill(-1);
  for (std::size_t i = begin; i < end; ++i) {
    const Entry& entry = sorted_[i];
    for (int column = entry.first_column / kLanes * kLanes; column < entry.end_column; column += kLanes) {
      test(seen_[entry.seen], static_cast<std::int32_t>(entry.seen), {entry.first_row, entry.end_row, column},
           search);
    }
  }
  for (std::size_t first = 0; first < Tile::kPixels; first += kLanes) {
    std::int32_t recorded = -1;
    for (std::size_t at = first; at < first + kLanes; ++at) {
      const std::int32_t seen = search.seen[at];
      if (seen < 0 || seen == recorded) continue;
      recorded = seen;
      record(seen_[static_cast<std::size_t>(recorded)], recorded, first, search);
    }
  }
}

}  // namespace stillpoint::synth
