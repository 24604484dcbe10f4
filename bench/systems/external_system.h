// SPDX-License-Identifier: BSD-3-Clause
/// An external SLAM system: its description (name, command line, input layout, output files) and its runs.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/systems/slam_system.h"
#include "core/base/fields.h"

namespace stillpoint::bench {

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

/// Contents of a file in bench/systems/ or provided by the user. Placeholders in the command: {sequence} is
/// the folder of the sequence, {out} an empty output folder, {here} the folder of this file, {seed} and
/// {repetition} those of the run.
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

}  // namespace stillpoint::bench
