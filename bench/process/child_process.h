// SPDX-License-Identifier: BSD-3-Clause
/// Child processes with a time and a memory limit: a crash or a runaway run fails alone and does not affect
/// the other runs of a plan.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint::bench {

struct ProcessSpec {
  std::filesystem::path program;  ///< searched in PATH if it contains no slash
  std::vector<std::string> arguments;
  std::optional<double> time_limit_s;
  std::optional<std::int64_t> memory_limit_bytes;   ///< resident, of it and its descendants
  std::optional<std::int64_t> message_limit_bytes;  ///< of all messages
  std::vector<int> cores;                           ///< CPU affinity; empty = all processors
  std::filesystem::path folder;                     ///< working directory; empty = inherited
  /// "NAME=value", complete except for STILLPOINT_PROCESS, by which descendants are found that have left the
  /// process group; nullopt = inherited.
  std::optional<std::vector<std::string>> environment;
  std::filesystem::path output;     ///< receives stdout; empty = discarded
  bool output_in_messages = false;  ///< stdout belongs to the messages; `output` is empty
  bool fixed_addresses = false;     ///< disables address space randomization
};

/// Exit status and resource usage of a process.
struct ProcessResult {
  int exit_code = 0;  ///< 0 when terminated by a signal
  int signal = 0;     ///< 0 when it exited
  bool timed_out = false;
  bool out_of_memory = false;        ///< killed at its memory limit
  bool too_many_messages = false;    ///< killed at its message limit
  std::string messages;              ///< at least the last 64 kB
  bool messages_incomplete = false;  ///< earlier ones were discarded
  double wall_s = 0.0;
  double user_s = 0.0;
  double system_s = 0.0;
  /// Of the largest of the process and its descendants. The kernel counts the copy of this process that fork
  /// makes; a smaller child is therefore measured while it runs, first after 1 ms and then every 2 to 100 ms.
  /// Nothing if it ended before.
  std::optional<std::int64_t> peak_memory_bytes{};
};

/// What starts this program again: the running executable, or the launcher of an extracted root file system
/// (scripts/package/launcher.sh), which names itself in STILLPOINT_LAUNCHER.
[[nodiscard]] std::filesystem::path executable_path();

/// CPU affinity of this process.
[[nodiscard]] std::vector<int> allowed_processors();

/// The last non-empty line.
[[nodiscard]] std::string last_line(std::string text);

/// A running child process. It is killed when the parent exits or is killed.
class ChildProcess {
 public:
  /// @throws std::system_error if the process cannot be created
  explicit ChildProcess(const ProcessSpec& spec);
  /// Kills the child if it is still running.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// File descriptor, readable when the child has written to stderr or exited; negative once stderr is
  /// closed.
  [[nodiscard]] int message_pipe() const { return pipe_; }
  /// Longest time to wait for messages before the next `poll_once` [ms].
  [[nodiscard]] int poll_timeout_ms() const;

  /// Reads pending messages, and kills the child if it exceeds a limit. @return false once it has exited
  [[nodiscard]] bool poll_once();

  /// Sends SIGTERM.
  void terminate() const;
  /// Sends SIGKILL to the child, the processes of its group, and those with its mark in their environment.
  void kill_family() const;

  /// Waits for the exit; does not block after `poll_once` returned false.
  [[nodiscard]] ProcessResult wait();

 private:
  void read_messages();
  void close_pipe();
  void kill_descendants() const;
  [[nodiscard]] bool has_exited() const;
  void measure_memory();
  [[nodiscard]] bool is_executed();
  [[nodiscard]] std::optional<std::int64_t> peak_memory_bytes(std::int64_t counted_by_kernel) const;
  void enforce_limits();

  ProcessSpec spec_;
  std::string mark_;  ///< "STILLPOINT_PROCESS=...", in the environment of the child; empty if it is inherited
  pid_t pid_ = -1;
  int pipe_ = -1;
  int execution_pipe_ = -1;                         ///< closed by exec; -1 once it was
  std::int64_t message_bytes_ = 0;                  ///< read so far
  std::chrono::steady_clock::time_point measured_;  ///< the memory
  std::chrono::milliseconds interval_{1};           ///< until it is measured again
  std::int64_t resident_at_fork_ = 0;               ///< of this process [byte]
  std::int64_t resident_ = 0;                       ///< of the child and its descendants, together [byte]
  std::int64_t peak_ = 0;                           ///< of the child [byte]
  std::int64_t peak_of_descendants_ = 0;            ///< of the largest [byte]
  std::chrono::steady_clock::time_point start_;
  ProcessResult result_;
};

/// Runs one child process until it exits.
[[nodiscard]] ProcessResult run_process(const ProcessSpec& spec);

/// Concurrent child processes, managed from one thread.
class ProcessPool {
 public:
  /// @param stop_requested polled at least ten times per second; on true all children get SIGTERM
  /// @param grace time after which those that ignore it, and their children, are killed
  explicit ProcessPool(std::function<bool()> stop_requested,
                       std::chrono::milliseconds grace = std::chrono::seconds(10))
      : stop_requested_(std::move(stop_requested)), grace_(grace) {}

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
  std::chrono::milliseconds grace_;
  std::optional<std::chrono::steady_clock::time_point> stopped_;  ///< when SIGTERM was sent
};

}  // namespace stillpoint::bench
