// SPDX-License-Identifier: BSD-3-Clause
/// Follows points from picture to picture and finds new ones where they are missing. Paper Sec. III-A.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/frontend/frontend_config.h"
#include "core/types/frame.h"
#include "core/types/motion_prior.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

class FeatureTracker {
 public:
  FeatureTracker(const FrontendConfig& config, const Camera& camera);
  ~FeatureTracker();

  /// Tracks all features into `frame`; with `detect` also rejects outliers, masks and finds new ones.
  /// @param frame CV_8UC1 gray of the camera's size; depth may be empty, else CV_16UC1 of the same size
  /// @param prior motion of the camera since the last call; ignored as far as it is not valid
  /// @param moving ids of features that are known to move, rising; see FrontendConfig::reject_among_still
  /// @param memory for the result: a frame that nobody needs any more. With one, and the tracker "patch",
  /// nothing is allocated once as many features have been followed
  /// @return only features that this picture saw. Velocities are 0 where no time has passed since the last
  /// call
  /// @throws InputError for pictures of another size or type; the tracker then stays as it was
  [[nodiscard]] TrackedFrame track(const Frame& frame, const MotionPrior& prior, bool detect,
                                   std::span<const std::int64_t> moving = {}, TrackedFrame memory = {});

  /// Forgets all features; ids go on rising.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillpoint
