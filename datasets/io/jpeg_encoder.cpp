// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/jpeg_encoder.h"

#include <memory>

#include <turbojpeg.h>

#include "core/base/error.h"

namespace stillpoint::datasets {

std::optional<std::vector<unsigned char>> encode_jpeg(const cv::Mat& image, int quality) {
  STILLPOINT_CHECK(!image.empty() && image.depth() == CV_8U &&
                   (image.channels() == 1 || image.channels() == 3));
  const bool is_gray = image.channels() == 1;
  // Color at half the resolution, as cameras and most programs write it.
  const int subsampling = is_gray ? TJSAMP_GRAY : TJSAMP_420;
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
  const unsigned long capacity = tjBufSize(image.cols, image.rows, subsampling);
  if (!encoder || capacity == static_cast<unsigned long>(-1)) return std::nullopt;
  std::vector<unsigned char> bytes(capacity);
  unsigned char* data = bytes.data();
  unsigned long size = capacity;
  const int failed =
      tjCompress2(encoder.get(), image.data, image.cols, static_cast<int>(image.step[0]), image.rows,
                  is_gray ? TJPF_GRAY : TJPF_RGB, &data, &size, subsampling, quality, TJFLAG_NOREALLOC);
  if (failed != 0) return std::nullopt;
  bytes.resize(size);
  return bytes;
}

}  // namespace stillpoint::datasets
