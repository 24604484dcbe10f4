// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/config_check.h"

#include "core/base/error.h"

namespace stillpoint {

void check_config(const BackendConfig& backend, const ImuConfig& imu) {
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
  const bool estimates = backend.depth.estimate_scale || backend.estimate_extrinsics;
  if (estimates && backend.calibration_agreement_probability > 0.0 && !backend.covariance) {
    throw InputError("backend.calibration_agreement_probability",
                     "requires backend.covariance = true; 0 estimates the calibration from the start");
  }
}

}  // namespace stillpoint
