// SPDX-License-Identifier: BSD-3-Clause
/// Loop closure: recognizes places in the keyframes of the odometry and corrects its drift by a pose graph.
/// The odometry itself is not changed: the correction is a transform from its world to the map.
#pragma once

#include <optional>
#include <vector>

#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/loop/loop_consistency.h"
#include "core/loop/loop_verification.h"
#include "core/loop/place_recognition.h"
#include "core/loop/pose_graph.h"
#include "core/loop/relocalization.h"
#include "core/types/loop_report.h"

namespace stillpoint {

/// A keyframe is described, looked up, verified against the candidates and, if one is accepted, the graph is
/// optimized. The map has the frame of the loaded map or, without one, of the first segment. A later segment
/// of the odometry, after a loss, has a world of its own: it is located in the map by the places that it
/// shares with the earlier parts, as a run is in a loaded map. Deterministic and single-threaded.
class LoopClosure {
 public:
  /// @throws InputError if `loop.dof` is neither 4 nor 6, or 4 without an IMU
  LoopClosure(const LoopConfig& config, const Camera& camera, bool has_imu);

  /// Adds the keyframes of an earlier run. From the first keyframe on whose place is recognized and confirmed
  /// (relocalization), the map of this run is that of the earlier one; until then, it is the odometry's
  /// world. Call it before `add` and `locate`.
  void use_map(const KeyframeMap& map);

  /// Adds the next keyframe. @return T_m_w: the pose of its segment's world in the map, as known now; the
  /// identity until the segment is located
  /// @throws InputError if it has no depth image
  [[nodiscard]] Pose add(const DepartedKeyframe& keyframe);

  /// Looks up a frame in the map, unless its segment is located already. The frame does not become a
  /// keyframe; its location constrains the next one. @return as `add`
  /// @param frame a current one, with its present pose by the odometry
  [[nodiscard]] Pose locate(const DepartedKeyframe& frame);

  /// Whether the poses of the current segment refer to the map.
  [[nodiscard]] bool is_located() const { return parts_.is_located(); }

  /// Optimizes the graph for the last time. @return all candidates, and the keyframes with their final poses
  [[nodiscard]] LoopReport finish();

 private:
  /// A loop with good geometry that agrees with the odometry.
  struct ConsistentLoop {
    GraphLoop loop;
    std::size_t record = 0;  ///< index in `records_`
    bool confirmed = false;  ///< by another loop
    bool is_start = false;   ///< location of the part in the map by a frame
  };

  [[nodiscard]] Keyframe describe(const DepartedKeyframe& keyframe) const;
  void find_loops();
  void assess(const VerifiedLoop& verified, int match);
  [[nodiscard]] LoopOutcome compare_with_others(const GraphLoop& loop);
  [[nodiscard]] bool is_optimization_due() const;
  void optimize();
  [[nodiscard]] PoseGraph build_graph() const;
  void enter_segment(int segment);
  /// Moves the current part into the map by the newest confirmed loop to it, if it is the first one.
  void relocalize();
  void move_into_map(const Pose& T_m_w);
  void constrain_by_start();
  [[nodiscard]] bool has_inlier_in_map() const;
  void append(Keyframe keyframe);
  [[nodiscard]] std::size_t memory_bytes() const {  // of `KeyframeCost`
    return recognition_.memory_bytes() + features_allocated_ * sizeof(KeyframeFeature) +
           keyframes_.capacity() * sizeof(Keyframe) + (T_w_b_.capacity() + T_m_b_.capacity()) * sizeof(Pose) +
           records_.capacity() * sizeof(LoopRecord) + loops_.capacity() * sizeof(ConsistentLoop);
  }
  [[nodiscard]] std::optional<BundleAdjustmentSummary> adjust();

  LoopConfig config_;
  Camera camera_;
  PlaceRecognition recognition_;
  Relocalization relocalization_;
  OdometryDrift drift_;
  KeyframeParts parts_;
  int segment_ = 0;
  std::size_t loaded_ = 0;  ///< number of keyframes of the loaded map, the first ones
  std::vector<Keyframe> keyframes_;
  std::vector<Pose> T_w_b_;             ///< of the keyframes, by the odometry of their part
  std::vector<Pose> T_m_b_;             ///< of the keyframes, in the map
  std::vector<KeyframeCost> costs_;     ///< of the keyframes of this run
  std::size_t features_allocated_ = 0;  ///< of the keyframes
  Pose T_m_w_;
  std::vector<LoopRecord> records_;
  std::vector<ConsistentLoop> loops_;
  std::optional<MapLocation> start_;  ///< in the map, until the next keyframe; `record` is that in `records_`
  std::size_t keyframes_optimized_ = 0;  ///< number of keyframes at the last optimization
  bool has_new_loop_ = false;            ///< since then
};

}  // namespace stillpoint
