// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tiles/map_tiles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/tiles/projection.h"
#include "datasets/tiles/tile_file.h"

namespace stillpoint::datasets {
namespace {

/// Places are projected at the centers of blocks of pixels, and interpolated between them.
constexpr int kBlockPixels = 16;

std::vector<PlanePoint> web_mercator(const std::string& crs, std::vector<PlanePoint> points) {
  ProjectedPoints projected = projection_module().to_web_mercator(crs, std::move(points));
  if (projected.problem.empty()) return std::move(projected.points);
  throw InputError("--map-crs " + crs, projected.problem);
}

/// Places of the centers of blocks as fractions of the world, from the west and from the north, row by row; a
/// border of one block is around the window. Across 180 degrees they go on beyond 0 or 1.
struct BlockPlaces {
  cv::Size size;
  std::vector<cv::Point2d> at;
};

BlockPlaces block_places(const MapTiles& tiles, const MapWindow& window) {
  const auto blocks_of = [](int pixels) { return (pixels + kBlockPixels - 1) / kBlockPixels + 2; };
  BlockPlaces places{{blocks_of(window.columns), blocks_of(window.rows)}, {}};
  std::vector<PlanePoint> points;
  for (int k = 0; k < places.size.area(); ++k) {
    const double to_right = kBlockPixels * (k % places.size.width - 0.5) / window.columns;
    const double down = kBlockPixels * (k / places.size.width - 0.5) / window.rows;
    points.push_back({window.x_low_m + to_right * (window.x_high_m - window.x_low_m),
                      window.y_high_m - down * (window.y_high_m - window.y_low_m)});
  }
  constexpr double kWorld_m = 2.0 * std::numbers::pi * 6378137.0;
  for (const PlanePoint& point : web_mercator(tiles.crs, std::move(points))) {
    places.at.emplace_back(0.5 + point.x / kWorld_m, 0.5 - point.y / kWorld_m);
    places.at.back().x += std::round(places.at.front().x - places.at.back().x);
  }
  return places;
}

/// Tiles at a zoom, from those of the upper left to those of the lower right corner.
struct TileRange {
  int zoom = 0;
  cv::Point first;
  cv::Point last;

  [[nodiscard]] cv::Size count() const { return {last.x - first.x + 1, last.y - first.y + 1}; }
};

/// @throws InputError if none of the places is in Web Mercator
TileRange tiles_around(const BlockPlaces& places, int zoom) {
  const auto [west, east] = std::ranges::minmax(places.at, {}, &cv::Point2d::x);
  const auto [north, south] = std::ranges::minmax(places.at, {}, &cv::Point2d::y);
  if (south.y <= 0.0 || north.y >= 1.0) {
    throw InputError("--map-tiles",
                     "the trajectory is beyond latitude 85 deg, where Web Mercator ends; draw it without");
  }
  const double tiles = std::ldexp(1.0, zoom);
  const auto row = [&](double y) {
    return static_cast<int>(std::clamp(std::floor(tiles * y), 0.0, tiles - 1.0));
  };
  return {zoom,
          {static_cast<int>(std::floor(tiles * west.x)), row(north.y)},
          {static_cast<int>(std::floor(tiles * east.x)), row(south.y)}};
}

/// The zoom whose pixels are about those of the window, in its middle.
int fitting_zoom(const BlockPlaces& places) {
  constexpr double kMostZoom = 22.0;
  const int middle = places.size.height / 2 * places.size.width + places.size.width / 2;
  const cv::Point2d step =
      places.at[static_cast<std::size_t>(middle)] - places.at[static_cast<std::size_t>(middle - 1)];
  const double pixel = std::hypot(step.x, step.y) / kBlockPixels;  // of the world
  return static_cast<int>(std::clamp(std::round(-std::log2(kTilePixels * pixel)), 0.0, kMostZoom));
}

/// The tiles of a range beside each other; empty if one is missing, which `problem` then tells.
struct Mosaic {
  cv::Mat image;
  std::string problem;
};

Mosaic mosaic_of(const std::string& addresses, const TileRange& range) {
  const cv::Size count = range.count();
  const int in_the_world = 1 << range.zoom;
  Mosaic mosaic{cv::Mat(count * kTilePixels, CV_8UC3), ""};
  for (int k = 0; k < count.area(); ++k) {
    const cv::Point at(k % count.width, k / count.width);
    const int x = range.first.x + at.x;
    const Tile tile{range.zoom, ((x % in_the_world) + in_the_world) % in_the_world, range.first.y + at.y};
    const TileImage image = read_tile(addresses, tile);
    if (image.pixels.empty())
      return {{}, fmt::format("tile {}/{}/{}: {}", tile.zoom, tile.x, tile.y, image.problem)};
    image.pixels.copyTo(mosaic.image(cv::Rect(at * kTilePixels, cv::Size(kTilePixels, kTilePixels))));
  }
  return mosaic;
}

/// The window, each of its pixels from its place in the tiles.
cv::Mat warped(const cv::Mat& mosaic, const TileRange& range, const BlockPlaces& places,
               const MapWindow& window) {
  const double pixels = std::ldexp(kTilePixels, range.zoom);
  const cv::Point2d origin = range.first * kTilePixels;
  std::vector<cv::Point2f> blocks;
  for (const cv::Point2d& place : places.at)
    blocks.emplace_back(place * pixels - origin - cv::Point2d(0.5, 0.5));
  cv::Mat from;
  cv::resize(cv::Mat(blocks).reshape(0, places.size.height), from, {}, kBlockPixels, kBlockPixels,
             cv::INTER_LINEAR);
  from = from(cv::Rect(kBlockPixels, kBlockPixels, window.columns, window.rows));
  cv::Mat image;
  cv::remap(mosaic, image, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return image;
}

}  // namespace

void require_map_tiles(const MapTiles& tiles) {
  require_tile_addresses(tiles.addresses);
  static_cast<void>(web_mercator(tiles.crs, {}));
}

std::vector<std::uint8_t> map_image(const MapTiles& tiles, const MapWindow& window) {
  constexpr int kMostTiles = 64;
  require_tile_addresses(tiles.addresses);
  const BlockPlaces places = block_places(tiles, window);
  std::string problem;
  for (int zoom = fitting_zoom(places); zoom >= 0; --zoom) {
    const TileRange range = tiles_around(places, zoom);
    if (range.count().area() > kMostTiles) continue;
    const Mosaic mosaic = mosaic_of(tiles.addresses, range);
    problem = mosaic.problem;
    if (mosaic.image.empty()) continue;
    const cv::Mat image = warped(mosaic.image, range, places, window);
    return {image.datastart, image.dataend};
  }
  throw InputError("--map-tiles " + tiles.addresses, "has tiles around the trajectory at no zoom (" +
                                                         problem + "); check the address and --map-crs");
}

}  // namespace stillpoint::datasets
