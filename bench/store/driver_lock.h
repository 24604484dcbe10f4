// SPDX-License-Identifier: BSD-3-Clause
/// Tells living drivers from dead ones: each holds a lock on a file, which the kernel drops when it dies.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint {

class DriverLock {
 public:
  /// Enters this process as a driver, with a folder of its own.
  /// @param folder of all drivers of a store; made if need be
  /// @throws InputError if it cannot be written
  explicit DriverLock(std::filesystem::path folder);
  /// Removes the driver's folder with all that is in it.
  ~DriverLock();
  DriverLock(const DriverLock&) = delete;
  DriverLock& operator=(const DriverLock&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::filesystem::path folder() const { return drivers_ / name_; }

  /// Whether the driver of that name lives.
  [[nodiscard]] bool is_alive(const std::string& name) const;

  /// Removes the folders of dead drivers.
  void remove_dead() const;

 private:
  std::filesystem::path drivers_;
  std::string name_;
  int lock_ = -1;
};

}  // namespace stillpoint
