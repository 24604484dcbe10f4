// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace stillpoint {
namespace {

// Measured on a 640x480 RGB picture: 7 ms and 374 kB so, 15 ms and 416 kB with the writer's defaults at the
// same level.
constexpr int kFastCompression = 1;  ///< zlib level
constexpr int kUpFilter = 0x20;  ///< libpng's PNG_FILTER_UP: each row as its difference from the one above

/// Decoding runs on the caller's thread: frames, not rows, are what we do in parallel.
void keep_to_one_thread() {
  static const bool done = OIIO::attribute("threads", 1);
  static_cast<void>(done);
}

/// OpenImageIO's reason, or a general one; line breaks become semicolons.
std::string reason(std::string text) {
  if (text.empty()) return "unknown reason";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text) c = c == '\n' ? ';' : c;
  return text;
}

/// Whether a PNG has its last chunk. Asked before decoding, because libpng leaves a truncated file by a jump
/// that leaks what the library above it holds, and prints to stderr.
bool has_png_end(const std::filesystem::path& file) {
  constexpr std::streamoff kTail = 64;  // the chunk is 12 bytes; some writers pad
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  std::string tail(static_cast<std::size_t>(std::clamp(size, std::streamoff{0}, kTail)), '\0');
  in.seekg(size - static_cast<std::streamoff>(tail.size()));
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return in && tail.find("IEND") != std::string::npos;
}

std::unique_ptr<OIIO::ImageInput> open_picture(const std::filesystem::path& file) {
  keep_to_one_thread();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw InputError(file.string(), "no such picture; is the sequence complete?");
  }
  const bool is_png = file.extension() == ".png" || file.extension() == ".PNG";
  if (is_png && !has_png_end(file)) {
    throw InputError(file.string(), "is truncated or no PNG; copy the file anew");
  }
  OIIO::ImageSpec keep_alpha;
  keep_alpha.attribute("oiio:UnassociatedAlpha", 1);
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file.string(), &keep_alpha);
  if (!input) {
    throw InputError(file.string(),
                     "cannot be decoded (" + reason(OIIO::geterror()) + "); copy the file anew");
  }
  return input;
}

/// Reads the first `channels` channels.
cv::Mat read_pixels(const std::filesystem::path& file, OIIO::ImageInput& input, int channels,
                    OIIO::TypeDesc::BASETYPE type) {
  const OIIO::ImageSpec& spec = input.spec();
  cv::Mat pixels(spec.height, spec.width,
                 CV_MAKETYPE(type == OIIO::TypeDesc::UINT16 ? CV_16U : CV_8U, channels));
  const bool complete = input.read_image(0, 0, 0, channels, OIIO::TypeDesc(type), pixels.data);
  const std::string problem = input.geterror();
  if (!complete || !problem.empty()) {
    throw InputError(file.string(), "is truncated or damaged (" + reason(problem) + "); copy the file anew");
  }
  return pixels;
}

OIIO::ImageSpec spec_of(const cv::Mat& picture) {
  const bool known = picture.type() == CV_8UC1 || picture.type() == CV_8UC3 || picture.type() == CV_16UC1;
  STILLPOINT_CHECK(known && !picture.empty());
  const OIIO::TypeDesc type(picture.depth() == CV_16U ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  return {picture.cols, picture.rows, picture.channels(), type};
}

using Bytes = std::vector<unsigned char>;

/// Encoded in memory first, because OpenImageIO's PNG writer does not notice a full disk.
/// @param format "png" or "jpg"
Bytes encode(const std::filesystem::path& file, const std::string& format, const OIIO::ImageSpec& spec,
             const cv::Mat& picture) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format, &memory);
  STILLPOINT_CHECK(output != nullptr);
  const auto row_bytes = static_cast<OIIO::stride_t>(picture.step[0]);
  const bool encoded = output->open("memory." + format, spec) &&
                       output->write_image(spec.format, picture.data, OIIO::AutoStride, row_bytes) &&
                       output->close();
  if (!encoded) throw InputError(file.string(), "cannot be encoded (" + reason(output->geterror()) + ")");
  return bytes;
}

/// Under another name first, so that nothing half-written is left behind.
void write_whole(const std::filesystem::path& file, const Bytes& bytes) {
  const std::filesystem::path unfinished = file.string() + ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code problem;
  if (out) std::filesystem::rename(unfinished, file, problem);
  if (out && !problem) return;
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  throw InputError(file.string(), "cannot be written; is the folder there, writable, and the disk not full?");
}

}  // namespace

cv::Mat read_picture(const std::filesystem::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_picture(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.format != OIIO::TypeDesc(OIIO::TypeDesc::UINT8)) {
    throw InputError(file.string(), "has " + std::to_string(8 * spec.format.size()) +
                                        " bits per channel where 8 are expected; is it a depth picture?");
  }
  return read_pixels(file, *input, spec.nchannels < 3 ? 1 : 3, OIIO::TypeDesc::UINT8);
}

cv::Mat read_depth(const std::filesystem::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_picture(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.format != OIIO::TypeDesc(OIIO::TypeDesc::UINT16) || spec.nchannels != 1) {
    throw InputError(file.string(), "has " + std::to_string(spec.nchannels) + " channel(s) of " +
                                        std::to_string(8 * spec.format.size()) +
                                        " bits where depth needs one of 16; is it a colour picture?");
  }
  return read_pixels(file, *input, 1, OIIO::TypeDesc::UINT16);
}

cv::Mat to_gray(const cv::Mat& picture) {
  if (picture.channels() == 1) return picture;
  STILLPOINT_CHECK(picture.type() == CV_8UC3);
  cv::Mat gray(picture.size(), CV_8UC1);
  for (int row = 0; row < picture.rows; ++row) {
    const cv::Vec3b* const rgb = picture.ptr<cv::Vec3b>(row);
    std::uint8_t* const luma = gray.ptr<std::uint8_t>(row);
    for (int column = 0; column < picture.cols; ++column) {
      const cv::Vec3b& pixel = rgb[column];  // 0.299, 0.587, 0.114 in 1/2^14
      luma[column] =
          static_cast<std::uint8_t>((4899 * pixel[0] + 9617 * pixel[1] + 1868 * pixel[2] + 8192) >> 14);
    }
  }
  return gray;
}

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  keep_to_one_thread();
  OIIO::ImageSpec spec = spec_of(picture);
  spec.attribute("png:compressionLevel", kFastCompression);
  spec.attribute("png:filter", kUpFilter);
  spec.attribute("compression", "rle");
  write_whole(file, encode(file, "png", spec, picture));
}

void write_jpeg(const std::filesystem::path& file, const cv::Mat& picture, int quality) {
  keep_to_one_thread();
  STILLPOINT_CHECK(picture.depth() == CV_8U);
  OIIO::ImageSpec spec = spec_of(picture);
  spec.attribute("compression", "jpeg:" + std::to_string(quality));
  write_whole(file, encode(file, "jpg", spec, picture));
}

}  // namespace stillpoint
