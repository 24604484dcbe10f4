// SPDX-License-Identifier: BSD-3-Clause
/// Processes a frame by the estimator without dynamic feature recognition.
#pragma once

#include "core/backend/estimator.h"

namespace stillpoint {

inline OdometryUpdate process_frame(Estimator& estimator, const TrackedFrame& frame) {
  OdometryUpdate update;
  estimator.add(frame, update);
  static_cast<void>(estimator.refine(update));
  estimator.finish(update);
  return update;
}

}  // namespace stillpoint
