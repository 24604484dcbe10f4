// SPDX-License-Identifier: BSD-3-Clause
/// Systems that can be benchmarked: run on a sequence, write a trajectory. The interface, and its
/// implementation by the odometry of this project; that by external systems is in external_run.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/config/config_file.h"
#include "bench/model/stored_run.h"
#include "bench/process/child_process.h"

namespace stillpoint::bench {

/// A run to execute.
struct RunRequest {
  RunIdentity identity;
  ConfigRequest config;            ///< of this odometry
  int max_frames = 0;              ///< 0 = all
  double start_s = 0.0;            ///< time after the first frame at which the run begins
  int gray_noise = 0;              ///< of this odometry: seed, see datasets/faults/gray_noise.h; 0 = none
  std::string fault;               ///< sensor fault to inject; empty = none
  std::filesystem::path program;   ///< executable of this odometry; empty = the current executable
  std::string commit_time;         ///< UTC, of a program that was built from a commit; empty = unknown
  std::filesystem::path sequence;  ///< folder
  std::filesystem::path work;      ///< exclusive output folder of the run
  int images = 0;                  ///< number of annotated images of its worst frames
  bool frame_cache = true;         ///< this odometry uses the frame cache
  double time_limit_s = 0.0;       ///< of a container; 0 = none
  int memory_limit_mb = 0;         ///< same
};

/// Starts a system and reads its results.
class SlamSystem {
 public:
  virtual ~SlamSystem() = default;

  /// @throws InputError if the sequence cannot be exported to the layout of the system
  [[nodiscard]] virtual ProcessSpec command(const RunRequest& request) const = 0;

  /// What is known of a run without its result, as JSON: the manifest of a run that does not write one.
  [[nodiscard]] virtual std::string manifest(const RunRequest& request) const = 0;

  /// Whether the program runs in a container, whose processor time and memory are not those of the process.
  [[nodiscard]] virtual bool is_contained() const { return false; }

  /// Result of a run after its process exited or was killed by a signal. The caller adds the process costs
  /// and checks the resource limits.
  [[nodiscard]] virtual RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const = 0;
};

/// The odometry of this project, run as a child process: `stillpoint run`.
class OwnOdometry : public SlamSystem {
 public:
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;
  /// Commit and machine of a program that was built from a commit; else empty.
  [[nodiscard]] std::string manifest(const RunRequest& request) const override;
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;
};

/// Build name in run records: git commit, and a hash of uncommitted changes if any.
[[nodiscard]] std::string build_name();

}  // namespace stillpoint::bench
