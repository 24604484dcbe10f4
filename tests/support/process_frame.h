// SPDX-License-Identifier: BSD-3-Clause
/// Processes a frame by the estimator without dynamic feature recognition.
#pragma once

#include "core/backend/estimator.h"

namespace stillpoint {

inline const OdometryUpdate& process_frame(Estimator& estimator, const TrackedFrame& frame) {
  estimator.add(frame);
  static_cast<void>(estimator.refine());
  estimator.finish();
  return estimator.update();
}

}  // namespace stillpoint
