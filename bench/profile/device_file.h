// SPDX-License-Identifier: BSD-3-Clause
/// Target device files: stage costs of machines that are simulated.
#pragma once

#include <string>
#include <type_traits>

#include "core/base/fields.h"
#include "core/pipeline/runners/runner.h"

namespace stillpoint::bench {

/// One value per stage, named as its `Module`.
struct StageNumbers {
  double tracking_thread = 0.0;
  double object_detection = 0.0;
  double optimization_thread = 0.0;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, StageNumbers>
void visit_fields(Visitor&& field, Config& config) {
  field("tracking_thread", config.tracking_thread, -1.0, 1e6);
  field("object_detection", config.object_detection, -1.0, 1e6);
  field("optimization_thread", config.optimization_thread, -1.0, 1e6);
}

/// A device file of bench/devices/, or of the user.
struct DeviceFile {
  std::string title;
  std::string source;  ///< of the numbers
  std::string config;  ///< whose costs `cost_ms` are: a config, or the beginning of its name; empty: of any
  int cores = 2;
  bool detector_has_own_processor = false;
  StageNumbers cost_ms = {-1.0, -1.0, -1.0};  ///< fixed cost [ms]; negative = use `factor`
  StageNumbers factor = {1.0, 1.0, 1.0};      ///< relative to the measured time on this machine
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DeviceFile>
void visit_fields(Visitor&& field, Config& config) {
  field("title", config.title);
  field("source", config.source);
  field("config", config.config);
  field("cores", config.cores, 1, 1024);
  field("detector_has_own_processor", config.detector_has_own_processor);
  field("cost_ms", config.cost_ms);
  field("factor", config.factor);
}

/// @param name embedded name ("atlas_200") or a TOML file
/// @throws InputError if there is none, and for every error in the file
[[nodiscard]] DeviceFile load_device(const std::string& name);

[[nodiscard]] DeviceModel device_model(const DeviceFile& file);

}  // namespace stillpoint::bench
