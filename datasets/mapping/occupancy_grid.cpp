// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/mapping/occupancy_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "datasets/io/image_io.h"
#include "datasets/io/sensor_yaml.h"

namespace stillpoint::datasets {

std::optional<std::uint8_t> OccupancyGrid::at(double x_m, double y_m) const {
  const double dx = x_m - origin_x_m;
  const double dy = y_m - origin_y_m;
  const double column = std::floor((std::cos(yaw_rad) * dx + std::sin(yaw_rad) * dy) / resolution_m);
  const double row = rows - 1 - std::floor((std::cos(yaw_rad) * dy - std::sin(yaw_rad) * dx) / resolution_m);
  if (!(column >= 0.0 && column < columns && row >= 0.0 && row < rows)) return std::nullopt;
  return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(column)];
}

OccupancyGrid read_occupancy_grid(const std::filesystem::path& yaml) {
  const SensorYaml values(yaml);
  OccupancyGrid grid{.resolution_m = values.positive("resolution"), .pixels = {}};
  const std::vector<double> origin = values.numbers("origin");
  if (origin.size() != 2 && origin.size() != 3) values.fail("origin", "must be a list [x, y, yaw]");
  grid.origin_x_m = origin[0];
  grid.origin_y_m = origin[1];
  if (origin.size() == 3) grid.yaw_rad = origin[2];
  const std::string negate = values.has("negate") ? values.text("negate") : "0";
  const bool is_negated = negate == "1" || negate == "true";
  if (!is_negated && negate != "0" && negate != "false") values.fail("negate", "must be 0 or 1");
  const cv::Mat image = read_gray(yaml.parent_path() / values.text("image")).image;
  grid.columns = image.cols;
  grid.rows = image.rows;
  for (int row = 0; row < image.rows; ++row) {
    const auto* const pixels = image.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column)
      grid.pixels.push_back(is_negated ? static_cast<std::uint8_t>(255 - pixels[column]) : pixels[column]);
  }
  return grid;
}

std::vector<std::uint8_t> map_image(const OccupancyGrid& grid, const MapWindow& window) {
  const double width_m = window.x_high_m - window.x_low_m;
  const double height_m = window.y_high_m - window.y_low_m;
  const double cells = width_m / window.columns / grid.resolution_m;  // along a pixel
  const int samples = static_cast<int>(std::clamp(std::ceil(cells), 1.0, 4.0));
  std::vector<std::uint8_t> image;
  image.reserve(static_cast<std::size_t>(window.rows) * static_cast<std::size_t>(window.columns) * 3);
  bool has_cells = false;
  for (int k = 0; k < window.rows * window.columns; ++k) {
    int sum = 0;
    for (int s = 0; s < samples * samples; ++s) {
      const double to_right = (k % window.columns + (s % samples + 0.5) / samples) / window.columns;
      const double down = (k / window.columns + (s / samples + 0.5) / samples) / window.rows;
      const std::optional<std::uint8_t> cell =
          grid.at(window.x_low_m + to_right * width_m, window.y_high_m - down * height_m);
      has_cells |= cell.has_value();
      sum += cell.value_or(255);
    }
    image.insert(image.end(), 3, static_cast<std::uint8_t>(sum / (samples * samples)));
  }
  if (!has_cells) {
    throw InputError("--occupancy-grid",
                     "no cell of the map is near the paths; it must be in the world of the ground truth");
  }
  return image;
}

}  // namespace stillpoint::datasets
