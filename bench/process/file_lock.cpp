// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/file_lock.h"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/system_resources.h"

namespace stillpoint::bench {

FileLock::FileLock(const std::filesystem::path& file, LockKind kind,
                   const std::function<bool()>& stop_requested)
    : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  int result = descriptor_ < 0 ? -1 : 0;
  while (descriptor_ >= 0) {
    result = flock(descriptor_, kind == LockKind::kShared ? LOCK_SH : LOCK_EX);
    if (result == 0 || errno != EINTR) break;
    if (stop_requested && stop_requested()) return;
  }
  if (result == 0) return;
  const int error = errno;
  if (descriptor_ >= 0) close(descriptor_);
  require_resources(error, file.string());
  throw InputError(file.string(), std::string("cannot be locked: ") + std::strerror(error) +
                                      "; its folder must be writable and support locks");
}

FileLock::~FileLock() { close(descriptor_); }

bool is_locked(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool is_free = flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  close(descriptor);
  return !is_free;
}

}  // namespace stillpoint::bench
