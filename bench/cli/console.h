// SPDX-License-Identifier: BSD-3-Clause
/// What commands that run long share on a terminal: a progress line, and SIGINT and SIGTERM, of which the
/// first requests a stop and the second one terminates the process.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace stillpoint::bench {

/// Installs one-shot handlers for SIGINT and SIGTERM that set a flag.
void install_interrupt_handlers();

/// True once a handler of `install_interrupt_handlers` was called.
[[nodiscard]] bool interrupt_requested();

/// Ends a command that has no result after an interruption: the program prints so and exits with 130.
struct Interrupted {};

/// @throws Interrupted after `interrupt_requested`
void require_uninterrupted();

/// Blocks SIGINT and SIGTERM in this thread and in threads created by it later.
void block_interrupts();

/// Waits for SIGINT or SIGTERM, which must be blocked (`block_interrupts`).
void wait_for_interrupt();

/// The same, for at most `time`. @return whether there was a signal
[[nodiscard]] bool interrupted_within(std::chrono::milliseconds time);

/// Progress line on stderr with rate and estimated remaining time. If stderr is not a terminal, a new line
/// every 10 s.
class ProgressLine {
 public:
  /// @param unit of the counts, e.g. "frames"
  ProgressLine(std::string label, std::size_t total, std::string unit);
  /// Clears the line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Redraws at most 10 times per second on a terminal.
  void update(std::size_t done);
  /// The same with another label.
  void update(std::size_t done, std::string label);

  /// Clears the line of a terminal, so that other output can be printed; `draw` restores it.
  void clear() const;
  void draw() const;

 private:
  [[nodiscard]] std::string text() const;

  std::string label_;
  std::size_t total_;
  std::string unit_;
  bool visible_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
};

/// Number, duration and rate of executed runs: "12 runs in 3 min, 4.1 runs per minute".
[[nodiscard]] std::string rate_text(std::size_t runs, double seconds);

/// Human-readable duration: "50 s", "3 min", "2 h 5 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace stillpoint::bench
