// SPDX-License-Identifier: BSD-3-Clause
#include "eval/score.h"

#include <array>
#include <cstdio>
#include <string>

#include "eval/trajectory/orientations.h"

namespace stillpoint::eval {
namespace {

std::optional<Timestamp> start_of(const Trajectory& gt, const ScoreOptions& options) {
  if (!options.expected_times.empty()) return options.expected_times.front();
  if (!gt.poses.empty()) return gt.poses.front().t;
  return std::nullopt;
}

}  // namespace

Score score(const Trajectory& gt, const Trajectory& est, const ScoreOptions& options) {
  Score result;
  result.poses = est.poses.size();
  const AssociationOptions association{.max_difference_s = options.max_difference_s,
                                       .offset_s = options.offset_s};
  result.ate = ate(gt, est, association);
  result.rpe_delta_s = options.rpe_delta_s;
  if (missing_orientations(gt, est, options.offset_s).empty()) {
    result.rpe = rpe(gt, est, {.delta = options.rpe_delta_s, .offset_s = options.offset_s});
    result.correct_rate = correct_rate(gt, est, options.correct, options.offset_s);
  }
  result.coverage = coverage(est, options.expected_times, options.coverage_tolerance_s);
  if (const std::optional<Timestamp> start = start_of(gt, options)) {
    result.first_pose_s = first_pose_seconds(est, *start);
  }
  return result;
}

std::string sparse_truth_doubt(const Trajectory& gt, const Score& score) {
  const std::size_t pairs = score.ate ? score.ate->pairs : 0;
  if (gt.poses.empty() || 2 * pairs >= score.poses) return "";
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "ground truth: has a pose within %g s for %zu of %zu poses only; ",
                ScoreOptions{}.max_difference_s, pairs, score.poses);
  const std::string rpe_note = score.rpe ? sparse_truth_note(gt) : "";
  return text.data() +
         (rpe_note.empty() ? "the errors are those of these" : "the ATE is that of these; " + rpe_note);
}

}  // namespace stillpoint::eval
