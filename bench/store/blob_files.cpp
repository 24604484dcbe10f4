// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/blob_files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kCompressionLevel = 3;
constexpr std::uint64_t kSecondSeed = 1;
constexpr std::string_view kSuffix = ".zst";

std::string compressed(std::string_view content) {
  std::string out(ZSTD_compressBound(content.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), content.data(), content.size(), kCompressionLevel);
  STILLPOINT_CHECK(ZSTD_isError(size) == 0);
  out.resize(size);
  return out;
}

InputError damaged(const fs::path& file, const std::string& how) {
  return {
      file.string(),
      how +
          "; restore it with `stillpoint store merge COPY --store STORE` if there is a copy of the store, "
          "or save the rest with `stillpoint store salvage STORE OUT`"};
}

std::string decompressed(const std::string& packed, const fs::path& file) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw damaged(file, "is not a zstd file");
  if (size / 100'000 > packed.size()) throw damaged(file, "has an implausible content size");
  std::string content(size, '\0');
  const std::size_t got = ZSTD_decompress(content.data(), content.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) != 0 || got != size) throw damaged(file, "cannot be decompressed");
  return content;
}

[[noreturn]] void cannot_write(const fs::path& file, int error) {
  throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(error) +
                                      "; free space on the disk and retry, or give another --store");
}

/// Writes a file and syncs it to disk.
void write_through(const fs::path& file, const std::string& bytes) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) cannot_write(file, errno);
  std::size_t done = 0;
  int error = 0;
  while (done < bytes.size() && error == 0) {
    const ssize_t wrote = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (wrote > 0) done += static_cast<std::size_t>(wrote);
    if (wrote < 0 && errno != EINTR) error = errno;
  }
  if (error == 0 && fsync(descriptor) != 0) error = errno;
  close(descriptor);
  if (error == 0) return;
  std::error_code ignored;
  fs::remove(file, ignored);
  cannot_write(file, error);
}

}  // namespace

std::string blob_name(std::string_view content) {
  return hash_text(content_hash(content)) + hash_text(content_hash(content, kSecondSeed));
}

fs::path BlobFiles::file(const std::string& name) const {
  return folder_ / name.substr(0, 2) / (name + std::string(kSuffix));
}

std::string BlobFiles::put(std::string_view content) const {
  std::string name = blob_name(content);
  const fs::path target = file(name);
  if (is_readable(name)) return name;
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  if (error) cannot_write(target.parent_path(), error.value());
  const fs::path temporary = target.string() + "." + std::to_string(gettid());
  write_through(temporary, compressed(content));
  fs::rename(temporary, target);
  return name;
}

std::string BlobFiles::get(const std::string& name) const {
  const fs::path path = file(name);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw damaged(path, "is missing or cannot be read");
  std::ostringstream packed;
  packed << stream.rdbuf();
  std::string content = decompressed(packed.str(), path);
  if (blob_name(content) != name) throw damaged(path, "has content that does not match its hash");
  return content;
}

bool BlobFiles::is_readable(const std::string& name) const {
  if (!fs::exists(file(name))) return false;
  try {
    static_cast<void>(get(name));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> BlobFiles::names() const {
  std::vector<std::string> found;
  if (!fs::is_directory(folder_)) return found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
    if (entry.is_regular_file() && entry.path().extension() == kSuffix)
      found.push_back(entry.path().stem().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

void BlobFiles::remove(const std::string& name) const { fs::remove(file(name)); }

}  // namespace stillpoint::bench
