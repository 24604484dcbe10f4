// SPDX-License-Identifier: BSD-3-Clause
/// Error policy of readers: throw at the first faulty record, or skip it and collect the message.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace stillpoint {

/// Throws at the first fault by default; validators use the collecting mode.
class FaultLog {
 public:
  enum class Mode { kThrow, kCollect };

  explicit FaultLog(Mode mode = Mode::kThrow) : mode_(mode) {}

  /// Runs `action`; in collecting mode an InputError that it throws is recorded instead of propagated.
  template <class Action>
  void guard(Action&& action) {
    if (mode_ == Mode::kThrow) {
      std::forward<Action>(action)();
      return;
    }
    try {
      std::forward<Action>(action)();
    } catch (const InputError& error) {
      messages_.emplace_back(error.what());
    }
  }

  /// Messages of the collected faults, in the order of detection.
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

 private:
  Mode mode_;
  std::vector<std::string> messages_;
};

}  // namespace stillpoint
