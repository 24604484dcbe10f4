// SPDX-License-Identifier: BSD-3-Clause
/// Whether a faulty row ends the reading of a sequence, or is noted and left out.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace stillpoint {

/// Strict by default: the first fault is thrown. A collecting log serves the sequence doctor.
class FaultLog {
 public:
  enum class Mode { kThrow, kCollect };

  explicit FaultLog(Mode mode = Mode::kThrow) : mode_(mode) {}

  /// Runs `action`; in collecting mode an InputError from it is kept and the reading goes on.
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

  /// Messages of the collected faults, in the order of their discovery.
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

 private:
  Mode mode_;
  std::vector<std::string> messages_;
};

}  // namespace stillpoint
