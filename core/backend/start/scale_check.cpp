// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/scale_check.h"

#include "core/base/error.h"

namespace stillpoint {

void check_scale(const BackendConfig& backend, const ImuConfig& imu) {
  const bool monocular = backend.initializer.kind == InitializerKind::kMonocular;
  const bool no_depth = backend.depth.usage == DepthUsage::kOff;
  if (no_depth && !imu.enabled) {
    throw InputError("backend.depth.usage",
                     "\"off\" without an IMU makes the scale unobservable; use \"fixed\" or \"weighted\"");
  }
  if (no_depth && !monocular) {
    throw InputError("backend.depth.usage",
                     "\"off\" makes the scale unobservable; use \"fixed\" or \"weighted\", or "
                     "backend.initializer.kind = \"monocular\"");
  }
  if (monocular && !no_depth) {
    throw InputError("backend.initializer.kind",
                     "\"monocular\" requires backend.depth.usage = \"off\"; with depth use \"window\" or "
                     "\"instant\"");
  }
  if (backend.depth.estimate_scale && backend.depth.usage != DepthUsage::kWeighted) {
    throw InputError("backend.depth.estimate_scale", "requires backend.depth.usage = \"weighted\"");
  }
}

}  // namespace stillpoint
