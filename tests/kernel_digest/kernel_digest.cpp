// SPDX-License-Identifier: BSD-3-Clause
// Prints a hash of the output of each SIMD kernel for generated images, the same on all processors.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/content_hash.h"
#include "core/frontend/detect/fast_kernel.h"
#include "core/frontend/patch/patch_kernel.h"

namespace stillpoint {
namespace {

/// Gray image with a border, so that kernels may read beyond its edges.
struct Image {
  static constexpr int kBorder = 16;
  int width, height;
  std::vector<std::uint8_t> pixels;

  Image(int image_width, int image_height)
      : width(image_width),
        height(image_height),
        pixels(static_cast<std::size_t>((width + 2 * kBorder) * (height + 2 * kBorder))) {}
  [[nodiscard]] std::ptrdiff_t stride() const { return width + 2 * kBorder; }
  std::uint8_t* at(int x, int y) { return pixels.data() + (y + kBorder) * stride() + x + kBorder; }
  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return pixels.data() + (y + kBorder) * stride() + x + kBorder;
  }
  [[nodiscard]] PatchImage view() const {
    return {.pixels = at(0, 0), .stride = stride(), .width = width, .height = height};
  }
};

std::uint32_t noise(int x, int y) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  return (h ^ h >> 13) & 255U;
}

/// Blocks of 6 px with random brightness, box-filtered over 5 px, displaced by (dx, dy) fifths of a pixel:
/// integers only.
std::uint8_t texture(int x, int y, int dx, int dy) {
  std::uint32_t sum = 0;
  for (int i = 0; i < 25; i += 3) {
    for (int j = 0; j < 25; j += 3) sum += noise((5 * x + dx + j + 5000) / 30, (5 * y + dy + i + 5000) / 30);
  }
  return static_cast<std::uint8_t>(sum / 81);
}

Image textured(int width, int height, int dx, int dy) {
  Image image(width, height);
  for (int y = -Image::kBorder; y < height + Image::kBorder; ++y) {
    for (int x = -Image::kBorder; x < width + Image::kBorder; ++x) *image.at(x, y) = texture(x, y, dx, dy);
  }
  return image;
}

Image halved(const Image& image) {
  Image half(image.width / 2, image.height / 2);
  for (int y = -Image::kBorder / 2; y < half.height + Image::kBorder / 2; ++y) {
    for (int x = -Image::kBorder / 2; x < half.width + Image::kBorder / 2; ++x) {
      const std::uint8_t* p = image.at(2 * x, 2 * y);
      *half.at(x, y) =
          static_cast<std::uint8_t>((p[0] + p[1] + p[image.stride()] + p[image.stride() + 1] + 2) / 4);
    }
  }
  return half;
}

/// Hash of the scores of all rows, and the number of corners.
void print_fast(const Image& image, int threshold) {
  std::uint64_t hash = 0;
  int corners = 0;
  std::vector<std::uint8_t> scores(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    score_fast_row(image.at(0, y), image.stride(), threshold, scores);
    hash = content_hash({reinterpret_cast<const char*>(scores.data()), scores.size()}, hash);
    for (const std::uint8_t score : scores) corners += score > 0;
  }
  std::printf("fast %dx%d threshold %d: %d corners, %s\n", image.width, image.height, threshold, corners,
              hash_text(hash).c_str());
}

std::vector<PatchPoint> grid_points(const Image& image) {
  std::vector<PatchPoint> points;
  for (int y = 5; y < image.height; y += 11) {
    for (int x = 3; x < image.width; x += 13)
      points.push_back({static_cast<float>(x) + 0.25F, static_cast<float>(y) + 0.625F});
  }
  return points;
}

/// Hash of the positions of all found patches, and their number.
void print_patches(int dx, int dy, PatchTarget target, const char* name) {
  const Image from = textured(333, 241, 0, 0), to = textured(333, 241, dx, dy);
  const Image from1 = halved(from), to1 = halved(to);
  const std::vector<PatchImage> from_levels = {from.view(), from1.view()},
                                to_levels = {to.view(), to1.view()};
  const std::vector<PatchPoint> points = grid_points(from);
  std::vector<PatchPoint> matches = points;
  std::vector<std::uint8_t> found(points.size());
  track_patches({.from = from_levels, .to = to_levels, .points = points, .matches = matches, .found = found},
                {}, target);
  std::uint64_t hash = content_hash({reinterpret_cast<const char*>(found.data()), found.size()});
  int count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == 0) continue;
    ++count;
    hash = content_hash({reinterpret_cast<const char*>(&matches[i]), sizeof matches[i]}, hash);
  }
  std::printf("patches, motion %d/5 %d/5 px, %s: %d of %zu found, %s\n", dx, dy, name, count, found.size(),
              hash_text(hash).c_str());
}

}  // namespace
}  // namespace stillpoint

int main() {
  using namespace stillpoint;
  for (const int threshold : {5, 10, 20, 40}) print_fast(textured(333, 241, 0, 0), threshold);
  print_fast(textured(67, 31, 7, 3), 10);
  for (const int motion : {0, 1, 4, 9, 17}) {
    print_patches(motion, -motion / 2, PatchTarget::kBest, "best instructions");
    print_patches(motion, -motion / 2, PatchTarget::kPortable, "portable");
  }
}
