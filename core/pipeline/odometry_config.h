// SPDX-License-Identifier: BSD-3-Clause
/// Every setting of the odometry in one struct. The defaults are Dynamic-VINS; files and overlays change
/// them.
#pragma once

#include <type_traits>

#include "core/backend/backend_config.h"
#include "core/detector/detector_config.h"
#include "core/dynamic/dynamic_config.h"
#include "core/frontend/frontend_config.h"
#include "core/imu/imu_config.h"
#include "core/pipeline/pipeline_config.h"

namespace stillpoint {

struct OdometryConfig {
  int seed = 1;  ///< of everything random in a run
  ImuConfig imu;
  FrontendConfig frontend;
  DetectorConfig detector;
  DynamicConfig dynamic;
  BackendConfig backend;
  PipelineConfig pipeline;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, OdometryConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("seed", config.seed, 0, 1000000000);
  field("imu", config.imu);
  field("frontend", config.frontend);
  field("detector", config.detector);
  field("dynamic", config.dynamic);
  field("backend", config.backend);
  field("pipeline", config.pipeline);
}

}  // namespace stillpoint
