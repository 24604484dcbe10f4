// SPDX-License-Identifier: BSD-3-Clause
/// File with the id of the last processed frame; reports the progress of a run, also after a crash.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace stillpoint::bench {

/// File name in a run's folder.
inline constexpr const char* kHeartbeatFile = "heartbeat";

class Heartbeat {
 public:
  /// @throws InputError if the file cannot be created, or exists with other content
  explicit Heartbeat(const std::filesystem::path& file);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  void beat(std::int64_t frame) const;

 private:
  int descriptor_;
};

/// Nothing if the file does not exist or is empty.
[[nodiscard]] std::optional<std::int64_t> read_heartbeat(const std::filesystem::path& file);

}  // namespace stillpoint::bench
