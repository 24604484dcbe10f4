// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_file.h"

#include <blosc.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <type_traits>
#include <utility>

#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr int kLevel = 5;  ///< default of Blosc
constexpr const char* kCodec = "lz4";

/// The functions with a context take no settings from the environment and start no threads.
std::string compress(const cv::Mat& pixels, int shuffle) {
  const std::size_t bytes = pixels.total() * pixels.elemSize();
  std::string packed(bytes + BLOSC_MAX_OVERHEAD, '\0');
  const int size = blosc_compress_ctx(kLevel, shuffle, pixels.elemSize(), bytes, pixels.data, packed.data(),
                                      packed.size(), kCodec, 0, 1);
  STILLPOINT_CHECK(size > 0);  // incompressible data are stored, which needs the overhead only
  packed.resize(static_cast<std::size_t>(size));
  return packed;
}

std::optional<cv::Mat> decompress(std::string_view packed, cv::Size size, int type) {
  cv::Mat pixels(size, type);
  const std::size_t expected = pixels.total() * pixels.elemSize();
  std::size_t bytes = 0;
  if (packed.size() < BLOSC_MIN_HEADER_LENGTH) return std::nullopt;
  if (blosc_cbuffer_validate(packed.data(), packed.size(), &bytes) != 0 || bytes != expected)
    return std::nullopt;
  const int decompressed = blosc_decompress_ctx(packed.data(), pixels.data, expected, 1);
  if (decompressed < 0 || static_cast<std::size_t>(decompressed) != expected) return std::nullopt;
  return pixels;
}

cv::Mat continuous(const cv::Mat& image) { return image.isContinuous() ? image : image.clone(); }

}  // namespace

PackedFrame pack_frame(const Frame& frame) {
  std::string images = pack_gray(frame.gray);
  const std::size_t gray_bytes = images.size();
  if (!frame.depth.empty()) images += pack_depth(frame.depth);
  return {.has_color = !frame.color.empty() || frame.decode_color,
          .images = std::move(images),
          .gray_bytes = gray_bytes};
}

std::string pack_gray(const cv::Mat& gray) {
  STILLPOINT_CHECK(gray.type() == CV_8UC1 && !gray.empty());
  cv::Mat differences(gray.size(), CV_8UC1);
  gray.row(0).copyTo(differences.row(0));
  for (int row = 1; row < gray.rows; ++row) {
    const std::uint8_t* const above = gray.ptr<std::uint8_t>(row - 1);
    const std::uint8_t* const pixels = gray.ptr<std::uint8_t>(row);
    std::uint8_t* const out = differences.ptr<std::uint8_t>(row);
    for (int column = 0; column < gray.cols; ++column)
      out[column] = static_cast<std::uint8_t>(pixels[column] - above[column]);
  }
  return compress(differences, BLOSC_BITSHUFFLE);
}

std::string pack_depth(const cv::Mat& depth) {
  STILLPOINT_CHECK(depth.type() == CV_16UC1 && !depth.empty());
  return compress(continuous(depth), BLOSC_SHUFFLE);
}

std::optional<cv::Mat> unpack_gray(std::string_view packed, cv::Size size) {
  std::optional<cv::Mat> gray = decompress(packed, size, CV_8UC1);
  if (!gray) return std::nullopt;
  for (int row = 1; row < gray->rows; ++row) {
    const std::uint8_t* const above = gray->ptr<std::uint8_t>(row - 1);
    std::uint8_t* const pixels = gray->ptr<std::uint8_t>(row);
    for (int column = 0; column < gray->cols; ++column)
      pixels[column] = static_cast<std::uint8_t>(pixels[column] + above[column]);
  }
  return gray;
}

std::optional<cv::Mat> unpack_depth(std::string_view packed, cv::Size size) {
  return decompress(packed, size, CV_16UC1);
}

namespace {

static_assert(std::endian::native == std::endian::little, "the structs below are the file format");

constexpr std::array<char, 8> kMagic = {'S', 'P', 'F', 'R', 'A', 'M', 'E', 'S'};

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kFrameFileVersion;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::array<char, 108> sequence{};  ///< ends with a zero
  std::uint64_t checksum = 0;        ///< of everything before
};

struct BlockHeader {
  std::uint32_t frame = 0;
  std::uint32_t has_color = 0;
  std::uint32_t gray_bytes = 0;
  std::uint32_t depth_bytes = 0;
  std::uint64_t checksum = 0;  ///< of everything before, and of both images
};

struct Footer {
  std::uint64_t index_offset = 0;
  std::uint64_t frames = 0;
  std::uint64_t checksum = 0;  ///< of everything before, and of the index
  std::array<char, 8> magic = kMagic;
};

template <class Struct>
std::string bytes_of(const Struct& value) {
  static_assert(std::has_unique_object_representations_v<Struct>, "no padding with undefined values");
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <class Struct>
Struct struct_of(std::string_view bytes) {
  Struct value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::uint64_t checksum_of(const Header& header) {
  return content_hash(bytes_of(header).substr(0, offsetof(Header, checksum)));
}

std::uint64_t checksum_of(const BlockHeader& header, std::string_view images) {
  return content_hash(images, content_hash(bytes_of(header).substr(0, offsetof(BlockHeader, checksum))));
}

std::uint64_t checksum_of(const Footer& footer, std::string_view index) {
  return content_hash(index, content_hash(bytes_of(footer).substr(0, offsetof(Footer, checksum))));
}

/// nullopt if the file ends earlier or cannot be read.
std::optional<std::string> read_at(const FileDescriptor& file, BlockPlace place) {
  std::string bytes(place.bytes, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(file.get(), bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(place.offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::nullopt;
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

std::uint64_t size_of(const FileDescriptor& file) {
  struct stat status {};
  return ::fstat(file.get(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

std::optional<FrameFileInfo> read_info(const FileDescriptor& file) {
  const std::optional<std::string> bytes = read_at(file, {.offset = 0, .bytes = sizeof(Header)});
  if (!bytes) return std::nullopt;
  const auto header = struct_of<Header>(*bytes);
  const bool valid = header.magic == kMagic && header.version == kFrameFileVersion &&
                     header.checksum == checksum_of(header) && header.sequence.back() == '\0';
  if (!valid) return std::nullopt;
  return FrameFileInfo{.sequence = header.sequence.data(), .width = header.width, .height = header.height};
}

std::optional<std::vector<BlockPlace>> read_index(const FileDescriptor& file) {
  const std::uint64_t size = size_of(file);
  if (size < sizeof(Header) + sizeof(Footer)) return std::nullopt;
  const std::uint64_t end = size - sizeof(Footer);
  const std::optional<std::string> bytes = read_at(file, {.offset = end, .bytes = sizeof(Footer)});
  if (!bytes) return std::nullopt;
  const auto footer = struct_of<Footer>(*bytes);
  if (footer.magic != kMagic || footer.index_offset > end) return std::nullopt;
  const std::uint64_t index_bytes = end - footer.index_offset;
  if (index_bytes % sizeof(BlockPlace) != 0 || footer.frames != index_bytes / sizeof(BlockPlace))
    return std::nullopt;
  const std::optional<std::string> index =
      read_at(file, {.offset = footer.index_offset, .bytes = index_bytes});
  if (!index || footer.checksum != checksum_of(footer, *index)) return std::nullopt;
  std::vector<BlockPlace> places(footer.frames);
  if (!places.empty()) std::memcpy(places.data(), index->data(), index->size());
  return places;
}

/// Whether the files of a descriptor and of a path are the same.
bool is_file(const FileDescriptor& file, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(file.get(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Locks the file at `path` until the descriptor is closed. @return false if it is locked, or was renamed
/// meanwhile
bool lock(const FileDescriptor& file, const std::filesystem::path& path) {
  return ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 && is_file(file, path);
}

[[noreturn]] void fail_to_write(const std::filesystem::path& file, int error) {
  throw InputError(file.string(), "cannot be written (" + std::generic_category().message(error) + ")");
}

}  // namespace

FrameFileReader::FrameFileReader(const std::filesystem::path& file)
    : file_(file), descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!descriptor_.is_open()) throw InputError(file.string(), "cannot be opened; check its permissions");
  const std::optional<FrameFileInfo> info = read_info(descriptor_);
  std::optional<std::vector<BlockPlace>> index = read_index(descriptor_);
  if (!info || !index) throw InputError(file.string(), "is truncated or damaged; it can be removed");
  info_ = *info;
  index_ = std::move(*index);
}

std::optional<PackedFrame> FrameFileReader::read(std::size_t index) const {
  STILLPOINT_CHECK(contains(index));
  const BlockPlace place = index_[index];
  if (place.bytes < sizeof(BlockHeader)) return std::nullopt;
  const std::optional<std::string> start =
      read_at(descriptor_, {.offset = place.offset, .bytes = sizeof(BlockHeader)});
  std::optional<std::string> images = read_at(descriptor_, {.offset = place.offset + sizeof(BlockHeader),
                                                            .bytes = place.bytes - sizeof(BlockHeader)});
  if (!start || !images) return std::nullopt;
  const auto header = struct_of<BlockHeader>(*start);
  const bool valid = header.frame == index &&
                     std::uint64_t{header.gray_bytes} + header.depth_bytes == images->size() &&
                     header.checksum == checksum_of(header, *images);
  if (!valid) return std::nullopt;
  return PackedFrame{
      .has_color = header.has_color != 0, .images = std::move(*images), .gray_bytes = header.gray_bytes};
}

void FrameFileReader::mark_used() const {
  const std::array<timespec, 2> now = {timespec{.tv_sec = 0, .tv_nsec = UTIME_NOW},
                                       timespec{.tv_sec = 0, .tv_nsec = UTIME_NOW}};
  // Fails in a read-only folder, where nothing can be removed either.
  static_cast<void>(::futimens(descriptor_.get(), now.data()));
}

std::unique_ptr<FrameFileWriter> FrameFileWriter::create(const std::filesystem::path& partial,
                                                         const FrameFileInfo& info,
                                                         RequireSpace require_space) {
  FileDescriptor file(::open(partial.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!file.is_open()) fail_to_write(partial, errno);
  if (!lock(file, partial)) return nullptr;
  if (::ftruncate(file.get(), 0) != 0) fail_to_write(partial, errno);
  std::unique_ptr<FrameFileWriter> writer(
      new FrameFileWriter(partial, std::move(file), std::move(require_space)));
  Header header{.width = info.width, .height = info.height};
  std::ranges::copy(info.sequence.substr(0, header.sequence.size() - 1), header.sequence.begin());
  header.checksum = checksum_of(header);
  writer->write(bytes_of(header));
  return writer;
}

FrameFileWriter::FrameFileWriter(std::filesystem::path partial, FileDescriptor descriptor,
                                 RequireSpace require_space)
    : partial_(std::move(partial)),
      descriptor_(std::move(descriptor)),
      require_space_(std::move(require_space)) {}

FrameFileWriter::~FrameFileWriter() {
  std::error_code ignored;
  if (!finished_) std::filesystem::remove(partial_, ignored);
}

void FrameFileWriter::write(const std::string& bytes) {
  if (require_space_) require_space_(bytes.size());
  rlimit limit{};  // beyond this limit `write` would raise SIGXFSZ, which ends the process
  const bool limited = ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  if (limited && end_ + bytes.size() > limit.rlim_cur) fail_to_write(partial_, EFBIG);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(descriptor_.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail_to_write(partial_, count < 0 ? errno : ENOSPC);
    done += static_cast<std::size_t>(count);
  }
  end_ += bytes.size();
}

void FrameFileWriter::record(std::size_t index, BlockPlace place) {
  if (index >= index_.size()) {
    index_.resize(index + 1);
    known_.resize(index + 1, false);
  }
  STILLPOINT_CHECK(!known_[index]);
  index_[index] = place;
  known_[index] = true;
  ++recorded_;
}

void FrameFileWriter::append(std::size_t index, const PackedFrame& frame) {
  BlockHeader header{.frame = static_cast<std::uint32_t>(index),
                     .has_color = frame.has_color ? 1U : 0U,
                     .gray_bytes = static_cast<std::uint32_t>(frame.gray().size()),
                     .depth_bytes = static_cast<std::uint32_t>(frame.depth().size())};
  header.checksum = checksum_of(header, frame.images);
  const std::uint64_t offset = end_;
  write(bytes_of(header));
  write(frame.images);
  record(index, {.offset = offset, .bytes = end_ - offset});
}

void FrameFileWriter::append_unreadable(std::size_t index) { record(index, {}); }

void FrameFileWriter::finish(const std::filesystem::path& file) {
  Footer footer{.index_offset = end_, .frames = index_.size()};
  const std::string index(reinterpret_cast<const char*>(index_.data()), index_.size() * sizeof(BlockPlace));
  footer.checksum = checksum_of(footer, index);
  write(index + bytes_of(footer));
  std::error_code error;
  std::filesystem::rename(partial_, file, error);
  if (error) fail_to_write(file, error.value());
  finished_ = true;
}

void remove_abandoned_files(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != kPartialExtension) continue;
    const FileDescriptor file(::open(entry.path().c_str(), O_RDWR | O_CLOEXEC));
    if (file.is_open() && lock(file, entry.path())) std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace stillpoint::datasets
