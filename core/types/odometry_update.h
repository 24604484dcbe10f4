// SPDX-License-Identifier: BSD-3-Clause
/// What the estimator says after each picture.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/module_timings.h"
#include "core/types/nav_state.h"

namespace stillpoint {

enum class OdometryStatus { kInitialising, kTracking, kLost };

/// Stable names for files that people and programs read.
[[nodiscard]] constexpr std::string_view status_name(OdometryStatus status) {
  constexpr std::string_view kNames[] = {"initialising", "tracking", "lost"};
  return kNames[static_cast<std::size_t>(status)];
}

struct OdometryCounters {
  int tracked_features = 0;  ///< came from the tracker
  int window_landmarks = 0;  ///< took part in the solve
  int depth_landmarks = 0;   ///< of those, with measured depth
  int dynamic_features = 0;  ///< kept out as moving
  int solver_iterations = 0;
  bool keyframe = false;
  bool reset = false;  ///< a failure was detected at this picture and the estimator begins anew
};

/// Fingerprints of what the modules hold after a picture, see core/pipeline/state_hash.h.
struct StateHashes {
  std::uint64_t tracking = 0;      ///< features
  std::uint64_t dynamic = 0;       ///< verdicts
  std::uint64_t optimization = 0;  ///< state
};

/// `state` is valid only while `status == kTracking`.
struct OdometryUpdate {
  std::int64_t frame_id = 0;
  NavState state;
  Pose T_w_c;  ///< of the camera, with the extrinsics of that moment
  OdometryStatus status = OdometryStatus::kInitialising;
  double time_offset_s = 0.0;  ///< present estimate
  OdometryCounters counters;
  StateHashes hashes;
  ModuleTimings timings;
};

}  // namespace stillpoint
