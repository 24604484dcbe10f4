// SPDX-License-Identifier: BSD-3-Clause
/// Map tiles, as the servers of OpenStreetMap and others provide them, in the plane of another coordinate
/// reference system (CRS).
///
/// At zoom z the world is 2^z x 2^z square tiles in Web Mercator (EPSG:3857; X, Y [m]); with C = 2 pi R,
/// R = 6378137 m, the tile of a place and the place in it are the integer and the fractional part of
///   x = 2^z (1/2 + X/C), y = 2^z (1/2 - Y/C).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/mapping/map_window.h"

namespace stillpoint::datasets {

struct MapTiles {
  std::string addresses;  ///< as `require_tile_addresses`
  /// Of the plane; x east, y north [m]: anything that PROJ understands, such as "EPSG:32632", or
  /// "+proj=aeqd +lat_0=48 +lon_0=11 +datum=WGS84" for a local plane.
  std::string crs;
};

/// Checks what can be checked without a window.
/// @throws InputError naming --map-tiles or --map-crs if an address or the CRS is invalid, or this build has
/// no PROJ
void require_map_tiles(const MapTiles& tiles);

/// The image of a window, as a `MapSource` makes it: of the zoom whose pixels are about those of the image,
/// or the next lower one with all tiles and at most 64 of them.
/// @throws InputError as `require_map_tiles` and `read_tile`; if the CRS or Web Mercator ends within the
/// window; or if there are tiles of no zoom
[[nodiscard]] std::vector<std::uint8_t> map_image(const MapTiles& tiles, const MapWindow& window);

}  // namespace stillpoint::datasets
