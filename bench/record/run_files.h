// SPDX-License-Identifier: BSD-3-Clause
/// The files of a run, written, and recognized in output folders of `run` and `profile`: trajectory.tum,
/// result.json, timings.csv, frames.csv, counters.csv, status.csv, stacks.folded, manifest.json,
/// trajectory_imu.tum with `pipeline.imu_rate`, and trajectory_loop.tum (with the corrections known at each
/// frame), trajectory_optimized.tum (with all corrections), loops.csv and keyframes.csv with `loop.enabled`;
/// and the id of the last processed frame while the run is executed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/record/output_folder.h"
#include "bench/record/run_environment.h"
#include "bench/run/run_result.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {

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

/// Text of trajectory.tum; that of an interrupted run starts with the comment "# partial".
[[nodiscard]] std::string trajectory_text(const RunResult& result);

/// Writes the files: all of them, or none. Then removes the other files of an earlier run, except images.
/// @throws InputError if the folder cannot be written
void write_run(const std::filesystem::path& folder, const RunResult& result, const RunManifest& manifest);

/// Writes the files of `profile`, and removes those that only an earlier profile wrote. What may be of a run
/// in the same folder is kept.
void write_profile(const std::filesystem::path& folder, const std::vector<OutputFile>& files);

/// Contents of the output folder of `run`, and how an earlier output is recognized.
[[nodiscard]] OutputLayout run_layout();
[[nodiscard]] OutputLayout video_layout();    ///< of --video
[[nodiscard]] OutputLayout profile_layout();  ///< of `profile`

/// File name in a run's folder.
inline constexpr const char* kHeartbeatFile = "heartbeat";

/// File with the id of the last processed frame; reports the progress of a run, also after a crash.
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

}  // namespace stillpoint::bench
