// SPDX-License-Identifier: BSD-3-Clause
/// Systems that can be benchmarked: run on a sequence, write a trajectory. The interface and its two
/// implementations: external SLAM systems, and the odometry of this project.
#pragma once

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/config/config_file.h"
#include "bench/model/stored_run.h"
#include "bench/process/child_process.h"
#include "core/base/fields.h"

namespace stillpoint::bench {

/// A run to execute.
struct RunRequest {
  RunIdentity identity;
  ConfigRequest config;            ///< of this odometry
  int max_frames = 0;              ///< of this odometry; 0 = all
  double start_s = 0.0;            ///< of this odometry: time after the first frame at which the run begins
  std::string fault;               ///< sensor fault to inject, for this odometry; empty = none
  std::filesystem::path program;   ///< executable of this odometry; empty = the current executable
  std::filesystem::path sequence;  ///< folder
  std::filesystem::path work;      ///< exclusive output folder of the run
  int images = 0;                  ///< number of annotated images of its worst frames
  bool frame_cache = true;         ///< this odometry uses the frame cache
};

/// Starts a system and reads its results.
class SlamSystem {
 public:
  virtual ~SlamSystem() = default;

  /// @throws InputError if the sequence cannot be exported to the layout of the system
  [[nodiscard]] virtual ProcessSpec command(const RunRequest& request) const = 0;

  /// Result of a run after its process exited or was killed by a signal. The caller adds the process costs
  /// and checks the resource limits.
  [[nodiscard]] virtual RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const = 0;
};

/// Dataset layout that a system reads.
enum class ExportLayout {
  kAsIs,   ///< the original folder, without export
  kTum,    ///< TUM RGB-D: rgb/, depth/, their lists, groundtruth.txt; imu.txt and rig.toml
  kEuroc,  ///< EuRoC ASL: mav0/cam0, mav0/imu0; no depth
};
constexpr auto enum_names(ExportLayout) {
  return EnumNames<ExportLayout, 3>{
      {{ExportLayout::kAsIs, "as_is"}, {ExportLayout::kTum, "tum"}, {ExportLayout::kEuroc, "euroc"}}};
}

/// Description of an external system: contents of a file in bench/systems/ or provided by the user.
/// Placeholders in the command: {sequence} is the folder of the sequence, {out} an empty output folder,
/// {here} the folder of this file, {seed} and {repetition} those of the run.
struct ExternalSystem {
  std::string name;
  std::string version = "unknown";   ///< part of the run key: a change invalidates cached runs
  std::vector<std::string> command;  ///< program and arguments
  ExportLayout layout = ExportLayout::kTum;
  std::string trajectory = "trajectory.tum";  ///< in {out}: TUM format, poses T_w_c
  std::string timings;  ///< in {out}: JSON with modules and threads as "timings" in result.json; may be empty
  // Set by load_external_system.
  std::string folder;
  std::string hash;  ///< of the text of the file
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ExternalSystem>
void visit_fields(Visitor&& field, Config& config) {
  field("name", config.name);
  field("version", config.version);
  field("command", config.command);
  field("layout", config.layout);
  field("trajectory", config.trajectory);
  field("timings", config.timings);
}

/// @param name of an embedded file, or path of one that ends in ".toml"
/// @throws InputError if there is no such file, if it is invalid, or if name or command are missing
[[nodiscard]] ExternalSystem load_external_system(const std::string& name);

/// Runs an external system on a sequence.
class ExternalRun : public SlamSystem {
 public:
  explicit ExternalRun(ExternalSystem system) : system_(std::move(system)) {}

  /// Command line of the system. Exports the sequence first if the system requires another layout; exports
  /// are cached.
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;

  /// Evaluates the trajectory written by the system.
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;

 private:
  ExternalSystem system_;
};

/// The odometry of this project, run as a child process: `stillpoint run`.
class OwnOdometry : public SlamSystem {
 public:
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;
};

/// Build name in run records: git commit, and a hash of uncommitted changes if any.
[[nodiscard]] std::string build_name();

}  // namespace stillpoint::bench
