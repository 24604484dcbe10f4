// SPDX-License-Identifier: BSD-3-Clause
/// Where the time of a plan goes: odometry, images, start of processes, scoring, storing.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "bench/model/stored_run.h"
#include "bench/process/child_process.h"

namespace stillpoint::bench {

/// Durations [s], summed over the executed runs. A worker executes one run at a time; its time is divided
/// among the first group and waiting. The second group is spent on other threads, or while no run is
/// executed.
struct HarnessProfile {
  std::size_t runs = 0;
  int workers = 1;
  double wall_s = 0.0;  ///< of the plan

  double odometry_s = 0.0;       ///< runs, without the next line
  double image_waits_s = 0.0;    ///< runs: the odometry waits for decoded images
  double start_s = 0.0;          ///< from the start of a process to its first frame
  double output_s = 0.0;         ///< from the last frame to the end of a process: scores and files
  double other_process_s = 0.0;  ///< processes without such times: external systems, failures, valgrind

  double decoding_s = 0.0;  ///< of decoding threads
  double rendering_s = 0.0;
  double preparing_s = 0.0;  ///< filling the frame cache, warm-up runs
  double scoring_s = 0.0;    ///< reading results, additional protocols
  double storing_s = 0.0;

  /// Time in which workers execute no run.
  [[nodiscard]] double idle_s() const;
};

/// Adds the process of one run.
[[nodiscard]] HarnessProfile with_run(HarnessProfile profile, const ProcessResult& process,
                                      const RunOutcome& outcome);

/// A table of all durations, with their share of workers x wall time.
[[nodiscard]] std::string profile_text(const HarnessProfile& profile);

/// The members as JSON.
[[nodiscard]] std::string profile_json(const HarnessProfile& profile);

/// Measures from its construction on.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace stillpoint::bench
