// SPDX-License-Identifier: BSD-3-Clause
/// The two kinds of failure: input that is wrong, and states that cannot be.
#pragma once

#include <stdexcept>
#include <string>

namespace stillpoint {

/// Wrong input. The message says place, problem and remedy, lower case, without a full stop; programs exit
/// with 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  /// @param place   a file or an option, as the user knows it
  /// @param problem what was found, and the likely remedy after a semicolon
  InputError(const std::string& place, const std::string& problem)
      : std::runtime_error(place + ": " + problem) {}

  /// @param line line number in `file`, counted from 1
  InputError(const std::string& file, long line, const std::string& problem)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + problem) {}
};

/// Ends the program's present work when an invariant of ours does not hold: a bug, never a user's mistake.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace stillpoint

/// Asserts an invariant in every build type.
#define STILLPOINT_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::stillpoint::check_failed(#condition, __FILE__, __LINE__))
