// SPDX-License-Identifier: BSD-3-Clause
/// Images of a part of the plane of x and y, whatever kind of map they are from.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace stillpoint::datasets {

/// A part of the plane, and the pixels of its image: x to the right, y up.
struct MapWindow {
  double x_low_m = 0.0;
  double x_high_m = 1.0;
  double y_low_m = 0.0;
  double y_high_m = 1.0;
  int columns = 1;
  int rows = 1;
};

/// Makes the image of a window: red, green and blue of each pixel, row by row from the top.
using MapSource = std::function<std::vector<std::uint8_t>(const MapWindow& window)>;

}  // namespace stillpoint::datasets
