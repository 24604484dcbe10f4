// SPDX-License-Identifier: BSD-3-Clause
/// Results of loop closure: candidates with their outcome, the optimized keyframes, and the map of a finished
/// run for relocalization in later ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

/// Binary descriptor of 256 bits.
using Descriptor = std::array<std::uint64_t, 4>;

struct KeyframeFeature {
  Descriptor descriptor{};
  Eigen::Vector3f p_c = Eigen::Vector3f::Zero();  ///< in the camera frame [m], p_c.z() > 0
  std::int64_t track = -1;                        ///< of the odometry; -1: a corner, or of a loaded map
};

/// A keyframe of loop closure.
struct Keyframe {
  std::int64_t frame = 0;
  Timestamp t;
  Pose T_w_b;  ///< by the odometry; in a map: optimized
  Pose T_b_c;
  std::optional<Eigen::Vector3d> gravity_b;  ///< unit vector
  std::vector<KeyframeFeature> features;     ///< the most distinctive corners first
};

/// Map of a run: keyframes with described points.
struct KeyframeMap {
  std::vector<Keyframe> keyframes;  ///< in the order of the run
};

/// Why a candidate was refused.
enum class LoopOutcome : std::uint8_t {
  kAccepted,
  kFewMatches,   ///< too few similar features
  kFewInliers,   ///< too few of them agree with one rigid motion
  kSpread,       ///< the inliers are concentrated in a part of the image
  kUncertain,    ///< the inliers do not determine the pose
  kOdometry,     ///< contradicts the odometry
  kPairwise,     ///< contradicts other loops
  kUnconfirmed,  ///< no other loop agrees with it
  kPoseGraph,    ///< outlier of the pose graph
};

[[nodiscard]] constexpr std::string_view outcome_name(LoopOutcome outcome) {
  constexpr std::string_view kNames[] = {"accepted", "few_matches", "few_inliers", "spread",    "uncertain",
                                         "odometry", "pairwise",    "unconfirmed", "pose_graph"};
  return kNames[static_cast<std::size_t>(outcome)];
}

/// A place that was recognized.
struct LoopRecord {
  std::int64_t query_frame = 0;
  Timestamp query_t;
  std::int64_t match_frame = 0;
  Timestamp match_t;
  int votes = 0;    ///< features that agree with the place
  int matches = 0;  ///< similar features
  int inliers = 0;
  double residual_px = 0.0;  ///< RMS reprojection error of the inliers [px]
  Pose T_match_query;        ///< of the cameras; the identity without inliers
  bool in_map =
      false;  ///< the match is a keyframe of the loaded map; its frame and time are those of that run
  LoopOutcome outcome = LoopOutcome::kAccepted;
};

/// Cost of the loop closure for a keyframe.
struct KeyframeCost {
  double processing_ms = 0.0;
  /// Allocated afterwards for keyframes, place index and loops, those of a loaded map included [B]. The pose
  /// graph, which exists while it is optimized, is not.
  std::size_t memory_bytes = 0;
};

/// A keyframe of the pose graph, of this run.
struct MapKeyframe {
  std::int64_t frame = 0;
  Timestamp t;
  int segment = 0;         ///< of the odometry, see `OdometryUpdate`
  bool is_located = true;  ///< `T_m_b` refers to the map, and not to the world of the segment
  Pose T_w_b;              ///< by the odometry, in the world of the segment
  Pose T_m_b;              ///< optimized
  Pose T_b_c;
  KeyframeCost cost;
};

/// Of the global bundle adjustment (core/loop/bundle_adjustment.h).
struct BundleAdjustmentSummary {
  std::size_t landmarks = 0;
  std::size_t observations = 0;
  double rms_before = 0.0;  ///< of the normalized residuals of the observations: 1 = as large as assumed
  double rms_after = 0.0;
  bool usable = true;  ///< false: the solver failed, and the poses are those of the pose graph
};

struct LoopReport {
  std::vector<LoopRecord> loops;                             ///< by query
  std::vector<MapKeyframe> keyframes;                        ///< by time
  int dropped_keyframes = 0;                                 ///< not processed, in real time
  bool relocalized = false;                                  ///< keyframes were located in the loaded map
  std::optional<BundleAdjustmentSummary> bundle_adjustment;  ///< with `loop.final_bundle_adjustment`
  /// All located keyframes with optimized poses, for later runs: those of a loaded map, which this run
  /// extends, and of this run. Null if a map was loaded and the run was not located in it.
  std::shared_ptr<const KeyframeMap> map;
};

}  // namespace stillpoint
