// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/heartbeat.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/error.h"

namespace stillpoint::bench {

namespace {

/// @return the file, unless it contains something else than a heartbeat
const std::filesystem::path& checked(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) &&
      std::filesystem::file_size(file, error) > sizeof(std::int64_t))
    throw InputError(file.string(), "exists and is no heartbeat file; remove it or choose another name");
  return file;
}

}  // namespace

Heartbeat::Heartbeat(const std::filesystem::path& file)
    : descriptor_(open(checked(file).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw InputError(file.string(),
                     std::string("cannot be written: ") + std::strerror(errno) + "; check its folder");
  }
}

Heartbeat::~Heartbeat() { close(descriptor_); }

void Heartbeat::beat(std::int64_t frame) const {
  // One write of 8 bytes, so that a reader never sees a partial number. A failure does not abort the run.
  static_cast<void>(!pwrite(descriptor_, &frame, sizeof frame, 0));
}

std::optional<std::int64_t> read_heartbeat(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::int64_t frame = 0;
  if (!stream.read(reinterpret_cast<char*>(&frame), sizeof frame)) return std::nullopt;
  return frame;
}

}  // namespace stillpoint::bench
