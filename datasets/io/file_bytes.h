// SPDX-License-Identifier: BSD-3-Clause
/// Reads whole binary files.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <string>

namespace stillpoint::datasets {

/// The content of a file; nullopt if it is missing, no regular file, cannot be read, or becomes shorter
/// meanwhile.
[[nodiscard]] inline std::optional<std::string> file_bytes(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait for pipes
  if (descriptor < 0) return std::nullopt;
  struct stat status {};
  const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  std::string bytes(regular ? static_cast<std::size_t>(status.st_size) : 0, '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  ::close(descriptor);
  return regular && done == bytes.size() ? std::make_optional(std::move(bytes)) : std::nullopt;
}

}  // namespace stillpoint::datasets
