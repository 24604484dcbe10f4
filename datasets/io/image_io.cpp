// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_io.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "datasets/io/file_bytes.h"
#include "datasets/io/image_module.h"
#include "datasets/io/jpeg_encoder.h"
#include "datasets/io/luma.h"
#include "datasets/io/png_decoder.h"
#include "datasets/io/shared_module.h"

namespace stillpoint::datasets {

namespace {

/// Loads OpenImageIO at the first call. @throws InputError if it is not installed
const ImageModule& image_module() {
  static const auto& module =
      *static_cast<const ImageModule*>(module_symbol("imageio", "stillpoint_image_module"));
  return module;
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

/// Decodes by OpenImageIO an image that `decode_png` does not.
LoadedImage load_image(const std::filesystem::path& file, int depth) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw InputError(file.string(), "no such image; is the sequence complete?");
  }
  const bool is_png = file.extension() == ".png" || file.extension() == ".PNG";
  if (is_png && !has_png_end(file)) {
    throw InputError(file.string(), "is truncated or not a PNG; copy the file again");
  }
  LoadedImage image = image_module().load(file, depth);
  if (!image.problem.empty()) throw InputError(file.string(), image.problem + "; copy the file again");
  return image;
}

/// The same for bytes in a buffer.
LoadedImage load_bytes(std::string_view bytes, const std::string& name, int depth) {
  const bool is_png = bytes.starts_with("\x89PNG");
  if (!is_png && !bytes.starts_with("\xff\xd8\xff"))
    throw InputError(name, "is neither a PNG nor a JPEG image");
  if (is_png && bytes.find("IEND") == std::string_view::npos)
    throw InputError(name, "is a truncated PNG; copy the file again");
  LoadedImage image = image_module().decode(bytes, depth);
  if (!image.problem.empty()) throw InputError(name, image.problem + "; copy the file again");
  return image;
}

/// @throws InputError unless the image has 8 bits per channel
cv::Mat color_of(const LoadedImage& image, const std::string& name) {
  if (!image.pixels.empty()) return image.pixels;
  throw InputError(
      name, "has " + std::to_string(image.bits) + " bits per channel, expected 8; is it a depth image?");
}

/// @throws InputError unless the image has one channel of 16 bits
cv::Mat depth_of(const LoadedImage& image, const std::string& name) {
  if (!image.pixels.empty() && image.channels == 1) return image.pixels;
  throw InputError(name, "has " + std::to_string(image.channels) + " channel(s) of " +
                             std::to_string(image.bits) +
                             " bits, but depth has one channel of 16; is it a color image?");
}

/// nullopt if the file is no PNG of a common kind with this depth; OpenImageIO reads it, or describes the
/// fault.
std::optional<DecodedPng> decode_fast(const std::filesystem::path& file, PngPixels pixels, int depth) {
  const std::optional<std::string> bytes = file_bytes(file);
  const std::optional<DecodedPng> png = bytes ? decode_png(*bytes, pixels) : std::nullopt;
  return png && png->image.depth() == depth ? png : std::nullopt;
}

using Bytes = std::vector<unsigned char>;

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
  return color_of(load_image(file, CV_8U), file.string());
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
  return depth_of(load_image(file, CV_16U), file.string());
}

cv::Mat decode_image(std::string_view bytes, const std::string& name) {
  const std::optional<DecodedPng> png = decode_png(bytes);
  return png && png->image.depth() == CV_8U ? png->image : color_of(load_bytes(bytes, name, CV_8U), name);
}

cv::Mat decode_depth(std::string_view bytes, const std::string& name) {
  const std::optional<DecodedPng> png = decode_png(bytes);
  return png && png->image.type() == CV_16UC1 ? png->image : depth_of(load_bytes(bytes, name, CV_16U), name);
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

std::string image_decoder_version() { return image_module().version(); }

void write_png(const std::filesystem::path& file, const cv::Mat& image) {
  const bool supported = image.type() == CV_8UC1 || image.type() == CV_8UC3 || image.type() == CV_16UC1;
  STILLPOINT_CHECK(supported && !image.empty());
  const EncodedImage encoded = image_module().encode_png(image);
  if (!encoded.problem.empty())
    throw InputError(file.string(), "cannot be encoded (" + encoded.problem + ")");
  write_atomically(file, encoded.bytes);
}

void write_jpeg(const std::filesystem::path& file, const cv::Mat& image, int quality) {
  const std::optional<Bytes> bytes = encode_jpeg(image, quality);
  if (!bytes)
    throw InputError(file.string(), "cannot be encoded; JPEG images have at most 65500 rows and columns");
  write_atomically(file, *bytes);
}

}  // namespace stillpoint::datasets
