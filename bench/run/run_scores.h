// SPDX-License-Identifier: BSD-3-Clause
/// Scores of a run beside that of its trajectory: accuracy of dynamic labels against the per-pixel ground
/// truth of rendered sequences, loop closure, and the poses at IMU rate.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "bench/model/metrics.h"
#include "core/pipeline/imu_rate_poses.h"
#include "core/types/loop_report.h"
#include "core/types/tracked_frame.h"
#include "core/types/trajectory.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// Detects tracks that no longer follow their initial scene point, from the ground-truth trajectory and the
/// measured depth. Tracks drift at T-junctions of two edges, or when an occluding object passes. The feature
/// then moves although the scene is static, and neither dynamic label is wrong.
class DriftedTracks {
 public:
  /// Keeps a reference to `info`.
  explicit DriftedTracks(const datasets::SequenceInfo& info) : info_(info) {}

  /// Adds a frame; tracks without an observation in it are removed.
  void add(const TrackedFrame& frame);

  /// Whether the point p_w of the track's first depth measurement has a reprojection error of more than 4 px
  /// in the current or the first image: || project(T_w_c^-1 p_w) - pixel || > 4 px.
  /// False for tracks without measured depth, and without ground truth.
  [[nodiscard]] bool contains(std::int64_t id) const;

 private:
  struct Observation {
    Pose T_w_c;
    Eigen::Vector2d pixel;
  };
  struct Track {
    Observation first;
    std::optional<Eigen::Vector3d> p_w;  ///< from its first depth measurement
    bool drifted = false;
  };
  [[nodiscard]] bool exceeds_drift(const Eigen::Vector3d& p_w, const Observation& observation) const;

  const datasets::SequenceInfo& info_;
  std::map<std::int64_t, Track> tracks_;
};

/// Accuracy of dynamic labels: counts of features, each feature counted once per frame.
///
/// Excluded are features of age 1, which no check has processed yet; features on the outline of an object,
/// where a corner belongs to both sides; and features on an undetectable object at rest, where both labels
/// are correct. Persons count as dynamic even when they do not move.
struct LabelScore {
  struct Group {
    std::int64_t all = 0;
    std::int64_t flagged = 0;  ///< labelled as not stable
    /// flagged / all; nothing without features.
    [[nodiscard]] std::optional<double> flagged_ratio() const {
      if (all == 0) return std::nullopt;
      return static_cast<double>(flagged) / static_cast<double>(all);
    }
  };
  Group people;
  Group undetectable_objects;  ///< moving objects of classes without a detector
  Group background;

  /// Fraction of the flagged features that are on a person or a moving object.
  [[nodiscard]] std::optional<double> precision() const;

  /// @param features of the frame, by ascending id
  /// @param labels   of these features, by ascending id
  /// @param truth    ground-truth labels of the image
  /// @param drifted  already updated with the frame
  void add(std::span<const TrackedFeature> features, std::span<const DynamicLabel> labels,
           const datasets::MotionLabels& truth, const DriftedTracks& drifted);
};

/// Trajectories of a run with loop closure.
struct LoopRun {
  /// T_m_c with the correction known at each frame; the frames of the odometry's trajectory, with a loaded
  /// map from the relocalization on, and those of later segments that are located in the map.
  Trajectory causal;
  Trajectory optimized;  ///< T_m_c after the last frame; without segments that are not located
  LoopReport report;
  bool has_map = false;  ///< a map of an earlier run was loaded
};

/// The odometry's trajectory with the final corrections, interpolated over time between the two next
/// keyframes of its segment: from C_k T to C_k+1 T for a pose T. C_k moves the pose that was the output at
/// the time of the keyframe to the final one, T_m_b T_b_c. If the output lacks that time, C_k = T_m_b
/// T_w_b^-1. The poses of the first segment are those of the odometry if it has no keyframes; later segments
/// that are not located are left out.
/// @param odometry T_w_c of each segment, by their number
[[nodiscard]] Trajectory optimized_trajectory(std::span<const Trajectory> odometry, const LoopReport& report);

/// @param gt of the camera
/// @param odometry the first segment, without corrections
[[nodiscard]] LoopScore score_loops(const Trajectory& gt, const Trajectory& odometry, const LoopRun& run);

/// Scores the poses at IMU rate of a run; each number is absent if there is no data for it.
/// @param gt of the camera
/// @param frame_rate trajectory of the same run at frame rate
[[nodiscard]] ImuRateScore score_imu_rate(const Trajectory& gt, const ImuRateOutput& output,
                                          const Trajectory& frame_rate);

}  // namespace stillpoint::bench
