// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_chunks.h"

#include <bzlib.h>
#include <fcntl.h>
#include <isa-l/crc.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::size_t kBlockBytes = 1 << 18;
constexpr int kBz2Level = 9;  ///< blocks of 900 kB, as rosbag writes them

/// Appends decompressed blocks up to a limit.
class Output {
 public:
  Output(std::uint64_t max_bytes, const std::string& place) : max_bytes_(max_bytes), place_(place) {}

  [[nodiscard]] char* block() { return block_.data(); }

  void append(std::size_t count) {
    if (bytes_.size() + count > max_bytes_) fail("has more decompressed bytes than it states");
    bytes_.append(block_.data(), count);
  }

  [[nodiscard]] std::string finish() { return std::move(bytes_); }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(place_, problem + "; the chunk is damaged, copy the file again");
  }

 private:
  std::uint64_t max_bytes_;
  const std::string& place_;
  std::string bytes_;
  std::array<char, kBlockBytes> block_{};
};

struct Bz2End {
  void operator()(bz_stream* stream) const { BZ2_bzDecompressEnd(stream); }
};

std::string decompress_bz2(std::string_view stored, Output& output) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, Bz2End> end(&stream);
  std::string input(stored);  // the library takes no pointer to const
  stream.next_in = input.data();
  stream.avail_in = static_cast<unsigned>(input.size());
  int result = BZ_OK;
  while (result == BZ_OK) {
    stream.next_out = output.block();
    stream.avail_out = kBlockBytes;
    result = BZ2_bzDecompress(&stream);
    const std::size_t count = kBlockBytes - stream.avail_out;
    output.append(count);
    if (result == BZ_OK && count == 0 && stream.avail_in == 0) break;
  }
  if (result != BZ_STREAM_END) output.fail("cannot be decompressed by bzip2");
  return output.finish();
}

struct Lz4End {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

std::string decompress_lz4(std::string_view stored, Output& output) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)) != 0) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, Lz4End> context(created);
  std::size_t expected = 1;  // 0 at the end of a frame
  while (!stored.empty()) {
    std::size_t written = kBlockBytes;
    std::size_t read = stored.size();
    expected = LZ4F_decompress(context.get(), output.block(), &written, stored.data(), &read, nullptr);
    if (LZ4F_isError(expected) != 0 || (written == 0 && read == 0))
      output.fail("cannot be decompressed by LZ4");
    output.append(written);
    stored.remove_prefix(read);
  }
  // The remaining output of a block that was larger than the buffer.
  while (expected != 0) {
    std::size_t written = kBlockBytes;
    std::size_t read = 0;
    expected = LZ4F_decompress(context.get(), output.block(), &written, stored.data(), &read, nullptr);
    if (LZ4F_isError(expected) != 0 || (expected != 0 && written == 0))
      output.fail("ends within an LZ4 frame");
    output.append(written);
  }
  return output.finish();
}

struct ZstdEnd {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

std::string decompress_zstd_frames(std::string_view stored, Output& output) {
  const std::unique_ptr<ZSTD_DCtx, ZstdEnd> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  ZSTD_inBuffer input{.src = stored.data(), .size = stored.size(), .pos = 0};
  std::size_t expected = stored.empty() ? 1 : 0;  // 0 at the end of a frame
  bool full = false;                              // whether the last call filled the block
  while (input.pos < input.size || (full && expected != 0)) {
    ZSTD_outBuffer block{.dst = output.block(), .size = kBlockBytes, .pos = 0};
    expected = ZSTD_decompressStream(context.get(), &block, &input);
    if (ZSTD_isError(expected) != 0) output.fail("cannot be decompressed by zstd");
    full = block.pos == block.size;
    output.append(block.pos);
  }
  if (expected != 0) output.fail("ends within a zstd frame");
  return output.finish();
}

std::string compress_bz2(std::string_view bytes) {
  std::string input(bytes);
  std::string stored(bytes.size() + bytes.size() / 100 + 600, '\0');  // bound of the manual of bzip2
  auto size = static_cast<unsigned>(stored.size());
  const int result = BZ2_bzBuffToBuffCompress(stored.data(), &size, input.data(),
                                              static_cast<unsigned>(input.size()), kBz2Level, 0, 0);
  STILLPOINT_CHECK(result == BZ_OK);
  stored.resize(size);
  return stored;
}

std::string compress_lz4(std::string_view bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockSizeID = LZ4F_max256KB;
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string stored(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(stored.data(), stored.size(), bytes.data(), bytes.size(), &preferences);
  STILLPOINT_CHECK(LZ4F_isError(size) == 0);
  stored.resize(size);
  return stored;
}

std::string compress_zstd(std::string_view bytes) {
  std::string stored(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(stored.data(), stored.size(), bytes.data(), bytes.size(), 1);
  STILLPOINT_CHECK(ZSTD_isError(size) == 0);
  stored.resize(size);
  return stored;
}

}  // namespace

std::optional<ChunkCompression> compression_of(std::string_view name) {
  if (name.empty() || name == "none") return ChunkCompression::kNone;
  if (name == "bz2") return ChunkCompression::kBz2;
  if (name == "lz4") return ChunkCompression::kLz4;
  if (name == "zstd") return ChunkCompression::kZstd;
  return std::nullopt;
}

std::string_view name_of(ChunkCompression compression) {
  switch (compression) {
    case ChunkCompression::kBz2:
      return "bz2";
    case ChunkCompression::kLz4:
      return "lz4";
    case ChunkCompression::kZstd:
      return "zstd";
    default:
      return "none";
  }
}

std::string decompress_chunk(ChunkCompression compression, std::string_view stored, std::uint64_t bytes,
                             const std::string& place) {
  Output output(std::min(bytes, kMaxChunkBytes), place);
  std::string result;
  switch (compression) {
    case ChunkCompression::kBz2:
      result = decompress_bz2(stored, output);
      break;
    case ChunkCompression::kLz4:
      result = decompress_lz4(stored, output);
      break;
    case ChunkCompression::kZstd:
      result = decompress_zstd_frames(stored, output);
      break;
    case ChunkCompression::kNone:
      result = std::string(stored);
      break;
  }
  if (result.size() != bytes) output.fail("has fewer decompressed bytes than it states");
  return result;
}

std::string compress_chunk(ChunkCompression compression, std::string_view bytes) {
  switch (compression) {
    case ChunkCompression::kBz2:
      return compress_bz2(bytes);
    case ChunkCompression::kLz4:
      return compress_lz4(bytes);
    case ChunkCompression::kZstd:
      return compress_zstd(bytes);
    case ChunkCompression::kNone:
      break;
  }
  return std::string(bytes);
}

std::string decompress_zstd(std::string_view stored, const std::string& place) {
  Output output(kMaxChunkBytes, place);
  return decompress_zstd_frames(stored, output);
}

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t previous) {
  return crc32_gzip_refl(previous, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

namespace {

constexpr std::size_t kKeptChunks = 8;          ///< the two images of a frame, and those of other threads
constexpr std::size_t kKeptBytes = 64'000'000;  ///< but at least one chunk

int open_for_reading(const std::filesystem::path& path) {
  require_regular_file(path);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor >= 0) return descriptor;
  throw InputError(path.string(), std::string("cannot be opened (") + std::strerror(errno) + ")");
}

}  // namespace

ByteFile::ByteFile(std::filesystem::path path)
    : path_(std::move(path)), descriptor_(open_for_reading(path_)) {
  struct stat status {};
  if (::fstat(descriptor_.get(), &status) != 0) throw InputError(path_.string(), "cannot be read");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

std::string ByteFile::read(std::uint64_t position, std::uint64_t count) const {
  if (position >= size_) return {};
  std::string bytes(std::min(count, size_ - position), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t part = ::pread(descriptor_.get(), bytes.data() + done, bytes.size() - done,
                                 static_cast<off_t>(position + done));
    if (part < 0 && errno == EINTR) continue;
    if (part <= 0) throw InputError(path_.string(), "cannot be read, or was changed while it was read");
    done += static_cast<std::size_t>(part);
  }
  return bytes;
}

std::shared_ptr<const std::string> ChunkReader::find(std::uint64_t position) const {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find_if(
      chunks_, [position](const Decompressed& kept) { return kept.position == position; });
  if (found == chunks_.end()) return nullptr;
  chunks_.splice(chunks_.begin(), chunks_, found);
  return found->bytes;
}

void ChunkReader::keep(const Decompressed& chunk) const {
  const std::scoped_lock lock(mutex_);
  chunks_.push_front(chunk);
  std::size_t bytes = 0;
  std::size_t kept = 0;
  auto next = chunks_.begin();
  for (; next != chunks_.end() && kept < kKeptChunks; ++next, ++kept) {
    bytes += next->bytes->size();
    if (kept > 0 && bytes > kKeptBytes) break;
  }
  chunks_.erase(next, chunks_.end());
}

std::shared_ptr<const std::string> ChunkReader::chunk_bytes(const BagChunk& chunk) const {
  if (std::shared_ptr<const std::string> bytes = find(chunk.position)) return bytes;
  const std::string place = file_.path().string() + ", chunk at byte " + std::to_string(chunk.position);
  const std::string stored = file_.read(chunk.position, chunk.stored_bytes);
  auto bytes =
      std::make_shared<const std::string>(decompress_chunk(chunk.compression, stored, chunk.bytes, place));
  if (chunk.crc != 0 && crc32_of(*bytes) != chunk.crc)
    throw InputError(place, "the checksum does not match; it is damaged, copy the file again");
  keep({.position = chunk.position, .bytes = bytes});
  return bytes;
}

std::string ChunkReader::read(const BagChunk& chunk, std::uint64_t offset, std::uint64_t count) const {
  if (offset >= chunk.bytes) return {};
  const std::uint64_t available = std::min(count, chunk.bytes - offset);
  if (chunk.compression == ChunkCompression::kNone) return file_.read(chunk.position + offset, available);
  return chunk_bytes(chunk)->substr(offset, available);
}

}  // namespace stillpoint::datasets
