// SPDX-License-Identifier: BSD-3-Clause
/// Two-dimensional maps as the ROS packages map_server and nav2_map_server write them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "datasets/mapping/map_window.h"

namespace stillpoint::datasets {

/// An image of a plane, whose lower left corner is (`origin_x_m`, `origin_y_m`) in the frame of the map.
struct OccupancyGrid {
  int columns = 0;
  int rows = 0;
  double resolution_m = 0.05;  ///< side of a cell
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  double yaw_rad = 0.0;              ///< of the image about its lower left corner, counterclockwise
  std::vector<std::uint8_t> pixels;  ///< row by row from the top: 0 occupied, 255 free

  /// The gray value at a place of the map; nullopt beyond the image.
  [[nodiscard]] std::optional<std::uint8_t> at(double x_m, double y_m) const;
};

/// Reads `image` (PGM, PNG or another format, relative to the file), `resolution`, `origin` ([x, y, yaw]) and
/// `negate` (0; 1: white is occupied). Thresholds are not used, the gray values are those of the image.
/// @param yaml a file of map_server
/// @throws InputError naming file and key if a value is missing or invalid, or as `read_gray`
[[nodiscard]] OccupancyGrid read_occupancy_grid(const std::filesystem::path& yaml);

/// The part of the grid in a window, as a `MapSource` makes it: white beyond the grid, and the mean of the
/// cells where several are in a pixel.
/// @throws InputError naming --occupancy-grid if no cell is in the window
[[nodiscard]] std::vector<std::uint8_t> map_image(const OccupancyGrid& grid, const MapWindow& window);

}  // namespace stillpoint::datasets
