// SPDX-License-Identifier: BSD-3-Clause
/// A picture through the estimator in which nobody looks for movers.
#pragma once

#include "core/backend/estimator.h"

namespace stillpoint {

inline OdometryUpdate take_in(Estimator& estimator, const TrackedFrame& frame) {
  OdometryUpdate update;
  estimator.add(frame, update);
  static_cast<void>(estimator.refine(update));
  estimator.finish(update);
  return update;
}

}  // namespace stillpoint
