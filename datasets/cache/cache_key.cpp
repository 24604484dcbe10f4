// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/cache_key.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/content_hash.h"
#include "datasets/cache/frame_file.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

/// The bits of all numbers in the order in which they were added.
class Bits {
 public:
  void add(std::uint64_t value) { words_.push_back(value); }
  void add(double value) { words_.push_back(std::bit_cast<std::uint64_t>(value)); }

  void add(const Camera& camera) {
    add(static_cast<std::uint64_t>(camera.width));
    add(static_cast<std::uint64_t>(camera.height));
    for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) add(value);
    add(static_cast<std::uint64_t>(camera.model));
    for (const double value : camera.distortion) add(value);
  }

  void add(const Pose& pose) {
    for (int i = 0; i < 3; ++i) add(pose.p[i]);
    for (int i = 0; i < 4; ++i) add(pose.q.coeffs()[i]);
  }

  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const {
    return content_hash({reinterpret_cast<const char*>(words_.data()), words_.size() * sizeof(std::uint64_t)},
                        seed);
  }

 private:
  std::vector<std::uint64_t> words_;
};

bool is_png(const std::filesystem::path& file) {
  return file.empty() || file.extension() == ".png" || file.extension() == ".PNG";
}

/// Versions of the libraries that decode lossy formats. All decoders give the same pixels of a PNG, and
/// loading OpenImageIO to ask for its version takes longer than opening the cache.
std::string decoder_of(const SequenceContent& content) {
  const bool lossless = std::ranges::all_of(content.frame_files, [](const FrameFiles& files) {
    return is_png(files.color) && is_png(files.depth);
  });
  return lossless ? "PNG" : image_decoder_version();
}

}  // namespace

std::uint64_t cache_key(const SequenceContent& content, std::span<const FrameDigest> frames) {
  Bits bits;
  bits.add(std::uint64_t{kFrameFileVersion});
  bits.add(kDecodingVersion);
  bits.add(content.info.rig.camera);
  bits.add(content.info.rig.depth_units_per_m);
  bits.add(std::uint64_t{content.no_depth_value});
  bits.add(std::uint64_t{content.depth_camera.has_value()});
  if (content.depth_camera) {
    bits.add(content.depth_camera->camera);
    bits.add(content.depth_camera->T_c_d);
  }
  bits.add(std::uint64_t{frames.size()});
  for (const FrameDigest& frame : frames) {
    bits.add(frame.color);
    bits.add(frame.depth);
  }
  return bits.hash(content_hash(decoder_of(content)));
}

std::filesystem::path frame_file(const std::filesystem::path& cache, std::uint64_t key) {
  return cache / (hash_text(key) + kFrameFileExtension);
}

}  // namespace stillpoint::datasets
