// SPDX-License-Identifier: BSD-3-Clause
/// Small sequences of noise for tests of the frame cache, and a decoder that counts its calls.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/types/frame.h"
#include "datasets/cache/frame_cache.h"
#include "datasets/io/image_io.h"
#include "datasets/read_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {

constexpr int kCachedFrames = 6;
constexpr int kCachedWidth = 64;
constexpr int kCachedHeight = 48;

/// Digests of files that were modified a moment ago are not remembered.
inline void make_older(const std::filesystem::path& file) {
  std::filesystem::last_write_time(file,
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
}

template <class Value>
cv::Mat noise_image(int type, std::uint64_t seed) {
  cv::Mat image(kCachedHeight, kCachedWidth, type);
  std::uint64_t state = seed;
  Value* const values = image.ptr<Value>();
  for (std::size_t i = 0; i < image.total() * static_cast<std::size_t>(image.channels()); ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    values[i] = static_cast<Value>(state >> 40);
  }
  return image;
}

/// Writes color and depth image `index`.
inline void write_noise_frame(const std::filesystem::path& folder, int index, std::uint64_t seed) {
  for (const char* kind : {"color", "depth"}) {
    std::filesystem::create_directories(folder / kind);
    const std::filesystem::path file = folder / kind / ("0000" + std::to_string(index) + ".png");
    const bool color = kind == std::string("color");
    datasets::write_png(
        file, color ? noise_image<std::uint8_t>(CV_8UC3, seed) : noise_image<std::uint16_t>(CV_16UC1, seed));
    make_older(file);
  }
}

/// Writes a sequence of `kCachedFrames` frames.
inline std::filesystem::path noise_sequence(const std::filesystem::path& folder, std::uint64_t seed = 1) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "rig.toml")
      << "[camera]\nwidth = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 32\ncy = 24\n";
  for (int i = 0; i < kCachedFrames; ++i)
    write_noise_frame(folder, i, 100 * seed + static_cast<std::uint64_t>(i));
  return folder;
}

/// A sequence opened with a cache, which counts decoded frames and records warnings.
struct CachedSequence {
  CachedSequence(const std::filesystem::path& folder, datasets::FrameCacheOptions options,
                 const datasets::OpenOptions& open = {})
      : content(datasets::read_sequence(folder, open, faults)),
        cache(content, with_warnings(std::move(options)),
              {.frame =
                   [this](std::size_t index) {
                     ++decoded;
                     return datasets::decode_frame(content, index);
                   },
               .color = [this](std::size_t index) { return datasets::decode_color(content, index); }}) {}

  datasets::FrameCacheOptions with_warnings(datasets::FrameCacheOptions options) {
    options.warn = [this](const std::string& text) { warnings.push_back(text); };
    return options;
  }

  /// Whether a loaded frame has the bits of the decoded one.
  bool loads_same(std::size_t index) {
    const Frame expected = datasets::decode_frame(content, index);
    const Frame frame = cache.load(index);
    const auto same = [](const cv::Mat& a, const cv::Mat& b) {
      return a.size() == b.size() && a.type() == b.type() &&
             std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
    };
    return frame.id == expected.id && frame.t == expected.t && same(frame.gray, expected.gray) &&
           same(frame.depth, expected.depth) && same(color_image(frame), expected.color) &&
           frame.depth_units_per_m == expected.depth_units_per_m;
  }

  bool loads_all() {
    bool same = true;
    for (std::size_t i = 0; i < content.frame_files.size(); ++i) same &= loads_same(i);
    return same;
  }

  FaultLog faults;
  std::vector<std::string> warnings;
  std::atomic<int> decoded{0};
  datasets::SequenceContent content;
  datasets::FrameCache cache;
};

/// Files of the cache with this extension.
inline std::vector<std::filesystem::path> cache_files(const std::filesystem::path& folder,
                                                      const std::string& extension = ".frames") {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  return files;
}

}  // namespace stillpoint
