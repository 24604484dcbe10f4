// SPDX-License-Identifier: BSD-3-Clause
/// Tiles whose colors are their places: red and green are the column and the row, blue the tile.
#include "datasets/tiles/map_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "datasets/io/image_io.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/fault_server.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/download/download_target.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kEquatorRadius_m = 6378137.0;  // of WGS84
constexpr double kEccentricity2 = 0.00669437999014;

/// In radians.
struct Geographic {
  double latitude = 0.0;
  double longitude = 0.0;
};

double meridian_radius_m(double latitude) {
  return kEquatorRadius_m * (1.0 - kEccentricity2) /
         std::pow(1.0 - kEccentricity2 * std::pow(std::sin(latitude), 2), 1.5);
}
double parallel_radius_m(double latitude) {
  return kEquatorRadius_m * std::cos(latitude) /
         std::sqrt(1.0 - kEccentricity2 * std::pow(std::sin(latitude), 2));
}

/// Place in pixels of 2^zoom x 2^zoom tiles, by the definition of Web Mercator on the sphere.
cv::Point2d pixel_of(const Geographic& at, int zoom) {
  const double world = 256.0 * std::ldexp(1.0, zoom);
  return {world * (0.5 + at.longitude / (2.0 * std::numbers::pi)),
          world * (0.5 - std::asinh(std::tan(at.latitude)) / (2.0 * std::numbers::pi))};
}

int blue_of(int x, int y) { return (7 * x + 31 * y) % 256; }

std::string tile_bytes(int x, int y) {
  cv::Mat image(256, 256, CV_8UC3);
  for (int row = 0; row < 256; ++row)
    for (int column = 0; column < 256; ++column)
      image.at<cv::Vec3b>(row, column) =
          cv::Vec3b(static_cast<uchar>(column), static_cast<uchar>(row), static_cast<uchar>(blue_of(x, y)));
  const TemporaryFolder folder;
  write_png(folder.path() / "tile.png", image);
  return text_of(folder.path() / "tile.png");
}

/// The 5 x 5 tiles around a place.
void write_tiles(const TemporaryFolder& folder, const Geographic& around, int zoom) {
  const cv::Point2d center = pixel_of(around, zoom) / 256.0;
  for (int k = 0; k < 25; ++k) {
    const int x = static_cast<int>(center.x) + k % 5 - 2;
    const int y = static_cast<int>(center.y) + k / 5 - 2;
    const fs::path file = folder.path() / fmt::format("{}/{}/{}.png", zoom, x, y);
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << tile_bytes(x, y);
  }
}

std::string addresses_of(const TemporaryFolder& folder) {
  return "file://" + folder.path().string() + "/{z}/{x}/{y}.png";
}

/// 200 x 100 pixels of 2 m.
MapWindow window_around(double x_m, double y_m) {
  return {x_m - 200, x_m + 200, y_m - 100, y_m + 100, 200, 100};
}

cv::Vec3b color_at(const std::vector<std::uint8_t>& image, const MapWindow& window, double x_m, double y_m) {
  const int column = static_cast<int>((x_m - window.x_low_m) / 2.0);
  const int row = static_cast<int>((window.y_high_m - y_m) / 2.0);
  const std::uint8_t* const pixel = &image.at(static_cast<std::size_t>(3 * (row * window.columns + column)));
  return {pixel[0], pixel[1], pixel[2]};
}

/// Within 1.5 pixels of the tile.
void expect_place(const cv::Vec3b& color, const Geographic& at, int zoom) {
  const cv::Point2d pixel = pixel_of(at, zoom);
  const cv::Point tile(static_cast<int>(pixel.x / 256.0), static_cast<int>(pixel.y / 256.0));
  EXPECT_EQ(color[2], blue_of(tile.x, tile.y));
  EXPECT_NEAR(color[0], pixel.x - 256.0 * tile.x - 0.5, 1.5);
  EXPECT_NEAR(color[1], pixel.y - 256.0 * tile.y - 0.5, 1.5);
}

// The CN Tower at 43 38' 33.24" N, 79 23' 13.7" W is at 630084 m east, 4833438 m north in zone 17 (Wikipedia,
// "Universal Transverse Mercator coordinate system"). There, 1.613 deg east of the central meridian, north of
// the grid is turned by 1.613 deg sin(lat) = 1.113 deg to the east, and its scale is 0.9996 (1 + (130084 m /
// R)^2 / 2) = 0.99981.
const Geographic kTower{(43 + 38 / 60.0 + 33.24 / 3600.0) * kDegree,
                        -(79 + 23 / 60.0 + 13.7 / 3600.0) * kDegree};
constexpr double kTowerX = 630084.0;
constexpr double kTowerY = 4833438.0;

Geographic from_tower(double x_m, double y_m) {
  const double turned = (kTower.longitude + 81 * kDegree) * std::sin(kTower.latitude);
  const double north_m = (y_m * std::cos(turned) - x_m * std::sin(turned)) / 0.99981;
  const double east_m = (x_m * std::cos(turned) + y_m * std::sin(turned)) / 0.99981;
  return {kTower.latitude + north_m / meridian_radius_m(kTower.latitude),
          kTower.longitude + east_m / parallel_radius_m(kTower.latitude)};
}

// 2 m at this latitude are 156543 m cos(lat) / 2^15.8 of a pixel.
TEST(MapTiles, AreInThePlaceOfAProjectedCrs) {
  const TemporaryFolder folder;
  write_tiles(folder, kTower, 16);
  const MapWindow window = window_around(kTowerX, kTowerY);
  const auto image = map_image({addresses_of(folder), "EPSG:32617"}, window);
  ASSERT_EQ(image.size(), 3U * 200U * 100U);
  for (const auto& [x, y] : {cv::Point2d(1, 1), {-185, 85}, {185, -85}, {171, 75}})
    expect_place(color_at(image, window, kTowerX + x, kTowerY + y), from_tower(x, y), 16);
}

// Over 2 km, 1.113 deg are 39 m, almost 3 pixels of the tiles.
TEST(MapTiles, TurnWithTheGridOverALongWay) {
  const TemporaryFolder folder;
  write_tiles(folder, kTower, 13);
  MapWindow window{kTowerX - 2000, kTowerX + 2000, kTowerY - 2000, kTowerY + 2000, 400, 400};
  const auto image = map_image({addresses_of(folder), "+proj=utm +zone=17 +datum=WGS84"}, window);
  for (const auto& [x, y] : {cv::Point2d(-1605, 1705), {1205, 1795}, {-1505, -1895}}) {
    const std::size_t pixel =
        400 * static_cast<std::size_t>((2000 - y) / 10) + static_cast<std::size_t>((2000 + x) / 10);
    expect_place({image[3 * pixel], image[3 * pixel + 1], image[3 * pixel + 2]}, from_tower(x, y), 13);
  }
}

// In a local plane north is along the meridian and, at its origin, east along the parallel.
TEST(MapTiles, AreInThePlaceOfALocalPlane) {
  const TemporaryFolder folder;
  const Geographic origin{48.0 * kDegree, 11.0 * kDegree};
  write_tiles(folder, origin, 16);
  const MapWindow window = window_around(0, 0);
  const auto image = map_image({addresses_of(folder), "+proj=aeqd +lat_0=48 +lon_0=11 +datum=WGS84"}, window);
  for (const auto& [x, y] : {cv::Point2d(1, 1), {-151, 1}, {181, 1}, {1, -75}, {1, 91}}) {
    expect_place(color_at(image, window, x, y),
                 {origin.latitude + y / meridian_radius_m(origin.latitude),
                  origin.longitude + x / parallel_radius_m(origin.latitude)},
                 16);
  }
}

TEST(MapTiles, GoOnAcross180Degrees) {
  const TemporaryFolder folder;
  const Geographic origin{0.0, -179.9999 * kDegree};  // 11 m east
  write_tiles(folder, origin, 16);
  for (const int y : {32767, 32768}) {
    const fs::path file = folder.path() / fmt::format("16/65535/{}.png", y);
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << tile_bytes(65535, y);
  }
  const MapWindow window = window_around(0, 0);
  const auto image =
      map_image({addresses_of(folder), "+proj=aeqd +lat_0=0 +lon_0=-179.9999 +datum=WGS84"}, window);
  const auto east_of_border = [&](double x_m) { return x_m / kEquatorRadius_m + origin.longitude; };
  expect_place(color_at(image, window, 101, 51), {51 / meridian_radius_m(0.0), east_of_border(101)}, 16);
  expect_place(color_at(image, window, -101, 51),
               {51 / meridian_radius_m(0.0), east_of_border(-101) + 2.0 * std::numbers::pi}, 16);
}

/// A server with tiles up to zoom 14, and a cache folder.
class TileServer : public testing::Test {
 public:
  TileServer() { setenv("STILLPOINT_CACHE", (folder_.path() / "cache").c_str(), 1); }
  ~TileServer() override { unsetenv("STILLPOINT_CACHE"); }

 protected:
  static ServedResponse respond(const ServedRequest& request) {
    int zoom = 0;
    int x = 0;
    int y = 0;
    if (std::sscanf(request.path.c_str(), "/%d/%d/%d.png", &zoom, &x, &y) != 3 || zoom > 14)
      return {.status = 404};
    return file_response(request, tile_bytes(x, y), kEtag);
  }

  TemporaryFolder folder_;
  MapWindow window_ = window_around(kTowerX, kTowerY);
};

TEST_F(TileServer, IsAskedForALowerZoomAndOnlyOnce) {
  auto server = std::make_unique<FaultServer>(&respond);
  const MapTiles tiles{server->url("/{z}/{x}/{y}.png"), "EPSG:32617"};
  const auto image = map_image(tiles, window_);
  const int requests = server->requests();
  for (const auto& [x, y] : {cv::Point2d(-185, 85), {185, -85}})
    expect_place(color_at(image, window_, kTowerX + x, kTowerY + y), from_tower(x, y), 14);
  EXPECT_GE(requests, 3);  // none at zooms 16 and 15, at least one at 14
  server.reset();
  // The two tiles that are missing are asked for again, and the server is gone.
  expect_input_error([&] { static_cast<void>(map_image(tiles, window_)); },
                     {tiles.addresses.substr(0, 16), "network"});
}

TEST_F(TileServer, IsNotNeededForTilesOfTheCache) {
  window_.columns = 50;  // pixels of 8 m: zoom 14
  window_.rows = 25;
  auto server = std::make_unique<FaultServer>(&respond);
  const MapTiles tiles{server->url("/{z}/{x}/{y}.png"), "EPSG:32617"};
  const auto image = map_image(tiles, window_);
  server.reset();
  EXPECT_EQ(map_image(tiles, window_), image);
}

TEST_F(TileServer, MayAnswerWithOtherThanTiles) {
  const FaultServer texts([](const ServedRequest&) { return ServedResponse{.body = "quota exceeded"}; });
  const FaultServer busy([](const ServedRequest&) { return ServedResponse{.status = 503}; });
  const auto expect = [&](const FaultServer& server, const std::vector<std::string>& words) {
    expect_input_error(
        [&] {
          static_cast<void>(map_image({server.url("/{z}/{x}/{y}.png"), "EPSG:32617"}, window_));
        },
        words);
  };
  for (int repetition = 0; repetition < 2; ++repetition)  // what is no tile is not kept
    expect(texts, {texts.url("/16/"), ".png"});
  expect(busy, {busy.url("/16/"), "503", "network"});
}

TEST(MapTiles, NameWhatIsInvalid) {
  const TemporaryFolder folder;
  const std::string addresses = addresses_of(folder);
  const MapWindow tower = window_around(kTowerX, kTowerY);
  const auto expect = [](const MapTiles& tiles, const MapWindow& window,
                         const std::vector<std::string>& words) {
    expect_input_error([&] { static_cast<void>(map_image(tiles, window)); }, words);
  };
  expect({"tiles/{z}/{x}/{y}.png", "EPSG:32617"}, tower, {"--map-tiles tiles/", "file:///"});
  expect({"file:///tiles/{z}/{x}.png", "EPSG:32617"}, tower, {"--map-tiles", "{y}"});
  expect({"https://{s}.host/{z}/{x}/{y}.png", "EPSG:32617"}, tower, {"--map-tiles", "{s}"});
  expect({addresses, "EPSG:99999999"}, tower, {"--map-crs EPSG:99999999", "no CRS"});
  expect({addresses, "+proj=no"}, tower, {"--map-crs +proj=no", "no CRS"});
  expect({addresses, "EPSG:4326"}, tower, {"--map-crs EPSG:4326", "meters"});
  expect({addresses, "EPSG:2263"}, tower, {"--map-crs EPSG:2263", "meters"});  // US survey feet
  expect({addresses, "EPSG:32617"}, window_around(0, 0), {"--map-crs", "latitude", "ground truth"});
  expect({addresses, "+proj=aeqd +lat_0=48 +lon_0=11 +datum=WGS84"}, window_around(1e9, 0),
         {"--map-crs", "no place at x", "ground truth"});
  expect({addresses, "+proj=aeqd +lat_0=89 +lon_0=11 +datum=WGS84"}, window_around(0, 0),
         {"--map-tiles", "latitude 85"});
  expect({addresses, "EPSG:32617"}, tower, {"--map-tiles", "no zoom", "no such file"});
  folder.write("0/0/0.png", "no image");
  expect({addresses, "EPSG:32617"}, tower, {"0/0/0.png"});
  write_png(folder.path() / "0/0/0.png", cv::Mat::zeros(512, 512, CV_8UC3));
  expect({addresses, "EPSG:32617"}, tower, {"0/0/0.png", "512 x 512"});
}

}  // namespace
}  // namespace stillpoint::datasets
