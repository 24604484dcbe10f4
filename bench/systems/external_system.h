// SPDX-License-Identifier: BSD-3-Clause
/// Another SLAM system as a command line: what it is called, what it reads, what it leaves behind.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint {

/// The form in which a system wants its sequence.
enum class ExportLayout {
  kAsIs,   ///< the folder as it lies on the disk
  kTum,    ///< TUM RGB-D: rgb/, depth/, their lists, groundtruth.txt; imu.txt and rig.toml
  kEuroc,  ///< EuRoC ASL: mav0/cam0, mav0/imu0; no depth
};
constexpr auto enum_names(ExportLayout) {
  return EnumNames<ExportLayout, 3>{
      {{ExportLayout::kAsIs, "as_is"}, {ExportLayout::kTum, "tum"}, {ExportLayout::kEuroc, "euroc"}}};
}

/// A file of bench/systems/, or a user's own. In the words of the command, {sequence} stands for the folder
/// of the sequence, {out} for an empty folder to write into, {here} for the folder of this file, {seed} and
/// {repetition} for the run's numbers.
struct ExternalSystem {
  std::string name;
  std::string version = "unknown";   ///< when it changes, runs are made again
  std::vector<std::string> command;  ///< program and arguments
  ExportLayout layout = ExportLayout::kTum;
  std::string trajectory = "trajectory.tum";  ///< below {out}: TUM text, poses of the camera in the world
  std::string
      timings;  ///< below {out}: JSON of modules and threads like "timings" of a result.json; may be empty
  // Where it came from.
  std::string folder;
  std::string hash;  ///< of the file's text
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
/// @throws InputError if there is none, for every fault of the file, and without a name or a command
[[nodiscard]] ExternalSystem load_external_system(const std::string& name);

}  // namespace stillpoint
