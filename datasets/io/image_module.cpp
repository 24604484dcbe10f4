// SPDX-License-Identifier: BSD-3-Clause
/// Source of libstillpoint_imageio.so. It is linked with no other source of the project.
#include "datasets/io/image_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <memory>
#include <string>

namespace stillpoint::datasets {
namespace {

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

std::string with_remedy(const std::string& problem) { return problem + "; copy the file again"; }

/// The pixels of an opened image.
LoadedImage pixels_of(OIIO::ImageInput& input, int depth) {
  const OIIO::ImageSpec& spec = input.spec();
  LoadedImage image{.channels = spec.nchannels, .bits = static_cast<int>(8 * spec.format.size())};
  const bool is_float = spec.format == OIIO::TypeDesc::FLOAT || spec.format == OIIO::TypeDesc::HALF ||
                        spec.format == OIIO::TypeDesc::DOUBLE;
  const bool has_meters = depth == CV_16U && is_float && spec.nchannels == 1;
  const bool deep_color = depth == CV_8U && spec.format == OIIO::TypeDesc::UINT16;
  if (has_meters) depth = CV_32F;
  const OIIO::TypeDesc type(depth == CV_32F   ? OIIO::TypeDesc::FLOAT
                            : depth == CV_16U ? OIIO::TypeDesc::UINT16
                                              : OIIO::TypeDesc::UINT8);
  if (spec.format != type && !deep_color && !has_meters) return image;
  if (std::int64_t{spec.width} * spec.height > kMostPixels) {
    image.problem = "has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                    " pixels, more than " + std::to_string(kMostPixels) + "; reduce its size";
    return image;
  }
  const int channels = spec.nchannels < 3 ? 1 : 3;
  image.pixels.create(spec.height, spec.width, CV_MAKETYPE(depth, channels));
  const bool complete = input.read_image(0, 0, 0, channels, type, image.pixels.data);
  const std::string problem = input.geterror();
  if (!complete || !problem.empty())
    image.problem = with_remedy("is truncated or damaged (" + reason(problem) + ")");
  return image;
}

LoadedImage load(const std::filesystem::path& file, int depth) {
  disable_oiio_threads();
  OIIO::ImageSpec keep_alpha;
  keep_alpha.attribute("oiio:UnassociatedAlpha", 1);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file.string(), &keep_alpha);
  if (!input) return {.problem = with_remedy("cannot be decoded (" + reason(OIIO::geterror()) + ")")};
  return pixels_of(*input, depth);
}

LoadedImage decode(std::string_view bytes, int depth) {
  disable_oiio_threads();
  OIIO::Filesystem::IOMemReader buffer(bytes.data(), bytes.size());
  // The readers take the bytes from this attribute; the argument of `ImageInput::open` does not reach that
  // of JPEG.
  OIIO::Filesystem::IOProxy* const proxy = &buffer;
  OIIO::ImageSpec settings;
  settings.attribute("oiio:UnassociatedAlpha", 1);
  settings.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const bool is_png = bytes.starts_with("\x89PNG");
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(is_png ? "png" : "jpg");
  if (!input) return {.problem = with_remedy("cannot be decoded (" + reason(OIIO::geterror()) + ")")};
  OIIO::ImageSpec ignored;
  if (!input->open(is_png ? "memory.png" : "memory.jpg", ignored, settings))
    return {.problem = with_remedy("cannot be decoded (" + reason(input->geterror()) + ")")};
  return pixels_of(*input, depth);
}

std::string version() {
  return "OpenImageIO " + std::to_string(OIIO::openimageio_version()) + " " +
         std::string(OIIO::get_string_attribute("library_list"));
}

}  // namespace

extern "C" const ImageModule stillpoint_image_module;
const ImageModule stillpoint_image_module = {.load = load, .decode = decode, .version = version};

}  // namespace stillpoint::datasets
