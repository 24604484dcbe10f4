// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/surface_tiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <utility>

namespace stillpoint::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kFar_m = 1000.0F;
constexpr float kSameDepth =
    1.0F - 1e-5F;                       // ratio; coincident surfaces differ by less, labels on boxes by more
constexpr float kSeam_m = 2e-5F;        // by which surfaces are larger, so that nothing shows between two
constexpr float kNearest_m = 1e-3F;     // surfaces are clipped here
constexpr float kDepthMargin = 1e-3F;   // relative; more than rounding errors of planes farther than
constexpr float kEdgeOn_m = 0.02F;      // this from the camera
constexpr float kMargin_px = 0.75F;     // light samples are up to 0.45 px beside the center of their pixel
constexpr unsigned kAllSides = 0b1111;  // of the image
constexpr float kFlat = 1e-12F;         // ratio of a squared area: a triangle without an inside

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

template <std::size_t kCorners>
bool is_flat(const std::array<Vector3f, kCorners>& corners_c) {
  const Vector3f edge_u = corners_c[1] - corners_c[0], edge_v = corners_c[kCorners - 1] - corners_c[0];
  const float area = edge_u.cross(edge_v).squaredNorm();
  return area <= kFlat * edge_u.squaredNorm() * edge_v.squaredNorm();
}

/// At a time at which a surface is not seen: outside of all edges.
constexpr LinearForm kOutside{0.0F, 0.0F, -1.0F};
constexpr SeenSurface kUnseen{
    .inverse_depth = {}, .u = {}, .v = {}, .inside = {kOutside, kOutside, kOutside, kOutside}, .surface = -1};

/// Inverse distance of the camera from the plane [1/m].
float inverse_height(const SeenSurface& seen) {
  return Vector3f(seen.inverse_depth.a, seen.inverse_depth.b, seen.inverse_depth.c).norm();
}

/// A linear form in the middle of the exposure, and how far it is from that at other sample times at most.
struct MovingForm {
  LinearForm form;
  float difference = 0.0F;

  /// @param farthest absolute coordinates @param is_known else nothing is known of the other form
  void allow_for(const LinearForm& other, const Vector2f& farthest, bool is_known) {
    const float by = std::abs(other.a - form.a) * farthest.x() + std::abs(other.b - form.b) * farthest.y() +
                     std::abs(other.c - form.c);
    difference = std::max(difference, is_known ? by : std::numeric_limits<float>::infinity());
  }
};

/// Smallest and largest values of a linear form in eight rectangles of a row.
struct Ranges {
  Floats smallest, largest;
  Ranges(const MovingForm& moving, const Floats& low_x, const Floats& high_x, const Vector2f& low_high_y) {
    const auto& [form, difference] = moving;
    const Floats x_low = form.a * low_x, x_high = form.a * high_x;
    const auto [y_low, y_high] = std::minmax({form.b * low_high_y.x(), form.b * low_high_y.y()});
    smallest = (x_low < x_high ? x_low : x_high) + (y_low + form.c - difference);
    largest = (x_low < x_high ? x_high : x_low) + (y_high + form.c + difference);
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

/// The number of a surface, and those of its edges that cross a tile.
struct Crossed {
  std::int32_t number;
  std::array<std::uint8_t, 4> edges{};
  std::size_t count = 0;

  /// @param bits of the edges
  Crossed(std::uint32_t seen, std::uint32_t bits) : number(static_cast<std::int32_t>(seen)) {
    for (; bits != 0; bits &= bits - 1) edges[count++] = static_cast<std::uint8_t>(std::countr_zero(bits));
  }
};

/// The search for the nearest surfaces in a tile.
struct Search {
  const TileRays& rays;
  TileHits& hits;
  /// Number of the nearest surface so far; -1: none.
  alignas(64) std::array<std::int32_t, Tile::kPixels> seen;
};

/// Tests eight columns of a tile against some of the edges. What is linear in x is computed once for all
/// rows.
template <int kEdges>
void test(const SeenSurface& surface, const Crossed& crossed, const Window& window, Search& search) {
  const auto x = load<Floats>(search.rays.x.data() + window.column);
  float* const inverse_z = search.hits.inverse_z.data();
  std::int32_t* const seen = search.seen.data();
  const AlongColumns inverse_depth(surface.inverse_depth, x);
  const auto side = [&](std::size_t i) { return AlongColumns(surface.inside[crossed.edges[i]], x); };
  const std::array<AlongColumns, 4> sides{side(0), side(1), side(2), side(3)};
  for (int row = window.first_row; row < window.end_row; ++row) {
    const int first = row * Tile::kColumns + window.column;
    const float y = search.rays.y[static_cast<std::size_t>(first)];
    const Floats w = inverse_depth(y);
    const auto before = load<Floats>(inverse_z + first);
    Integers is_hit = (w * kSameDepth > before) & (w <= 1.0F / kNearest_m);
    for (std::size_t i = 0; i < kEdges; ++i) is_hit &= sides[i](y) >= 0.0F;
    const Floats nearest = is_hit ? w : before;
    const Integers shown = is_hit ? crossed.number : load<Integers>(seen + first);
    std::memcpy(inverse_z + first, &nearest, sizeof nearest);
    std::memcpy(seen + first, &shown, sizeof shown);
  }
}

void test(const SeenSurface& surface, const Crossed& crossed, const Window& window, Search& search) {
  constexpr std::array kTests{test<0>, test<1>, test<2>, test<3>, test<4>};
  kTests[crossed.count](surface, crossed, window, search);
}

/// Records what eight pixels of a row show, for those that show a surface.
void record(const SeenSurface& surface, std::int32_t number, std::size_t first, Search& search) {
  const TileRays& rays = search.rays;
  TileHits& hits = search.hits;
  const AlongRow along_u(surface.u, rays.y[first]), along_v(surface.v, rays.y[first]);
  const auto x = load<Floats>(rays.x.data() + first), inverse_z = load<Floats>(hits.inverse_z.data() + first);
  const Floats z = 1.0F / inverse_z;
  const Integers is_shown = load<Integers>(search.seen.data() + first) == number;
  store_where(is_shown, (along_u.slope * x + along_u.first) * z, hits.u.data() + first);
  store_where(is_shown, (along_v.slope * x + along_v.first) * z, hits.v.data() + first);
  store_where(is_shown, Integers{} + surface.surface, hits.surface.data() + first);
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

/// A surface in the image at all sample times: pixels that contain it, its edges and its depth.
struct SurfaceTiles::Outline {
  Vector2f low = Vector2f::Constant(std::numeric_limits<float>::infinity()), high = -low;
  int left = 0, right = -1, top = 0, bottom = -1;
  std::array<MovingForm, 4> edges{};  ///< positive inside
  std::size_t edge_count = 0;
  MovingForm inverse_depth;
  bool edge_on = false;  ///< the inverse depth is not known well

  void add(const Polygon& polygon) {
    for (std::size_t i = 0; i < polygon.count; ++i)
      low = low.cwiseMin(polygon.points[i]), high = high.cwiseMax(polygon.points[i]);
  }
  void find_pixels(const Camera& camera) {
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

  /// @param farthest absolute coordinates in the image
  void find_forms(const std::array<SeenSurface, kSampleTimes>& seen, const Vector2f& farthest) {
    inverse_depth.form = seen[0].inverse_depth;
    for (std::size_t i = 0; i < edges.size(); ++i) edges[i].form = seen[0].inside[i];
    for (const SeenSurface& at : seen) {
      const bool is_seen = at.surface >= 0;
      inverse_depth.allow_for(at.inverse_depth, farthest, is_seen);
      for (std::size_t i = 0; i < edges.size(); ++i) edges[i].allow_for(at.inside[i], farthest, is_seen);
      edge_on = edge_on || !is_seen || inverse_height(at) * kEdgeOn_m > 1.0F;
    }
  }
};

void SurfaceTiles::begin(const Camera& camera) {
  camera_ = camera;
  columns_ = (camera.width + Tile::kColumns - 1) / Tile::kColumns;
  rows_ = (camera.height + Tile::kRows - 1) / Tile::kRows;
  left_ = static_cast<float>((camera.cx + 1.0) / camera.fx);
  right_ = static_cast<float>((camera.width - camera.cx) / camera.fx);
  top_ = static_cast<float>((camera.cy + 1.0) / camera.fy);
  bottom_ = static_cast<float>((camera.height - camera.cy) / camera.fy);
  for (std::vector<SeenSurface>& seen : seen_) seen.clear();
  entries_.clear();
  const auto fx = static_cast<float>(camera.fx), cx = static_cast<float>(camera.cx);
  low_x_.assign(static_cast<std::size_t>(columns_ + kLanes), 0.0F), high_x_ = low_x_;
  for (int column = 0; column < columns_; ++column) {
    const auto x = static_cast<float>(column * Tile::kColumns);
    low_x_[static_cast<std::size_t>(column)] = (x - kMargin_px - cx) / fx;
    high_x_[static_cast<std::size_t>(column)] = (x + Tile::kColumns - 1 + kMargin_px - cx) / fx;
  }
}

unsigned SurfaceTiles::sides_beyond(const Vector3f& p) const {
  return static_cast<unsigned>(p.x() + left_ * p.z() < 0.0F) |
         static_cast<unsigned>(right_ * p.z() - p.x() < 0.0F) << 1U |
         static_cast<unsigned>(p.y() + top_ * p.z() < 0.0F) << 2U |
         static_cast<unsigned>(bottom_ * p.z() - p.y() < 0.0F) << 3U;
}

void SurfaceTiles::see_quads(std::span<const Quad> quads, const Camera& camera,
                             const SampleInstants& instants) {
  begin(camera);
  covered_.assign(static_cast<std::size_t>(columns_ * rows_ + kLanes), 0.0F);
  const std::array<ToCamera, kSampleTimes> to_camera{ToCamera(instants[0].T_w_c), ToCamera(instants[1].T_w_c),
                                                     ToCamera(instants[2].T_w_c)};
  for (std::size_t i = 0; i < quads.size(); ++i) {
    const Quad& quad = quads[i];
    std::array<std::array<Vector3f, 4>, kSampleTimes> corners_c;
    std::array<bool, kSampleTimes> is_front;
    for (std::size_t time = 0; time < kSampleTimes; ++time) {
      const ToCamera& at = to_camera[time];
      is_front[time] = !quad.one_sided || quad.normal.dot(at.center - quad.origin) > 0.0F;
      const Vector3f origin = at(quad.origin), edge_u = at.R_c_w * quad.edge_u,
                     edge_v = at.R_c_w * quad.edge_v;
      corners_c[time] = {origin, origin + edge_u, origin + edge_u + edge_v, origin + edge_v};
    }
    unsigned beyond = kAllSides;
    for (const auto& corners : corners_c) {
      for (const Vector3f& corner : corners) beyond &= sides_beyond(corner);
    }
    if (beyond != 0) continue;
    add(corners_c, is_front, static_cast<std::int32_t>(i));
  }
  sort_entries();
}

void SurfaceTiles::see_triangles(const MovingMesh& mesh, const SampleInstants& instants,
                                 const SurfaceTiles& before) {
  begin(before.camera_);
  covered_ = before.covered_;
  beyond_.assign(mesh.start.size(), kAllSides);
  for (std::size_t time = 0; time < kSampleTimes; ++time) {
    const ToCamera to_camera(instants[time].T_w_c);
    points_c_[time].resize(mesh.start.size());
    for (std::size_t i = 0; i < mesh.start.size(); ++i) {
      points_c_[time][i] = to_camera(mesh.start[i] + instants[time].time * (mesh.end[i] - mesh.start[i]));
      beyond_[i] &= sides_beyond(points_c_[time][i]);
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    if ((beyond_[a] & beyond_[b] & beyond_[c]) != 0) continue;
    std::array<std::array<Vector3f, 3>, kSampleTimes> corners_c;
    std::array<bool, kSampleTimes> is_front;
    for (std::size_t time = 0; time < kSampleTimes; ++time) {
      const std::vector<Vector3f>& points_c = points_c_[time];
      const auto& [at_a, at_b, at_c] = corners_c[time] = {points_c[a], points_c[b], points_c[c]};
      is_front[time] = (at_b - at_a).cross(at_c - at_a).dot(at_a) < 0.0F;
    }
    add(corners_c, is_front, TileHits::kMoving | static_cast<std::int32_t>(i));
  }
  sort_entries();
}

template <std::size_t kCorners>
void SurfaceTiles::add(const std::array<std::array<Vector3f, kCorners>, kSampleTimes>& corners_c,
                       const std::array<bool, kSampleTimes>& is_front, std::int32_t surface) {
  if (std::ranges::none_of(is_front, std::identity())) return;
  Outline outline;
  std::array<SeenSurface, kSampleTimes> seen;
  for (std::size_t time = 0; time < kSampleTimes; ++time) {
    const std::array<Vector3f, kCorners>& corners = corners_c[time];
    seen[time] = kUnseen;
    if (!is_front[time] || is_flat(corners)) continue;
    const Polygon polygon = clipped(corners);
    const SeenSurface at = seen_surface(corners, surface);
    if (polygon.count < 3 || !std::isfinite(inverse_height(at))) continue;
    seen[time] = at;
    outline.add(polygon);
  }
  outline.find_pixels(camera_);
  if (!outline.is_visible()) return;
  outline.edge_count = kCorners;
  outline.find_forms(seen, {std::max(left_, right_), std::max(top_, bottom_)});
  add_to_tiles(outline);
  for (std::size_t time = 0; time < kSampleTimes; ++time) seen_[time].push_back(seen[time]);
}

void SurfaceTiles::add_to_tiles(const Outline& outline) {
  for (int row = outline.top / Tile::kRows; row <= outline.bottom / Tile::kRows; ++row)
    add_to_row(row, outline);
}

void SurfaceTiles::add_to_row(int row, const Outline& outline) {
  const auto fy = static_cast<float>(camera_.fy), cy = static_cast<float>(camera_.cy);
  const auto y = static_cast<float>(row * Tile::kRows);
  const Vector2f low_high_y((y - kMargin_px - cy) / fy, (y + Tile::kRows - 1 + kMargin_px - cy) / fy);
  const int last = outline.right / Tile::kColumns;
  for (int first = outline.left / Tile::kColumns; first <= last; first += kLanes) {
    const auto low_x = load<Floats>(low_x_.data() + first), high_x = load<Floats>(high_x_.data() + first);
    const int first_tile = row * columns_ + first;
    const Ranges depths(outline.inverse_depth, low_x, high_x, low_high_y);
    const Integers edge_on = Integers{} - (outline.edge_on ? 1 : 0);
    Integers seen_in = edge_on | (depths.largest >= load<Floats>(covered_.data() + first_tile));
    Integers edges{};
    for (std::size_t i = 0; i < outline.edge_count; ++i) {
      const Ranges distances(outline.edges[i], low_x, high_x, low_high_y);
      edges |= (distances.smallest <= 0.0F) & (1 << i);
      seen_in &= distances.largest >= 0.0F;
    }
    const Integers covers =
        ~edge_on & (edges == 0) & (depths.smallest > 1.0F / kFar_m) & (depths.largest < 1.0F / kNearest_m);
    for (int lane = 0; lane < std::min(kLanes, last + 1 - first); ++lane) {
      if (seen_in[lane] == 0) continue;
      const float nearest = outline.edge_on ? std::numeric_limits<float>::infinity() : depths.largest[lane];
      const auto tile = static_cast<std::uint32_t>(first_tile + lane);
      add_to_tile({row * Tile::kRows, (first + lane) * Tile::kColumns}, outline,
                  {.tile = tile,
                   .edges = static_cast<std::uint8_t>(edges[lane]),
                   .covers = covers[lane] != 0,
                   .nearest = nearest});
      if (covers[lane] != 0)
        covered_[tile] = std::max(covered_[tile], depths.smallest[lane] * (1.0F - kDepthMargin));
    }
  }
}

/// Completes an entry.
void SurfaceTiles::add_to_tile(const Tile& tile, const Outline& outline, Entry entry) {
  entry.seen = static_cast<std::uint32_t>(seen_[0].size());
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

void SurfaceTiles::find(const Query& query, TileHits& hits) const {
  const auto& [tile, time, rays] = query;
  const std::vector<SeenSurface>& seen = seen_[time];
  const auto number =
      static_cast<std::size_t>(tile.row / Tile::kRows * columns_ + tile.column / Tile::kColumns);
  const std::size_t begin = first_[number], end = first_[number + 1];
  if (begin == end) return;
  const SeenSurface& only = seen[sorted_[begin].seen];
  const bool is_moving = (only.surface & TileHits::kMoving) != 0;  // its light is not baked
  if (hits.content == TileHits::Content::kNothing && end == begin + 1 && sorted_[begin].covers && !is_moving)
    return show_one(only, rays, hits);
  hits.content = TileHits::Content::kAny;
  Search search{.rays = rays, .hits = hits, .seen = {}};
  search.seen.fill(-1);
  for (std::size_t i = begin; i < end; ++i) {
    const Entry& entry = sorted_[i];
    const Crossed crossed(entry.seen, entry.edges);
    for (int column = entry.first_column / kLanes * kLanes; column < entry.end_column; column += kLanes)
      test(seen[entry.seen], crossed, {entry.first_row, entry.end_row, column}, search);
  }
  for (std::size_t first = 0; first < Tile::kPixels; first += kLanes) {
    const auto nearest = load<Integers>(search.seen.data() + first);
    std::uint32_t left = lanes_where(nearest >= 0);
    while (left != 0) {
      const std::int32_t shown = nearest[std::countr_zero(left)];
      record(seen[static_cast<std::size_t>(shown)], shown, first, search);
      left &= ~lanes_where(nearest == shown);
    }
  }
}

}  // namespace stillpoint::synth
