// SPDX-License-Identifier: BSD-3-Clause
/// The number of the last finished frame in a file, so that a run that crashed can still tell how far it
/// came.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace stillpoint {

/// Its name in a run's folder.
inline constexpr const char* kHeartbeatFile = "heartbeat";

class Heartbeat {
 public:
  /// @throws InputError if the file cannot be made
  explicit Heartbeat(const std::filesystem::path& file);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  void beat(std::int64_t frame) const;

 private:
  int descriptor_;
};

/// Nothing if there is no such file or it has no number yet.
[[nodiscard]] std::optional<std::int64_t> read_heartbeat(const std::filesystem::path& file);

}  // namespace stillpoint
