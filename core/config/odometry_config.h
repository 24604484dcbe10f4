// SPDX-License-Identifier: BSD-3-Clause
/// All settings of the odometry. A default-constructed config is the default of the program, `stillpoint`:
/// Dynamic-VINS with the changes that improved accuracy or speed in benchmarks. The published values are in
/// bench/configs/dynamic_vins.toml. The field lists explain the keys; a remark beside a value says why it is
/// that one.
#pragma once

#include <type_traits>

#include "core/config/backend_config.h"
#include "core/config/detector_config.h"
#include "core/config/dynamic_config.h"
#include "core/config/frontend_config.h"
#include "core/config/imu_config.h"
#include "core/config/loop_config.h"
#include "core/config/pipeline_config.h"

namespace stillpoint {

struct OdometryConfig {
  int seed = 1;
  ImuConfig imu;
  FrontendConfig frontend;
  DetectorConfig detector;
  DynamicConfig dynamic;
  BackendConfig backend;
  LoopConfig loop;
  PipelineConfig pipeline;
};
/// The detector that a run uses: none if there is no mask for its boxes.
[[nodiscard]] inline DetectorKind used_detector(const OdometryConfig& config) {
  return config.dynamic.mask == DynamicMask::kOff ? DetectorKind::kNone : config.detector.kind;
}

template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, OdometryConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("seed", config.seed, FieldInfo{"Seed of all random number generators of a run.", "", 0, 1000000000});
  field("imu", config.imu);
  field("frontend", config.frontend);
  field("detector", config.detector);
  field("dynamic", config.dynamic);
  field("backend", config.backend);
  field("loop", config.loop);
  field("pipeline", config.pipeline);
}

}  // namespace stillpoint
