// SPDX-License-Identifier: BSD-3-Clause
/// Evaluation protocols: named, versioned definitions of association, alignment and metrics. Each result is
/// stored with the name, version and description of its protocol. The protocols `compat:` reproduce the
/// numbers of public tools, including their known limitations. The protocols `strict:` use exact time stamps,
/// no interpolation or RPE pair across a gap, and state the coverage with every error.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/orientations.h"

namespace stillpoint::eval {

/// Overrides of protocol parameters; nullopt keeps the default of the protocol. Overrides are appended to the
/// description in `Evaluation::text`.
struct ProtocolOptions {
  std::optional<Alignment> alignment;
  std::size_t align_first_n = 0;           ///< align over the first n matches; 0 = all
  std::optional<double> max_difference_s;  ///< of associated time stamps
  double rpe_delta = 1.0;
  RpeUnit rpe_unit = RpeUnit::kSeconds;
  double offset_s = 0.0;  ///< added to the estimate's stamps
  /// Rotation that levels the world of the estimate, that is, turns gravity to -z; applied before an
  /// alignment in yaw, which assumes a level world. Nullopt: the world of the estimate is level.
  std::optional<Eigen::Quaterniond> q_level_w{};
  CorrectRateOptions correct{.max_translation_m = 1.0, .max_rotation_deg = 30.0};
  std::vector<double> segment_lengths_m;  ///< empty: 10 to 50 % of the path length
  bool per_pose = true;                   ///< fill `Evaluation::per_pose`, 24 bytes per pair
};

struct PoseError {
  Timestamp t;
  double translation_m = 0.0;
  double rotation_deg = 0.0;  ///< NaN: not determined
};

/// Result of one protocol for one estimate. nullopt means "n/a".
struct Evaluation {
  std::string protocol;  ///< "compat:tum"
  int version = 0;
  std::string text;  ///< description of the protocol, including overrides
  std::size_t gt_poses = 0;
  std::size_t est_poses = 0;
  std::size_t pairs = 0;
  AlignmentResult alignment;  ///< `determined`: by the positions alone
  RotationSource rotation_source = RotationSource::kPositions;
  bool rotation_determined = true;  ///< by its source; otherwise errors of orientations are n/a
  std::optional<Statistics> ate_m;
  std::optional<Statistics> ate_deg;
  double rpe_delta = 1.0;
  RpeUnit rpe_unit = RpeUnit::kSeconds;
  std::optional<Statistics> rpe_m;
  std::optional<Statistics> rpe_deg;
  std::size_t rpe_pairs = 0;  ///< of two poses
  std::vector<SegmentErrors> segments;
  std::optional<double> drift_percent;  ///< mean translation error of the segments relative to their length
  std::optional<double> correct_rate;
  std::optional<double> coverage;  ///< fraction of the ground truth's duration with a valid pose
  std::optional<double> first_pose_s;
  std::optional<double> jitter_m;   ///< RMS of the second difference of the aligned position error
  std::vector<TimeSpan> lost;       ///< intervals without a valid pose
  std::vector<std::string> notes;   ///< warnings about dropped data and limitations of the metrics
  std::vector<PoseError> per_pose;  ///< empty unless `ProtocolOptions::per_pose`
};

struct EvaluationInput {
  const Trajectory& gt;
  const Trajectory& est;  ///< of the same body frame as gt
  const ProtocolOptions& options;
};

struct Protocol {
  std::string_view name;
  int version = 0;
  std::string_view text;  ///< description
  Evaluation (*evaluate)(const EvaluationInput&);
};

/// All protocols: compat:tum, compat:evo, compat:rpg, compat:openloris, and strict:se3, strict:yaw,
/// strict:sim3, strict:first_pose, strict:none.
[[nodiscard]] std::span<const Protocol> protocols();

/// Evaluates an estimate with the named protocol.
/// @throws InputError for an unknown protocol, for options that the protocol does not support, or if the data
/// do not determine what all errors depend on: the scale at standing positions, the rotation for evo and rpg
[[nodiscard]] Evaluation evaluate(std::string_view protocol, const EvaluationInput& input);

}  // namespace stillpoint::eval
