// SPDX-License-Identifier: BSD-3-Clause
/// A program as a child with limits of its own, so that a crash or a runaway run costs one row and not the
/// table.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace stillpoint {

struct ProcessSpec {
  std::filesystem::path program;  ///< searched in PATH when it has no slash
  std::vector<std::string> arguments;
  std::optional<double> time_limit_s;
  std::optional<std::int64_t> memory_limit_bytes;       ///< of resident memory
  std::vector<int> cores;                               ///< processors it may use; empty = all
  std::filesystem::path folder;                         ///< that it works in; empty = ours
  std::optional<std::vector<std::string>> environment;  ///< "NAME=value", all there is; nothing = ours
  bool fixed_addresses = false;                         ///< the same memory layout at each start
};

/// How a process ended, and what it took.
struct ProcessEnd {
  int exit_code = 0;  ///< 0 when a signal ended it
  int signal = 0;     ///< 0 when it ended by itself
  bool timed_out = false;
  bool out_of_memory = false;  ///< ended by us at its memory limit
  std::string messages;        ///< what it wrote to stderr, the last 64 kB
  double wall_s = 0.0;
  double user_s = 0.0;
  double system_s = 0.0;
  std::int64_t peak_memory_bytes = 0;
};

/// This program's own file.
[[nodiscard]] std::filesystem::path own_program();

/// Processors that this process may use.
[[nodiscard]] std::vector<int> allowed_processors();

/// The last line that is not empty.
[[nodiscard]] std::string last_line(std::string text);

/// A running child. It dies with us, even when we are killed.
class ChildProcess {
 public:
  /// @throws std::system_error if no process can be made
  explicit ChildProcess(const ProcessSpec& spec);
  /// Kills a child that still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Readable when the child has written messages or has ended; negative when it has closed them.
  [[nodiscard]] int message_pipe() const { return pipe_; }
  /// How long to wait for messages before the next `attend` [ms].
  [[nodiscard]] int patience_ms() const;

  /// Takes in what can be read, and ends a child that is beyond a limit. @return false once it has ended
  [[nodiscard]] bool attend();

  /// Asks the child to end.
  void ask_to_end() const;

  /// Waits for the end; a child that `attend` has seen ended is there at once.
  [[nodiscard]] ProcessEnd wait();

 private:
  void read_messages();
  void close_pipe();
  [[nodiscard]] bool has_ended() const;
  void enforce_limits();

  ProcessSpec spec_;
  pid_t pid_ = -1;
  int pipe_ = -1;
  std::chrono::steady_clock::time_point start_;
  ProcessEnd end_;
};

/// Runs one child to its end.
[[nodiscard]] ProcessEnd run_process(const ProcessSpec& spec);

}  // namespace stillpoint
