// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/texture.h"

#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>
#include <new>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

cv::Vec3b average(const cv::Mat& rgb, int row, int column) {
  cv::Vec3i sum(2, 2, 2);  // rounds to nearest
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      sum +=
          cv::Vec3i(rgb.at<cv::Vec3b>(std::min(row + dy, rgb.rows - 1), std::min(column + dx, rgb.cols - 1)));
    }
  }
  return cv::Vec3b(static_cast<std::uint8_t>(sum[0] / 4), static_cast<std::uint8_t>(sum[1] / 4),
                   static_cast<std::uint8_t>(sum[2] / 4));
}

cv::Mat halved(const cv::Mat& rgb) {
  cv::Mat half(std::max(1, rgb.rows / 2), std::max(1, rgb.cols / 2), CV_8UC3);
  for (int row = 0; row < half.rows; ++row) {
    for (int column = 0; column < half.cols; ++column) {
      half.at<cv::Vec3b>(row, column) = average(rgb, 2 * row, 2 * column);
    }
  }
  return half;
}

struct Unmap {
  std::size_t bytes;
  void operator()(std::uint32_t* texels) const { ::munmap(texels, bytes); }
};

/// Memory for texels, in pages of 2 MB where the system has them: rows of textures are far apart, and a frame
/// shows those of many textures, more than a processor keeps addresses of small pages. Textures follow each
/// other in parts, which are freed with their last texture.
std::shared_ptr<std::uint32_t[]> texel_memory(std::size_t texels) {
  constexpr std::size_t kPage = (2U << 20U) / sizeof(std::uint32_t), kPart = 16 * kPage;
  static std::mutex mutex;
  static std::weak_ptr<std::uint32_t[]> last_part;
  static std::size_t used = 0, size = 0;  // of the last part
  const std::scoped_lock lock(mutex);
  std::shared_ptr<std::uint32_t[]> part = last_part.lock();
  if (!part || used + texels > size) {
    size = std::max(kPart, (texels + kPage - 1) / kPage * kPage);
    const std::size_t bytes = size * sizeof(std::uint32_t);
    void* const buffer = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (buffer == MAP_FAILED) throw std::bad_alloc();
    ::madvise(buffer, bytes, MADV_HUGEPAGE);  // refused by some systems, which does no harm
    part = {static_cast<std::uint32_t*>(buffer), Unmap{bytes}};
    last_part = part;
    used = 0;
  }
  std::uint32_t* const first = part.get() + used;
  used += texels;
  return {std::move(part), first};
}

}  // namespace

Texture::Texture(const cv::Mat& rgb) {
  STILLPOINT_CHECK(rgb.type() == CV_8UC3 && std::has_single_bit(static_cast<unsigned>(rgb.cols)) &&
                   std::has_single_bit(static_cast<unsigned>(rgb.rows)));
  const std::size_t most = (4 * rgb.total() + 6 * static_cast<std::size_t>(rgb.rows)) / 3 +
                           4 * static_cast<std::size_t>(rgb.cols + rgb.rows);  // of all levels
  texels_ = texel_memory(most);
  std::size_t count = 0;
  for (cv::Mat level = rgb;; level = halved(level)) {
    levels_.push_back({level.cols, level.rows, count});
    for (int row = 0; row < level.rows; ++row) {
      for (int column = 0; column < level.cols; ++column)
        texels_[count++] = packed(level.at<cv::Vec3b>(row, column));
      texels_[count++] = packed(level.at<cv::Vec3b>(row, 0));
    }
    if (level.cols == 1 && level.rows == 1) break;
  }
  STILLPOINT_CHECK(count <= most);
}

}  // namespace stillpoint::synth
