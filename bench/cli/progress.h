// SPDX-License-Identifier: BSD-3-Clause
/// A line on the terminal that counts up and guesses the rest; silent where stderr is no terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace stillpoint {

class ProgressLine {
 public:
  /// @param unit what is counted, e.g. "frames"
  ProgressLine(std::string label, std::size_t total, std::string unit);
  /// Wipes the line.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Redraws at most ten times a second.
  void update(std::size_t done);

  /// Makes room for other lines.
  void wipe() const;
  void draw() const;

 private:
  std::string label_;
  std::size_t total_;
  std::string unit_;
  bool visible_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
};

/// A span for people: "50 s", "3 min", "2 h 5 min".
[[nodiscard]] std::string span_text(double seconds);

}  // namespace stillpoint
