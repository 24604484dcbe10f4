// SPDX-License-Identifier: BSD-3-Clause
/// Named, versioned definitions of how numbers are made, so that every number can say what it means.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/metrics/coverage.h"
#include "eval/metrics/rpe.h"
#include "eval/metrics/segments.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint {

/// What a caller may change of a recipe; empty means the recipe's own choice. Changes are written into the
/// text of the evaluation.
struct RecipeOptions {
  std::optional<Alignment> alignment;
  std::size_t align_first_n = 0;  ///< 0 = all
  std::optional<double> max_difference_s;
  double rpe_delta = 1.0;
  RpeUnit rpe_unit = RpeUnit::kSeconds;
  double offset_s = 0.0;  ///< added to the estimate's stamps
  CorrectRateOptions correct{.max_translation_m = 1.0, .max_rotation_deg = 30.0};
  std::vector<double> segment_lengths_m;  ///< empty: 10 to 50 % of the path
};

struct PoseError {
  Timestamp t;
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

/// Everything that one recipe says about one estimate. Absent means "n/a".
struct Evaluation {
  std::string recipe;  ///< "compat:tum"
  int version = 0;
  std::string text;  ///< what was done, in words, with the options that were in force
  std::size_t gt_poses = 0;
  std::size_t est_poses = 0;
  std::size_t pairs = 0;
  AlignmentResult alignment;
  std::optional<Statistics> ate_m;
  std::optional<Statistics> ate_deg;
  double rpe_delta = 1.0;
  RpeUnit rpe_unit = RpeUnit::kSeconds;
  std::optional<Statistics> rpe_m;
  std::optional<Statistics> rpe_deg;
  std::vector<SegmentErrors> segments;
  std::optional<double> drift_percent;  ///< mean translation error of the segments, of their length
  std::optional<double> correct_rate;
  std::optional<double>
      coverage;  ///< share of the ground truth's time in which a pose stands, at most 1 s each
  std::optional<double> first_pose_s;
  std::optional<double> jitter_m;  ///< RMS of the second difference of the aligned position error
  std::vector<TimeSpan> lost;      ///< times without a pose
  std::vector<std::string> notes;  ///< what was dropped, and what the number hides; a sentence each
  std::vector<PoseError> per_pose;
};

struct EvaluationInput {
  const Trajectory& gt;
  const Trajectory& est;  ///< of the same frame of the robot as gt
  const RecipeOptions& options;
};

struct Recipe {
  std::string_view name;
  int version = 0;
  std::string_view text;
  Evaluation (*evaluate)(const EvaluationInput&);
};

/// All recipes: compat:tum, compat:evo, compat:rpg, compat:openloris, and strict:{none, first_pose, yaw, se3,
/// sim3}.
[[nodiscard]] std::span<const Recipe> recipes();

/// Evaluates by name.
/// @throws InputError for an unknown recipe (naming the known ones), for options that the recipe does not
/// know, or where a strict recipe's alignment is not determined
[[nodiscard]] Evaluation evaluate(std::string_view recipe, const EvaluationInput& input);

}  // namespace stillpoint
