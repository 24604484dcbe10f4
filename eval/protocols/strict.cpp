// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/strict.h"

#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "eval/metrics/relative_error.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/protocols/compat.h"

namespace stillpoint::eval {
namespace {

constexpr double kSegmentTolerance = 0.02;  // relative to the length of the segment, or to delta in meters
constexpr double kMaxHold = 1.0;            // [s], validity of a pose

RpeEvaluation strict_rpe_evaluation(std::span<const MatchedPose> matches, const ProtocolOptions& options) {
  if (options.rpe_unit == RpeUnit::kFrames) {
    throw InputError("--rpe-unit f",
                     "frame deltas are not comparable across runs; strict protocols support s and m");
  }
  RpeEvaluation rpe;
  std::size_t dropped = 0;
  if (options.rpe_unit == RpeUnit::kSeconds) {
    const StrictRpeResult result = strict_rpe(matches, options.rpe_delta);
    dropped = result.dropped;
    if (result.errors) {
      rpe.translation_m = result.errors->translation_m;
      rpe.rotation_deg = result.errors->rotation_deg;
    }
  } else {
    const std::vector<double> lengths = path_lengths(matches, PathOf::kGroundTruth);
    const PosePairs found =
        pairs_over_meters(lengths, options.rpe_delta, kSegmentTolerance * options.rpe_delta);
    const RelativeErrors errors = relative_errors(matches, found.pairs);
    dropped = found.dropped;
    rpe.translation_m = statistics(errors.translation_m);
    rpe.rotation_deg = statistics(errors.rotation_deg);
  }
  if (dropped > 0) {
    rpe.notes.push_back(std::to_string(dropped) + " of " + std::to_string(matches.size()) +
                        " RPE starts dropped: no pose at delta within the tolerance");
  }
  return rpe;
}

/// RMS of e_(i-1) - 2 e_i + e_(i+1), e: aligned position error. A smooth drift contributes little to it.
std::optional<double> jitter_of(std::span<const MatchedPose> matches, const Similarity& S_w_v) {
  if (matches.size() < 3) return std::nullopt;
  const auto error = [&](std::size_t i) -> Eigen::Vector3d {
    return S_w_v * matches[i].est.p - matches[i].gt.p;
  };
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < matches.size(); ++i) {
    sum += (error(i - 1) - 2.0 * error(i) + error(i + 1)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(matches.size() - 2));
}

}  // namespace

Evaluation evaluate_strict(const EvaluationInput& input, Alignment alignment) {
  const ProtocolOptions& options = input.options;
  Trajectory est = input.est;
  for (StampedPose& pose : est.poses) pose.t = after(pose.t, options.offset_s);
  std::vector<MatchedPose> matches = strict_matches(input.gt, est);
  Evaluation evaluation;
  if (!matches.empty()) {
    evaluation = ate_evaluation(matches, align_or_throw(matches, options.alignment.value_or(alignment),
                                                        options.align_first_n, "strict protocol"));
  }
  if (!input.gt.poses.empty()) {
    const TimeSpan whole{input.gt.poses.front().t, input.gt.poses.back().t};
    evaluation.lost = lost_spans(est, whole, kMaxHold);
    evaluation.coverage = time_coverage(evaluation.lost, whole);
    evaluation.first_pose_s = first_pose_seconds(est, whole.begin);
  }
  if (matches.size() < est.poses.size()) {
    evaluation.notes.push_back(std::to_string(est.poses.size() - matches.size()) + " of " +
                               std::to_string(est.poses.size()) +
                               " poses dropped: no ground truth close enough");
  }
  evaluation.correct_rate = correct_rate(input.gt, est, options.correct);
  if (matches.empty()) return evaluation;
  const Similarity S_w_v = evaluation.alignment.S_w_v;
  evaluation.jitter_m = jitter_of(matches, S_w_v);
  for (MatchedPose& match : matches) match.est = S_w_v * match.est;
  evaluation = with_rpe(std::move(evaluation), strict_rpe_evaluation(matches, options));
  evaluation.segments =
      segment_errors(matches, {.lengths_m = options.segment_lengths_m, .tolerance = kSegmentTolerance});
  evaluation.drift_percent = drift_percent(evaluation.segments);
  return evaluation;
}

}  // namespace stillpoint::eval
