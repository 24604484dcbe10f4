// SPDX-License-Identifier: BSD-3-Clause
/// Concurrent child processes, managed from one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/process/child_process.h"

namespace stillpoint::bench {

class ProcessPool {
 public:
  /// @param stop_requested polled at least ten times per second; on true all children get SIGTERM
  explicit ProcessPool(std::function<bool()> stop_requested) : stop_requested_(std::move(stop_requested)) {}

  /// @param tag returned by `wait_next` with the result of this child
  void start(std::size_t tag, const ProcessSpec& spec);

  /// Waits until a child exits.
  /// @param wake polled at least ten times per second; on true the waiting ends
  /// @return nothing if none is running, or on `wake`
  [[nodiscard]] std::optional<std::pair<std::size_t, ProcessResult>> wait_next(
      const std::function<bool()>& wake = {});

  [[nodiscard]] std::size_t running() const { return children_.size(); }

 private:
  struct Entry {
    std::size_t tag;
    std::unique_ptr<ChildProcess> child;
  };

  void forward_stop();
  void wait_for_messages() const;

  std::function<bool()> stop_requested_;
  std::vector<Entry> children_;
  bool stop_forwarded_ = false;
};

}  // namespace stillpoint::bench
