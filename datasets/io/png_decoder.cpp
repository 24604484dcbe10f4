// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/png_decoder.h"

#include <libdeflate.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/io/luma.h"

namespace stillpoint::datasets {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kChunkOverhead = 12;  ///< length, type and checksum
constexpr std::uint32_t kMaxSide_px = 1 << 15;
constexpr std::size_t kMaxCompression = 1100;  ///< of deflate: 1032

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

/// Parts of a PNG file that are supported.
struct PngFile {
  int width = 0;
  int height = 0;
  int bits = 0;
  int channels = 0;
  std::string compressed;  ///< the joined IDAT chunks

  [[nodiscard]] std::size_t pixel_bytes() const { return static_cast<std::size_t>(channels * bits / 8); }
  [[nodiscard]] std::size_t row_bytes() const { return static_cast<std::size_t>(width) * pixel_bytes(); }
};

/// The fields of the IHDR chunk; nullopt for kinds of images that are not supported.
std::optional<PngFile> read_header(std::string_view data) {
  if (data.size() != 13) return std::nullopt;
  const std::uint32_t width = big_endian(data);
  const std::uint32_t height = big_endian(data.substr(4));
  const int bits = data[8];
  const int color_type = data[9];  // 0: gray, 2: RGB
  const bool supported = (color_type == 0 && (bits == 8 || bits == 16)) || (color_type == 2 && bits == 8);
  const bool plain = data[10] == 0 && data[11] == 0 && data[12] == 0;  // compression, filters, interlacing
  const bool valid_size = width > 0 && height > 0 && width <= kMaxSide_px && height <= kMaxSide_px;
  if (!supported || !plain || !valid_size) return std::nullopt;
  return PngFile{.width = static_cast<int>(width),
                 .height = static_cast<int>(height),
                 .bits = bits,
                 .channels = color_type == 0 ? 1 : 3,
                 .compressed = {}};
}

/// Reads the chunks up to IEND. Checksums are those that libpng requires, too.
std::optional<PngFile> read_chunks(std::string_view bytes) {
  if (!bytes.starts_with(kSignature)) return std::nullopt;
  bytes.remove_prefix(kSignature.size());
  std::optional<PngFile> file;
  while (bytes.size() >= kChunkOverhead) {
    const std::size_t length = big_endian(bytes);
    if (length > bytes.size() - kChunkOverhead) return std::nullopt;
    const std::string_view type = bytes.substr(4, 4);
    const std::string_view data = bytes.substr(8, length);
    const std::uint32_t checksum = libdeflate_crc32(0, type.data(), 4 + length);
    if (checksum != big_endian(bytes.substr(8 + length))) return std::nullopt;
    if (!file) {
      if (type != "IHDR") return std::nullopt;
      file = read_header(data);
      if (!file) return std::nullopt;
    } else if (type == "IDAT") {
      file->compressed += data;
    } else if (type == "IEND") {
      return file;
    } else if (type == "tRNS" || type == "PLTE") {
      return std::nullopt;
    }
    bytes.remove_prefix(kChunkOverhead + length);
  }
  return std::nullopt;
}

/// The filtered rows, each after the byte of its filter; null if the data are damaged.
std::unique_ptr<std::uint8_t[]> decompress(const PngFile& file) {
  const std::size_t bytes = (file.row_bytes() + 1) * static_cast<std::size_t>(file.height);
  if (bytes / kMaxCompression > file.compressed.size()) return nullptr;
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) return nullptr;
  auto rows = std::make_unique_for_overwrite<std::uint8_t[]>(bytes);
  const libdeflate_result result =
      libdeflate_zlib_decompress(decompressor.get(), file.compressed.data(), file.compressed.size(),
                                 rows.get(), bytes, nullptr);  // an error unless all of `rows` is written
  return result == LIBDEFLATE_SUCCESS ? std::move(rows) : nullptr;
}

/// PNG specification, Sec. 9.4: the neighbor a (left), b (above) or c (above left) nearest to a + b - c.
std::uint8_t paeth(int a, int b, int c) {
  const int distance_a = std::abs(b - c);
  const int distance_b = std::abs(a - c);
  const int distance_c = std::abs(a + b - 2 * c);
  const int nearest_bc = distance_b <= distance_c ? b : c;
  return static_cast<std::uint8_t>(distance_a <= distance_b && distance_a <= distance_c ? a : nearest_bc);
}

/// A row of `size` bytes, and the row above.
struct FilteredRow {
  std::uint8_t* row;
  const std::uint8_t* above;
  std::size_t size;
};

void undo_up(const FilteredRow& f) {
  for (std::size_t i = 0; i < f.size; ++i) f.row[i] = static_cast<std::uint8_t>(f.row[i] + f.above[i]);
}

/// Filters that use the pixel to the left, `kPixel` bytes before.
template <std::size_t kPixel>
bool undo_filter(int filter, const FilteredRow& f) {
  const auto undo = [&f](auto predict) {
    for (std::size_t i = 0; i < kPixel; ++i)
      f.row[i] = static_cast<std::uint8_t>(f.row[i] + predict(0, f.above[i], 0));
    for (std::size_t i = kPixel; i < f.size; ++i) {
      f.row[i] =
          static_cast<std::uint8_t>(f.row[i] + predict(f.row[i - kPixel], f.above[i], f.above[i - kPixel]));
    }
  };
  switch (filter) {
    case 0:
      return true;
    case 1:
      undo([](int a, int, int) { return a; });
      return true;
    case 2:
      undo_up(f);
      return true;
    case 3:
      undo([](int a, int b, int) { return (a + b) / 2; });
      return true;
    case 4:
      undo([](int a, int b, int c) { return paeth(a, b, c); });
      return true;
    default:
      return false;
  }
}

bool undo_filter(const PngFile& file, int filter, const FilteredRow& row) {
  switch (file.pixel_bytes()) {
    case 1:
      return undo_filter<1>(filter, row);
    case 2:
      return undo_filter<2>(filter, row);
    default:
      return undo_filter<3>(filter, row);
  }
}

/// Copies an unfiltered row to the image.
void write_row(const PngFile& file, const std::uint8_t* row, int index, cv::Mat& image) {
  if (file.bits == 16) {
    std::uint16_t* const out = image.ptr<std::uint16_t>(index);
    for (int i = 0; i < file.width; ++i)
      out[i] = static_cast<std::uint16_t>(row[2 * i] << 8 | row[2 * i + 1]);
  } else if (file.channels == image.channels()) {
    std::memcpy(image.ptr(index), row, file.row_bytes());
  } else {
    std::uint8_t* const out = image.ptr(index);
    for (int i = 0; i < file.width; ++i) out[i] = luma(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
  }
}

}  // namespace

std::optional<DecodedPng> decode_png(std::string_view bytes, PngPixels pixels) {
  const std::optional<PngFile> file = read_chunks(bytes);
  if (!file) return std::nullopt;
  const std::unique_ptr<std::uint8_t[]> rows = decompress(*file);
  if (!rows) return std::nullopt;
  const int channels = pixels == PngPixels::kGray ? 1 : file->channels;
  cv::Mat image(file->height, file->width, CV_MAKETYPE(file->bits == 16 ? CV_16U : CV_8U, channels));
  const std::vector<std::uint8_t> zeros(file->row_bytes(), 0);  // above the first row
  const std::uint8_t* above = zeros.data();
  for (int i = 0; i < file->height; ++i) {
    std::uint8_t* const filtered = rows.get() + static_cast<std::size_t>(i) * (file->row_bytes() + 1);
    const FilteredRow row{.row = filtered + 1, .above = above, .size = file->row_bytes()};
    if (!undo_filter(*file, filtered[0], row)) return std::nullopt;
    write_row(*file, row.row, i, image);
    above = row.row;
  }
  return DecodedPng{.image = image, .is_color = file->channels == 3};
}

}  // namespace stillpoint::datasets
