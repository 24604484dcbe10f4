// SPDX-License-Identifier: BSD-3-Clause
/// Several children at once, from one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/process/child_process.h"

namespace stillpoint {

class ProcessPool {
 public:
  /// @param stop_requested asked at least ten times a second; when true the children are asked to end
  explicit ProcessPool(std::function<bool()> stop_requested) : stop_requested_(std::move(stop_requested)) {}

  /// @param tag comes back with the end of this child
  void start(std::size_t tag, const ProcessSpec& spec);

  /// Waits for the next child to end.
  /// @return nothing if none is running
  [[nodiscard]] std::optional<std::pair<std::size_t, ProcessEnd>> wait_next();

  [[nodiscard]] std::size_t running() const { return children_.size(); }

 private:
  struct Entry {
    std::size_t tag;
    std::unique_ptr<ChildProcess> child;
  };

  void pass_on_stop();
  void wait_for_messages() const;

  std::function<bool()> stop_requested_;
  std::vector<Entry> children_;
  bool stop_passed_on_ = false;
};

}  // namespace stillpoint
