// SPDX-License-Identifier: BSD-3-Clause
/// Single tiles of a map in Web Mercator: files on this machine, or on a server and then kept in the cache
/// folder.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

namespace stillpoint::datasets {

inline constexpr int kTilePixels = 256;

/// Tile `x` from the west and `y` from the north of the 2^zoom x 2^zoom tiles of the world.
struct Tile {
  int zoom = 0;
  int x = 0;
  int y = 0;
};

/// @param addresses of all tiles: begins with http://, https:// or file:///, and has {z}, {x} and {y}
/// @throws InputError naming --map-tiles if it does not
void require_tile_addresses(const std::string& addresses);

struct TileImage {
  cv::Mat pixels;       ///< CV_8UC3 (R, G, B), `kTilePixels` square; empty if there is no such tile
  std::string problem;  ///< why there is none
};

/// @param addresses as for `require_tile_addresses`
/// @throws InputError if a tile is no image of this size, a server does not answer, or the cache folder
/// cannot be written
[[nodiscard]] TileImage read_tile(const std::string& addresses, const Tile& tile);

}  // namespace stillpoint::datasets
