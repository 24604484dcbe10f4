// SPDX-License-Identifier: BSD-3-Clause
/// Hands keyframes to the loop closure when they leave the sliding window. Their poses do not change any more
/// then. The window is only read.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/window/window.h"
#include "core/config/loop_config.h"
#include "core/loop/keyframe.h"
#include "core/pipeline/stages/frame_report.h"

namespace stillpoint {

class KeyframeCollector {
 public:
  explicit KeyframeCollector(const LoopConfig& config) : config_(config) {}

  /// Remembers the oldest states before the window slides.
  /// @param oldest_motion from the oldest frame to the next, with its covariance, if it is known
  void before_slide(const Window& window, const std::optional<UncertainPose>& oldest_motion);

  /// After the window has slid: notices that the oldest frame left it, and stores the newest one.
  /// @param frame the newest one, with its gray image
  /// @param dynamic labels and mask of the same frame
  void after_slide(const Window& window, const TrackedFrame& frame, const DynamicReport& dynamic);

  /// Whether the window is located in the world of this segment: keyframes that leave it otherwise are
  /// discarded. Call it between the two functions above.
  void set_located(bool located, int segment);

  /// The keyframe that left the window with the last frame, if it is far enough from the one before.
  [[nodiscard]] std::optional<DepartedKeyframe> take();

  /// The next keyframe that is still in the window, the oldest first; for the end of a run.
  [[nodiscard]] std::optional<DepartedKeyframe> take_remaining(const Window& window);

  /// A copy of the newest frame with its present pose, for relocalization; nullopt if it is not located.
  /// @param frame the newest one; others are not returned
  [[nodiscard]] std::optional<DepartedKeyframe> newest(const Window& window, std::int64_t frame);

  /// Returns a keyframe whose vectors are reused.
  void recycle(DepartedKeyframe keyframe) { unused_.push_back(std::move(keyframe)); }

 private:
  [[nodiscard]] bool has_moved(const Pose& T_w_b) const;
  void add_motion(const Window& window);
  void depart(std::int64_t frame, const Pose& T_w_b, const Window& window);
  [[nodiscard]] DepartedKeyframe unused();
  void discard_missing(const Window& window);

  LoopConfig config_;
  bool located_ = false;
  int segment_ = 0;
  std::optional<std::int64_t> oldest_;  ///< frame
  Pose oldest_T_w_b_;
  std::optional<std::int64_t> next_;            ///< frame after the oldest one
  std::optional<UncertainPose> oldest_motion_;  ///< from the oldest frame to the next
  std::optional<Pose> last_T_w_b_;              ///< of the last keyframe that was handed over
  /// From that keyframe to the oldest frame of the window; absent if a part of it is not known.
  std::optional<UncertainPose> motion_;
  std::vector<DepartedKeyframe> in_window_;
  std::vector<DepartedKeyframe> unused_;
  std::optional<DepartedKeyframe> departed_;
};

}  // namespace stillpoint
