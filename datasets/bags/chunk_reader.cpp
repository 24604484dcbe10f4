// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/chunk_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"
#include "datasets/bags/chunk_codec.h"

namespace stillpoint::datasets {
namespace {

/// The two images of a frame, and those that other threads decode.
constexpr std::size_t kKeptChunks = 8;
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
  const auto bytes =
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
