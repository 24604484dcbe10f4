// SPDX-License-Identifier: BSD-3-Clause
/// Tracks features from frame to frame and detects new ones where they are missing. Paper Sec. III-A.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/config/frontend_config.h"
#include "core/types/frame.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// What to do with one frame.
struct TrackingOptions {
  bool detect = true;  ///< also reject outliers, apply the masks and detect new features
  std::span<const std::int64_t> dynamic_ids;  ///< of features labeled dynamic, sorted; see
                                              ///< FrontendConfig::reject_static_only
};

class FeatureTracker {
 public:
  FeatureTracker(const FrontendConfig& config, const Camera& camera);
  ~FeatureTracker();

  /// Tracks all features into `frame`.
  /// @param frame CV_8UC1 gray of the camera's size; depth may be empty, else CV_16UC1 of the same size
  /// @param prior motion of the camera since the last call; invalid parts are ignored
  /// @param recycled an earlier result whose buffers are reused. With it and the tracker "patch", the steady
  /// state is allocation-free
  /// @return only features observed in this frame. Velocities are 0 if no time has passed since the last call
  /// @throws InputError for images of another size or type; the state of the tracker is then unchanged
  [[nodiscard]] TrackedFrame track(const Frame& frame, const MotionPrior& prior,
                                   const TrackingOptions& options, TrackedFrame recycled = {});

  /// Removes all features; ids are not reused.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillpoint
