// SPDX-License-Identifier: BSD-3-Clause
/// Invalid input and violated invariants: their error types (`InputError`, `STILLPOINT_CHECK`), the policy of
/// readers (throw at the first faulty record, or skip it and collect the message), and checks of input paths
/// and names.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

namespace stillpoint {

/// Error policy of a reader. Throws at the first fault by default; validators use the collecting mode.
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

/// Rejects input paths that are not files, before they are opened: opening a named pipe blocks until another
/// process writes to it, and devices may never end.
/// @throws InputError if `file` is a folder, pipe, socket or device; a missing file is accepted, as the
/// caller reports it when it opens the file
void require_regular_file(const std::filesystem::path& file);

/// Whether `text` is valid UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF). JSON, HTML
/// and the terminal cannot represent other bytes.
[[nodiscard]] bool is_utf8(std::string_view text);

/// `text` with each byte that is not part of valid UTF-8 written as `\xNN`.
[[nodiscard]] std::string escaped_utf8(std::string_view text);

/// @param what kind of name, e.g. "sequence name"
/// @param name the name to check
/// @throws InputError if `name` is not valid UTF-8; the message contains it escaped
void require_utf8(const std::string& what, std::string_view name);

}  // namespace stillpoint
