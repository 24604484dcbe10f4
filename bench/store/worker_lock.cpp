// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/worker_lock.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_lock(const fs::path& file, int error) {
  throw InputError(file.string(), std::string("cannot be locked: ") + std::strerror(error) +
                                      "; the folder of the store must be writable and on a local disk");
}

/// Unique over time, too: process ids are reused.
std::string new_name() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::to_string(getpid()) + "-" +
         std::to_string(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace

WorkerLock::WorkerLock(fs::path folder) : workers_(std::move(folder)), name_(new_name()) {
  // The file is locked under a temporary name and renamed afterwards, so that no other worker finds it
  // unlocked and takes this one for dead.
  const fs::path file = workers_ / (name_ + ".lock");
  const fs::path pending = workers_ / (name_ + ".new");
  std::error_code error;
  fs::create_directories(workers_ / name_, error);
  if (error) cannot_lock(workers_ / name_, error.value());
  lock_ = open(pending.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0 || flock(lock_, LOCK_EX | LOCK_NB) != 0) cannot_lock(pending, errno);
  fs::rename(pending, file);
}

WorkerLock::~WorkerLock() {
  std::error_code ignored;
  fs::remove_all(folder(), ignored);
  fs::remove(workers_ / (name_ + ".lock"), ignored);
  close(lock_);
}

bool WorkerLock::is_alive(const std::string& name) const {
  if (name == name_) return true;
  const int file = open((workers_ / (name + ".lock")).c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) != 0;  // shared: other workers may test it, too
  close(file);
  return locked;
}

void WorkerLock::remove_stale() const {
  std::vector<std::string> dead;
  for (const fs::directory_entry& entry : fs::directory_iterator(workers_)) {
    if (entry.path().extension() == ".lock" && !is_alive(entry.path().stem().string())) {
      dead.push_back(entry.path().stem().string());
    }
  }
  std::error_code ignored;  // another worker may be removing the same files
  for (const std::string& name : dead) {
    fs::remove_all(workers_ / name, ignored);
    fs::remove(workers_ / (name + ".lock"), ignored);
  }
}

}  // namespace stillpoint::bench
