// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/driver_lock.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/error.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_lock(const fs::path& file, int error) {
  throw InputError(file.string(),
                   std::string("cannot be locked: ") + std::strerror(error) +
                       "; the folder of the store must be writable, on a disk of this machine");
}

/// Unique among all drivers of all time: process ids come again.
std::string new_name() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::to_string(getpid()) + "-" +
         std::to_string(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace

DriverLock::DriverLock(fs::path folder) : drivers_(std::move(folder)), name_(new_name()) {
  // The lock lies beside the driver's folder and is taken under a name that no one looks for yet, so that
  // there is no moment in which a living driver looks dead.
  const fs::path file = drivers_ / (name_ + ".lock");
  const fs::path unborn = drivers_ / (name_ + ".new");
  std::error_code error;
  fs::create_directories(drivers_ / name_, error);
  if (error) cannot_lock(drivers_ / name_, error.value());
  lock_ = open(unborn.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0 || flock(lock_, LOCK_EX | LOCK_NB) != 0) cannot_lock(unborn, errno);
  fs::rename(unborn, file);
}

DriverLock::~DriverLock() {
  std::error_code ignored;
  fs::remove_all(folder(), ignored);
  fs::remove(drivers_ / (name_ + ".lock"), ignored);
  close(lock_);
}

bool DriverLock::is_alive(const std::string& name) const {
  if (name == name_) return true;
  const int file = open((drivers_ / (name + ".lock")).c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  const bool held = flock(file, LOCK_SH | LOCK_NB) != 0;  // shared: others may be asking at this moment
  close(file);
  return held;
}

void DriverLock::remove_dead() const {
  std::vector<std::string> dead;
  for (const fs::directory_entry& entry : fs::directory_iterator(drivers_)) {
    if (entry.path().extension() == ".lock" && !is_alive(entry.path().stem().string())) {
      dead.push_back(entry.path().stem().string());
    }
  }
  std::error_code ignored;  // another driver may be clearing away the same
  for (const std::string& name : dead) {
    fs::remove_all(drivers_ / name, ignored);
    fs::remove(drivers_ / (name + ".lock"), ignored);
  }
}

}  // namespace stillpoint
