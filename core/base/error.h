// SPDX-License-Identifier: BSD-3-Clause
/// Error types: invalid input (InputError) and violated internal invariants (STILLPOINT_CHECK).
#pragma once

#include <stdexcept>
#include <string>

namespace stillpoint {

/// Invalid input. The message states location, problem and remedy, in lower case, without a full stop;
/// programs exit with code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}

  /// @param location a file or an option, as the user wrote it
  /// @param problem  what was found, and the likely remedy after a semicolon
  InputError(const std::string& location, const std::string& problem)
      : std::runtime_error(location + ": " + problem) {}

  /// @param file as the user wrote it
  /// @param line line number in `file`, counted from 1
  /// @param problem as above
  InputError(const std::string& file, long line, const std::string& problem)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + problem) {}
};

/// Reports a violated invariant: always a bug in this library, never invalid input.
/// @throws std::logic_error
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace stillpoint

/// Asserts an invariant in every build type.
#define STILLPOINT_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::stillpoint::check_failed(#condition, __FILE__, __LINE__))
