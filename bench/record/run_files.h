// SPDX-License-Identifier: BSD-3-Clause
/// The files of a run: trajectory.tum, result.json, timings.csv, frames.csv, counters.csv, stacks.folded,
/// manifest.json, trajectory_imu.tum with `pipeline.imu_rate`, and trajectory_loop.tum (with the corrections
/// known at each frame), trajectory_optimized.tum (with all corrections) loops.csv and keyframes.csv with
/// `loop.enabled`.
///
/// File with the id of the last processed frame; reports the progress of a run, also after a crash.
///
/// Contents of the output folders of `run` and `profile`, and how earlier outputs are recognized.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "bench/record/output_folder.h"
#include "bench/record/run_environment.h"
#include "bench/run/run_result.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// File name in a run's folder.
inline constexpr const char* kHeartbeatFile = "heartbeat";

class Heartbeat {
 public:
  /// @throws InputError if the file cannot be created, or exists with other content
  explicit Heartbeat(const std::filesystem::path& file);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  void beat(std::int64_t frame) const;

 private:
  int descriptor_;
};

/// Nothing if the file does not exist or is empty.
[[nodiscard]] std::optional<std::int64_t> read_heartbeat(const std::filesystem::path& file);

/// What is necessary to reproduce a run, and to decide which results are comparable with it.
struct RunManifest {
  std::string sequence;
  std::vector<std::string> faults;  ///< injected sensor faults, as in `--fault`
  std::string sequence_format;
  std::string sequence_checksum;  ///< empty when the run was interrupted
  std::string base;
  std::string variant;
  OdometryConfig config;
  std::string map_checksum;  ///< of the loaded map, see `map_checksum`; empty without one
  std::string mode;
  BuildInfo build;
  HostInfo host;
  std::string started;  ///< UTC, ISO 8601
};

/// Text of result.json; numbers without data are null.
[[nodiscard]] std::string result_json(const RunResult& result);

/// Text of manifest.json.
[[nodiscard]] std::string manifest_json(const RunManifest& manifest);

/// Text of timings.csv: time per frame and module of the odometry, see bench/model/run_csv.h.
[[nodiscard]] std::string timings_csv(const OdometryRun& run);

/// Text of frames.csv: hash of each module's state after each frame.
[[nodiscard]] std::string frames_csv(const OdometryRun& run);

/// Text of trajectory.tum; that of an interrupted run starts with the comment "# partial".
[[nodiscard]] std::string trajectory_text(const RunResult& result);

/// Writes the files: all of them, or none.
/// @throws InputError if the folder cannot be written
void write_run(const std::filesystem::path& folder, const RunResult& result, const RunManifest& manifest);

[[nodiscard]] OutputLayout run_layout();
[[nodiscard]] OutputLayout video_layout();  ///< of --video
[[nodiscard]] OutputLayout profile_layout();

}  // namespace stillpoint::bench
