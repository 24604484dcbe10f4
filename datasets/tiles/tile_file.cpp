// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tiles/tile_file.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>
#include <opencv2/imgproc.hpp>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/download/http_transfer.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFileScheme = "file://";

bool is_on_a_server(const std::string& addresses) {
  return addresses.starts_with("http://") || addresses.starts_with("https://");
}

std::string address_of(std::string addresses, const Tile& tile) {
  for (const auto& [key, value] : {std::pair{"{z}", tile.zoom}, {"{x}", tile.x}, {"{y}", tile.y}}) {
    for (std::size_t at = addresses.find(key); at != std::string::npos; at = addresses.find(key))
      addresses.replace(at, 3, std::to_string(value));
  }
  return addresses;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// @param name of the tile, for errors
cv::Mat tile_pixels(const fs::path& file, const std::string& name) {
  cv::Mat image = decode_image(bytes_of(file), name);
  if (image.cols != kTilePixels || image.rows != kTilePixels) {
    throw InputError(name, fmt::format("has {} x {} pixels; tiles have {} x {}", image.cols, image.rows,
                                       kTilePixels, kTilePixels));
  }
  if (image.channels() == 1) cv::cvtColor(image, image, cv::COLOR_GRAY2RGB);
  return image;
}

/// The file with a name of this process, until it is complete: others may download the same tile.
fs::path own_name(const fs::path& file) { return file.string() + fmt::format(".{}", getpid()); }

/// Downloads a tile and, if it is an image, gives it its name.
TileImage downloaded_tile(const std::string& address, const fs::path& file) {
  constexpr int kAttempts = 2;
  fs::create_directories(file.parent_path());
  PartialFile part(own_name(file));
  TransferResult result;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    result = transfer({.url = address}, part, {}, {});
    if (result.outcome != TransferOutcome::kTemporary) break;
  }
  if (result.outcome == TransferOutcome::kTemporary)
    throw InputError(address, result.problem + "; check the address and the network");
  if (result.outcome != TransferOutcome::kComplete) return {{}, result.problem};
  TileImage tile{tile_pixels(part.path(), address), ""};
  part.complete();
  fs::rename(own_name(file), file);
  return tile;
}

}  // namespace

void require_tile_addresses(const std::string& addresses) {
  const std::string where = "--map-tiles " + addresses;
  constexpr const char* kExample = "; an example is https://tile.openstreetmap.org/{z}/{x}/{y}.png";
  if (!is_on_a_server(addresses) && !addresses.starts_with("file:///"))
    throw InputError(where, std::string("begins with none of http://, https:// and file:///") + kExample);
  for (const char* const key : {"{z}", "{x}", "{y}"}) {
    if (addresses.find(key) == std::string::npos)
      throw InputError(where, std::string("has no ") + key + kExample);
  }
  const std::string address = address_of(addresses, {});
  if (const std::size_t at = address.find('{'); at != std::string::npos) {
    throw InputError(where, fmt::format("has {} beside {{z}}, {{x}} and {{y}}; insert a value{}",
                                        address.substr(at, address.find('}', at) - at + 1), kExample));
  }
}

TileImage read_tile(const std::string& addresses, const Tile& tile) {
  const std::string address = address_of(addresses, tile);
  if (!is_on_a_server(addresses)) {
    const fs::path file = address.substr(kFileScheme.size());
    if (!fs::exists(file)) return {{}, "there is no such file"};
    return {tile_pixels(file, file.string()), ""};
  }
  const fs::path folder = cache_folder() / "tiles" / hash_text(content_hash(addresses));
  const fs::path file = folder / std::to_string(tile.zoom) / std::to_string(tile.x) / std::to_string(tile.y);
  try {
    if (fs::exists(file)) return {tile_pixels(file, file.string()), ""};
    return downloaded_tile(address, file);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        folder.string(),
        fmt::format("cannot be written: {}; set STILLPOINT_CACHE to another folder", error.code().message()));
  }
}

}  // namespace stillpoint::datasets
