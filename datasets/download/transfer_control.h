// SPDX-License-Identifier: BSD-3-Clause
/// How long operations of this folder report their progress and are stopped.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace stillpoint::datasets {

/// Empty functions are not called.
struct TransferControl {
  /// Bytes that are complete, and their total; the total is 0 while it is not known.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  std::function<bool()> stop;  ///< true: end the operation, and keep what a later one can continue
  std::function<void(const std::string&)> report;  ///< one line about a retry or another mirror
};

[[nodiscard]] inline bool is_stopped(const TransferControl& control) {
  return control.stop && control.stop();
}
inline void report_progress(const TransferControl& control, std::uint64_t done, std::uint64_t total) {
  if (control.progress) control.progress(done, total);
}
inline void report_line(const TransferControl& control, const std::string& text) {
  if (control.report) control.report(text);
}

}  // namespace stillpoint::datasets
