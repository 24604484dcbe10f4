// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/device_file.h"

#include "bench/config/settings.h"
#include "bench/config/toml_source.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

StageCost stage_cost(double cost_ms, double factor) {
  if (cost_ms >= 0.0) return {.fixed_ms = cost_ms};
  return {.fixed_ms = {}, .factor = factor};
}

}  // namespace

DeviceFile load_device(const std::string& name) {
  const TomlSource source = find_toml(name, TomlKind::kDevice);
  DeviceFile device = with_settings(DeviceFile{}, parse_settings(source.text, source.path));
  const StageNumbers& factor = device.factor;
  if (factor.tracking_thread < 0.0 || factor.object_detection < 0.0 || factor.optimization_thread < 0.0) {
    throw InputError(source.path, "has a negative factor; 1 = as fast as this machine, 2 = twice the time");
  }
  if (device.title.empty()) device.title = source.path;
  return device;
}

DeviceModel device_model(const DeviceFile& file) {
  return {.cores = file.cores,
          .detector_has_own_processor = file.detector_has_own_processor,
          .tracking = stage_cost(file.cost_ms.tracking_thread, file.factor.tracking_thread),
          .detection = stage_cost(file.cost_ms.object_detection, file.factor.object_detection),
          .optimization = stage_cost(file.cost_ms.optimization_thread, file.factor.optimization_thread)};
}

}  // namespace stillpoint::bench
