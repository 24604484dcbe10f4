// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/mapping/occupancy_grid.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

/// A map of 3 x 2 cells of 0.5 m: an occupied cell in the upper left corner, unknown ones at the right.
std::filesystem::path write_map(const TemporaryFolder& folder, const std::string& yaml) {
  std::ofstream(folder.path() / "map.pgm", std::ios::binary) << "P5\n3 2\n255\n"
                                                             << std::string("\x00\xFE\xCD\xFE\xFE\xCD", 6);
  std::ofstream(folder.path() / "map.yaml") << yaml;
  return folder.path() / "map.yaml";
}

TEST(OccupancyGrid, HasItsLowerLeftCornerAtTheOrigin) {
  const TemporaryFolder folder;
  const OccupancyGrid grid = read_occupancy_grid(write_map(
      folder,
      "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"));
  EXPECT_EQ(grid.at(-0.9, 2.9), 0);     // upper left cell: x -1 to -0.5, y 2.5 to 3
  EXPECT_EQ(grid.at(-0.9, 2.1), 0xFE);  // below it
  EXPECT_EQ(grid.at(0.4, 2.9), 0xCD);
  for (const auto& [x, y] :
       {std::pair{-1.1, 2.5}, std::pair{0.6, 2.5}, std::pair{0.0, 1.9}, std::pair{0.0, 3.1}})
    EXPECT_FALSE(grid.at(x, y).has_value()) << x << ", " << y;
}

TEST(OccupancyGrid, IsTurnedAboutItsOriginAndNegated) {
  const TemporaryFolder folder;
  const OccupancyGrid grid = read_occupancy_grid(write_map(
      folder, "image: map.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 1.5707963267948966]\nnegate: 1\n"));
  // The columns go along y, the rows from below along -x.
  EXPECT_EQ(grid.at(-0.75, 0.25), 255);
  EXPECT_EQ(grid.at(-0.25, 0.25), 1);
  EXPECT_FALSE(grid.at(0.25, 0.25).has_value());
}

TEST(OccupancyGrid, NamesWhatIsMissingOrInvalid) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& yaml, const std::string& key) {
    expect_input_error([&] { static_cast<void>(read_occupancy_grid(write_map(folder, yaml))); }, {key});
  };
  expect("image: map.pgm\norigin: [0, 0, 0]\n", "resolution");
  expect("image: map.pgm\nresolution: 0.05\norigin: [0]\n", "origin");
  expect("image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: maybe\n", "negate");
  expect("image: no.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n", "no.pgm");
}

}  // namespace
}  // namespace stillpoint::datasets
