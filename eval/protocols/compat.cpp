// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/compat.h"

#include <utility>

#include "core/base/error.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/relative_error.h"
#include "eval/openloris/sequence_score.h"

namespace stillpoint::eval {
namespace {

constexpr double kEvoMaxDifference = 0.01;  // [s], evo's t_max_diff
constexpr double kEvoTolerance = 0.1;       // of delta
constexpr double kTumMaxDifference = 0.02;  // [s]
constexpr double kRpgTolerance = 0.2;       // of the segment's length

AssociationOptions tool_association(const ProtocolOptions& options, double max_difference_s) {
  return {.max_difference_s = options.max_difference_s.value_or(max_difference_s),
          .offset_s = options.offset_s,
          .arithmetic = StampArithmetic::kDouble};
}

RpeEvaluation evo_rpe(std::span<const MatchedPose> matches, const ProtocolOptions& options) {
  RpeEvaluation result;
  std::vector<PosePair> pairs;
  if (options.rpe_unit == RpeUnit::kMeters) {
    const std::vector<double> lengths = path_lengths(matches, PathOf::kEstimate);
    const PosePairs found = pairs_over_meters(lengths, options.rpe_delta, kEvoTolerance * options.rpe_delta);
    pairs = found.pairs;
    if (found.dropped > 0) {
      result.notes.push_back(std::to_string(found.dropped) +
                             " RPE starts dropped: no end within 10 % of delta");
    }
  } else if (options.rpe_unit == RpeUnit::kFrames) {
    if (options.rpe_delta < 1.0) throw InputError("--rpe-delta", "must be 1 frame or more");
    pairs = pairs_over_frames(matches.size(), static_cast<std::size_t>(options.rpe_delta), false);
  } else {
    result.notes.emplace_back("evo has no RPE over seconds; use --rpe-unit f or m");
  }
  const RelativeErrors errors = relative_errors(matches, pairs);
  result.translation_m = statistics(errors.translation_m);
  result.rotation_deg = statistics(errors.rotation_deg);
  return result;
}

RpeEvaluation tum_rpe(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const std::optional<RpeResult> relative =
      rpe(input.gt, input.est,
          {.delta = options.rpe_delta, .unit = options.rpe_unit, .offset_s = options.offset_s});
  if (!relative) return {};
  RpeEvaluation result{relative->translation_m, relative->rotation_deg, {}};
  if (relative->self_pairs > 0) {
    result.notes.push_back(std::to_string(relative->self_pairs) + " of " +
                           std::to_string(relative->translation_m.count) +
                           " RPE pairs consist of one pose and count as zero error; see strict:se3");
  }
  if (relative->dropped_gt > 0) {
    result.notes.push_back(std::to_string(relative->dropped_gt) +
                           " RPE pairs dropped: no ground truth close enough");
  }
  return result;
}

}  // namespace

Evaluation ate_evaluation(std::span<const MatchedPose> matches, const AlignmentResult& alignment) {
  Evaluation evaluation;
  evaluation.pairs = matches.size();
  evaluation.alignment = alignment;
  const AteErrors errors = ate_errors(matches, alignment.S_w_v);
  evaluation.ate_m = statistics(errors.translation_m);
  evaluation.ate_deg = statistics(errors.rotation_deg);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    evaluation.per_pose.push_back({matches[i].t, errors.translation_m[i], errors.rotation_deg[i]});
  }
  return evaluation;
}

Evaluation with_rpe(Evaluation evaluation, const RpeEvaluation& rpe) {
  evaluation.rpe_m = rpe.translation_m;
  evaluation.rpe_deg = rpe.rotation_deg;
  evaluation.notes.insert(evaluation.notes.end(), rpe.notes.begin(), rpe.notes.end());
  return evaluation;
}

Evaluation evaluate_compat_tum(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  Evaluation evaluation;
  const std::vector<MatchedPose> matches = matched_poses(
      input.gt, input.est, associate_tum(input.gt, input.est, tool_association(options, kTumMaxDifference)));
  if (matches.size() >= 2) {
    evaluation = ate_evaluation(
        matches, align(matches, options.alignment.value_or(Alignment::kSe3), options.align_first_n));
  }
  return with_rpe(std::move(evaluation), tum_rpe(input));
}

Evaluation evaluate_compat_evo(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const std::vector<MatchedPose> matches = matched_poses(
      input.gt, input.est, associate_evo(input.gt, input.est, tool_association(options, kEvoMaxDifference)));
  if (matches.empty()) return {};
  const AlignmentResult alignment = align_or_throw(matches, options.alignment.value_or(Alignment::kSe3),
                                                   options.align_first_n, "compat:evo");
  return with_rpe(ate_evaluation(matches, alignment), evo_rpe(matches, options));
}

Evaluation evaluate_compat_rpg(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  std::vector<MatchedPose> matches = matched_poses(
      input.gt, input.est, associate_tum(input.gt, input.est, tool_association(options, kTumMaxDifference)));
  if (matches.empty()) return {};
  const AlignmentResult alignment = align_or_throw(matches, options.alignment.value_or(Alignment::kSe3),
                                                   options.align_first_n, "compat:rpg");
  Evaluation evaluation = ate_evaluation(matches, alignment);
  for (MatchedPose& match : matches) match.est = alignment.S_w_v * match.est;
  evaluation.segments = segment_errors(
      matches, {.lengths_m = options.segment_lengths_m, .tolerance = kRpgTolerance, .shift_starts = true});
  evaluation.drift_percent = drift_percent(evaluation.segments);
  return evaluation;
}

Evaluation evaluate_compat_openloris(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  if (options.alignment && *options.alignment != Alignment::kSe3 && *options.alignment != Alignment::kSim3) {
    throw InputError("--align", "compat:openloris supports only se3 and sim3");
  }
  if (input.gt.poses.empty()) return {};
  const OpenlorisOptions metric{
      .correct = {}, .max_gap_s = options.max_difference_s.value_or(0.5), .scale = false};
  const std::vector<MatchedPose> matches = matched_poses(
      input.gt, input.est, associate_interpolated(input.gt, input.est, metric.max_gap_s, options.offset_s));
  const AlignmentResult alignment =
      align(matches, options.alignment.value_or(Alignment::kSe3), options.align_first_n);
  Evaluation evaluation = ate_evaluation(matches, alignment);
  Trajectory shifted = input.est;
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, options.offset_s);
  const OpenlorisSequenceScore score = score_openloris_sequence(input.gt, shifted, alignment.S_w_v, metric);
  evaluation.correct_rate = score.correct_rate;
  evaluation.first_pose_s = score.relocalization_time_s;
  return evaluation;
}

}  // namespace stillpoint::eval
