// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "datasets/io/file_bytes.h"
#include "datasets/io/luma.h"
#include "datasets/io/png_decoder.h"

namespace stillpoint::datasets {
namespace {

// Measured on a 640x480 RGB image: 7 ms and 374 kB with this filter and strategy, 15 ms and 416 kB with the
// defaults of the writer at the same level.
constexpr int kFastCompression = 1;  ///< zlib level
constexpr int kUpFilter = 0x20;  ///< libpng's PNG_FILTER_UP: each row as its difference from the one above

/// Decoding runs on the calling thread: the program is parallel over frames, not over the rows of an image.
void disable_oiio_threads() {
  static const bool done = OIIO::attribute("threads", 1);
  static_cast<void>(done);
}

/// The error text of OpenImageIO on one line, or a placeholder if it is empty.
std::string reason(std::string text) {
  if (text.empty()) return "unknown reason";
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text) c = c == '\n' ? ';' : c;
  return text;
}

/// Whether a PNG has its final IEND chunk. Checked before decoding, because libpng handles truncated files by
/// longjmp, which leaks memory of the calling library, and prints to stderr.
bool has_png_end(const std::filesystem::path& file) {
  constexpr std::streamoff kTail = 64;  // the chunk is 12 bytes; some writers pad
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  std::string tail(static_cast<std::size_t>(std::clamp(size, std::streamoff{0}, kTail)), '\0');
  in.seekg(size - static_cast<std::streamoff>(tail.size()));
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return in && tail.find("IEND") != std::string::npos;
}

std::unique_ptr<OIIO::ImageInput> open_image(const std::filesystem::path& file) {
  disable_oiio_threads();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw InputError(file.string(), "no such image; is the sequence complete?");
  }
  const bool is_png = file.extension() == ".png" || file.extension() == ".PNG";
  if (is_png && !has_png_end(file)) {
    throw InputError(file.string(), "is truncated or not a PNG; copy the file again");
  }
  OIIO::ImageSpec keep_alpha;
  keep_alpha.attribute("oiio:UnassociatedAlpha", 1);
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file.string(), &keep_alpha);
  if (!input) {
    throw InputError(file.string(),
                     "cannot be decoded (" + reason(OIIO::geterror()) + "); copy the file again");
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
    throw InputError(file.string(), "is truncated or damaged (" + reason(problem) + "); copy the file again");
  }
  return pixels;
}

/// nullopt if the file is no PNG of a common kind with this depth; OpenImageIO reads it, or describes the
/// fault.
std::optional<DecodedPng> decode_fast(const std::filesystem::path& file, PngPixels pixels, int depth) {
  const std::optional<std::string> bytes = file_bytes(file);
  const std::optional<DecodedPng> png = bytes ? decode_png(*bytes, pixels) : std::nullopt;
  return png && png->image.depth() == depth ? png : std::nullopt;
}

OIIO::ImageSpec spec_of(const cv::Mat& image) {
  const bool supported = image.type() == CV_8UC1 || image.type() == CV_8UC3 || image.type() == CV_16UC1;
  STILLPOINT_CHECK(supported && !image.empty());
  const OIIO::TypeDesc type(image.depth() == CV_16U ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  return {image.cols, image.rows, image.channels(), type};
}

using Bytes = std::vector<unsigned char>;

/// Encodes to a buffer first, because OpenImageIO's PNG writer does not report a full disk.
/// @param format "png" or "jpg"
Bytes encode(const std::filesystem::path& file, const std::string& format, const OIIO::ImageSpec& spec,
             const cv::Mat& image) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput buffer(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format, &buffer);
  STILLPOINT_CHECK(output != nullptr);
  const auto row_bytes = static_cast<OIIO::stride_t>(image.step[0]);
  const bool encoded = output->open("memory." + format, spec) &&
                       output->write_image(spec.format, image.data, OIIO::AutoStride, row_bytes) &&
                       output->close();
  if (!encoded) throw InputError(file.string(), "cannot be encoded (" + reason(output->geterror()) + ")");
  return bytes;
}

/// Writes to a temporary name, then renames, so that no partial file remains.
void write_atomically(const std::filesystem::path& file, const Bytes& bytes) {
  const std::filesystem::path unfinished = file.string() + ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code problem;
  if (out) std::filesystem::rename(unfinished, file, problem);
  if (out && !problem) return;
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  throw InputError(
      file.string(),
      "cannot be written; check that the folder exists and is writable, and that the disk is not full");
}

}  // namespace

cv::Mat read_image(const std::filesystem::path& file) {
  if (const std::optional<DecodedPng> png = decode_fast(file, PngPixels::kAsStored, CV_8U)) return png->image;
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.format != OIIO::TypeDesc(OIIO::TypeDesc::UINT8)) {
    throw InputError(file.string(), "has " + std::to_string(8 * spec.format.size()) +
                                        " bits per channel, expected 8; is it a depth image?");
  }
  return read_pixels(file, *input, spec.nchannels < 3 ? 1 : 3, OIIO::TypeDesc::UINT8);
}

GrayImage read_gray(const std::filesystem::path& file) {
  if (const std::optional<DecodedPng> png = decode_fast(file, PngPixels::kGray, CV_8U)) {
    return {.image = png->image, .is_color = png->is_color};
  }
  const cv::Mat image = read_image(file);
  return {.image = to_gray(image), .is_color = image.channels() == 3};
}

cv::Mat read_depth(const std::filesystem::path& file) {
  if (const std::optional<DecodedPng> png = decode_fast(file, PngPixels::kAsStored, CV_16U))
    return png->image;
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.format != OIIO::TypeDesc(OIIO::TypeDesc::UINT16) || spec.nchannels != 1) {
    throw InputError(file.string(), "has " + std::to_string(spec.nchannels) + " channel(s) of " +
                                        std::to_string(8 * spec.format.size()) +
                                        " bits, but depth has one channel of 16; is it a color image?");
  }
  return read_pixels(file, *input, 1, OIIO::TypeDesc::UINT16);
}

cv::Mat to_gray(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  STILLPOINT_CHECK(image.type() == CV_8UC3);
  cv::Mat gray(image.size(), CV_8UC1);
  for (int row = 0; row < image.rows; ++row) {
    const cv::Vec3b* const rgb = image.ptr<cv::Vec3b>(row);
    std::uint8_t* const out = gray.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column) {
      const cv::Vec3b& pixel = rgb[column];
      out[column] = luma(pixel[0], pixel[1], pixel[2]);
    }
  }
  return gray;
}

std::string image_decoder_version() {
  return "OpenImageIO " + std::to_string(OIIO::openimageio_version()) + " " +
         std::string(OIIO::get_string_attribute("library_list"));
}

void write_png(const std::filesystem::path& file, const cv::Mat& image) {
  disable_oiio_threads();
  OIIO::ImageSpec spec = spec_of(image);
  spec.attribute("png:compressionLevel", kFastCompression);
  spec.attribute("png:filter", kUpFilter);
  spec.attribute("compression", "rle");
  write_atomically(file, encode(file, "png", spec, image));
}

void write_jpeg(const std::filesystem::path& file, const cv::Mat& image, int quality) {
  disable_oiio_threads();
  STILLPOINT_CHECK(image.depth() == CV_8U);
  OIIO::ImageSpec spec = spec_of(image);
  spec.attribute("compression", "jpeg:" + std::to_string(quality));
  write_atomically(file, encode(file, "jpg", spec, image));
}

}  // namespace stillpoint::datasets
