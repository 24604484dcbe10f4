// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "eval/openloris/benchmark.h"
#include "eval/trajectory/orientations.h"

namespace stillpoint::eval {
namespace {

constexpr double kNotDetermined = std::numeric_limits<double>::quiet_NaN();

/// RPE of a protocol, and the warnings that belong to it.
struct RpeEvaluation {
  std::optional<Statistics> translation_m;
  std::optional<Statistics> rotation_deg;
  std::size_t pairs = 0;  ///< of two poses
  std::vector<std::string> notes;
};

/// Matches, and an alignment that was fitted to the first of them.
struct AlignedMatches {
  MatchView matches;
  AlignmentResult alignment;
  CompletedAlignment completed;
};

AlignedMatches aligned(MatchView matches, Alignment kind, std::size_t first_n) {
  const std::size_t count = first_n == 0 ? matches.size() : std::min(first_n, matches.size());
  AlignedMatches result{matches, align(matches, kind, first_n), {}};
  result.completed = complete_rotation(matches.first(count), result.alignment.S_w_v, kind);
  return result;
}

/// An evaluation with the alignment, the ATE and the errors per pose, if the options ask for these; the other
/// fields are empty.
Evaluation ate_evaluation(const AlignedMatches& aligned, const AteErrors& errors,
                          const ProtocolOptions& options) {
  Evaluation evaluation;
  evaluation.pairs = aligned.matches.size();
  evaluation.alignment = aligned.alignment;
  evaluation.rotation_source = aligned.completed.source;
  evaluation.rotation_determined = aligned.completed.determined;
  if (aligned.completed.source != RotationSource::kPositions) evaluation.alignment.determined = false;
  evaluation.ate_m = statistics(errors.translation_m);
  if (aligned.completed.determined) evaluation.ate_deg = statistics(errors.rotation_deg);
  if (!options.per_pose) return evaluation;
  evaluation.per_pose.reserve(aligned.matches.size());
  for (std::size_t i = 0; i < aligned.matches.size(); ++i) {
    evaluation.per_pose.push_back({aligned.matches[i].t, errors.translation_m[i],
                                   aligned.completed.determined ? errors.rotation_deg[i] : kNotDetermined});
  }
  return evaluation;
}

Evaluation ate_evaluation(const AlignedMatches& aligned, const ProtocolOptions& options) {
  return ate_evaluation(aligned, ate_errors(aligned.matches, aligned.alignment.S_w_v, aligned.completed),
                        options);
}

constexpr std::size_t kMinMatchedPoses = 2;  // one is aligned without an error, whatever it is

Evaluation without_errors(MatchView matches) {
  Evaluation evaluation;
  evaluation.pairs = matches.size();
  return evaluation;
}

/// `evaluation` with an RPE and its notes.
Evaluation with_rpe(Evaluation evaluation, const RpeEvaluation& rpe) {
  evaluation.rpe_m = rpe.translation_m;
  evaluation.rpe_deg = rpe.rotation_deg;
  evaluation.rpe_pairs = rpe.pairs;
  evaluation.notes.insert(evaluation.notes.end(), rpe.notes.begin(), rpe.notes.end());
  return evaluation;
}

/// The alignment of a tool, SE(3) unless the options override it, over the matches.
AlignedMatches aligned(MatchView matches, const ProtocolOptions& options) {
  return aligned(matches, options.alignment.value_or(Alignment::kSe3), options.align_first_n);
}

/// `aligned`, for tools that reject positions that do not determine the alignment.
/// @throws InputError with the name of the protocol
AlignedMatches aligned_or_throw(MatchView matches, const ProtocolOptions& options,
                                const std::string& protocol) {
  AlignedMatches result = aligned(matches, options);
  if (result.alignment.determined) return result;
  throw InputError(
      protocol, "the alignment is not determined by " + std::to_string(matches.size()) +
                    " matched poses (their positions coincide or are collinear), which the tool rejects; use "
                    "strict:se3, or --align first_pose or none");
}

constexpr double kEvoMaxDifference = 0.01;  // [s], evo's t_max_diff
constexpr double kEvoTolerance = 0.1;       // of delta
constexpr double kTumMaxDifference = 0.02;  // [s]
constexpr double kRpgTolerance = 0.2;       // of the segment's length

AssociationOptions tool_association(const ProtocolOptions& options, double max_difference_s) {
  return {.max_difference_s = options.max_difference_s.value_or(max_difference_s),
          .offset_s = options.offset_s,
          .arithmetic = StampArithmetic::kDouble};
}

RpeEvaluation evo_rpe(MatchView matches, const ProtocolOptions& options) {
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
    result.notes.emplace_back("compat:evo has no RPE over seconds or degrees; use --rpe-unit f or m");
  }
  const RelativeErrors errors = relative_errors(matches, pairs);
  result.pairs = pairs.size();
  result.translation_m = statistics(errors.translation_m);
  result.rotation_deg = statistics(errors.rotation_deg);
  return result;
}

RpeEvaluation tum_rpe(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const std::optional<RpeResult> relative =
      rpe(input.gt, input.est,
          {.delta = options.rpe_delta, .unit = options.rpe_unit, .offset_s = options.offset_s});
  if (!relative) return {{}, {}, 0, {"no RPE pair of two poses: they are further apart than delta"}};
  RpeEvaluation result{relative->translation_m,
                       relative->rotation_deg,
                       relative->translation_m.count - relative->self_pairs,
                       {}};
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

Evaluation evaluate_compat_tum(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const auto absolute = [&] {
    const PoseMatches matches(
        input.gt, input.est,
        associate_tum(input.gt, input.est, tool_association(options, kTumMaxDifference)));
    return matches.size() < kMinMatchedPoses ? without_errors(matches)
                                             : ate_evaluation(aligned(matches, options), options);
  };
  Evaluation evaluation = with_rpe(absolute(), tum_rpe(input));
  const bool is_compared_elsewhere = evaluation.rpe_pairs > 0 && evaluation.pairs < input.est.poses.size();
  if (const std::string note = sparse_truth_note(input.gt); is_compared_elsewhere && !note.empty())
    evaluation.notes.push_back(note + "; see strict:se3");
  return evaluation;
}

Evaluation evaluate_compat_evo(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const PoseMatches matches(input.gt, input.est,
                            associate_evo(input.gt, input.est, tool_association(options, kEvoMaxDifference)));
  if (matches.size() < kMinMatchedPoses) return without_errors(matches);
  return with_rpe(ate_evaluation(aligned_or_throw(matches, options, "compat:evo"), options),
                  evo_rpe(matches, options));
}

/// Of a tool without RPE, if the options state its interval.
void note_missing_rpe(Evaluation& evaluation, const ProtocolOptions& options) {
  if (options.rpe_delta != ProtocolOptions{}.rpe_delta || options.rpe_unit != RpeUnit::kSeconds)
    evaluation.notes.emplace_back("the tool has no RPE: --rpe-delta and --rpe-unit have no effect");
}

Evaluation evaluate_compat_rpg(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  PoseMatches matches(input.gt, input.est,
                      associate_tum(input.gt, input.est, tool_association(options, kTumMaxDifference)));
  if (matches.size() < kMinMatchedPoses) return without_errors(matches);
  Evaluation evaluation = ate_evaluation(aligned_or_throw(matches, options, "compat:rpg"), options);
  matches.align(evaluation.alignment.S_w_v);
  evaluation.segments = segment_errors(
      matches, {.lengths_m = options.segment_lengths_m, .tolerance = kRpgTolerance, .shift_starts = true});
  evaluation.drift_percent = drift_percent(evaluation.segments);
  note_missing_rpe(evaluation, options);
  return evaluation;
}

Trajectory shifted(Trajectory path, double offset_s) {
  for (StampedPose& pose : path.poses) pose.t = after(pose.t, offset_s);
  return path;
}

Evaluation evaluate_compat_openloris(const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  if (options.alignment && *options.alignment != Alignment::kSe3 && *options.alignment != Alignment::kSim3) {
    throw InputError("--align", "compat:openloris supports only se3 and sim3");
  }
  if (input.gt.poses.empty()) return {};
  const OpenlorisOptions metric{
      .correct = {}, .max_gap_s = options.max_difference_s.value_or(0.5), .scale = false};
  const PoseMatches matches(input.gt, input.est,
                            associate_interpolated(input.gt, input.est, metric.max_gap_s, options.offset_s));
  Evaluation evaluation = matches.size() < kMinMatchedPoses
                              ? without_errors(matches)
                              : ate_evaluation(aligned(matches, options), options);
  const OpenlorisSequenceScore score = score_openloris_sequence(
      input.gt, shifted(input.est, options.offset_s), evaluation.alignment.S_w_v, metric);
  evaluation.correct_rate = score.correct_rate;
  evaluation.first_pose_s = score.relocalization_time_s;
  note_missing_rpe(evaluation, options);
  return evaluation;
}

constexpr double kMaxHold = 1.0;  // [s], validity of a pose

/// What was not compared, and over which intervals the ground truth is interpolated.
std::vector<std::string> association_notes(const EvaluationInput& input, std::size_t matches) {
  std::vector<std::string> notes;
  char text[240];
  const double interval_s = median_pose_interval_s(input.gt);
  const double max_gap_s = input.options.max_difference_s.value_or(kStrictMaxGap);
  if (matches < input.est.poses.size()) {
    std::snprintf(text, sizeof text, "%zu of %zu poses dropped: no ground truth close enough",
                  input.est.poses.size() - matches, input.est.poses.size());
    notes.emplace_back(text);
    if (interval_s >= max_gap_s) {
      std::snprintf(
          text, sizeof text,
          "the ground truth has one pose per %.3g s; --max-difference %.3g interpolates between them",
          interval_s, 1.1 * interval_s);
      notes.emplace_back(text);
    }
  }
  if (max_gap_s > kStrictMaxGap && interval_s > kStrictMaxGap && matches > 0) {
    std::snprintf(text, sizeof text,
                  "the ground truth is interpolated over %.3g s: its path between the poses is not known",
                  interval_s);
    notes.emplace_back(text);
  }
  return notes;
}

RpeEvaluation strict_rpe_evaluation(MatchView matches, const ProtocolOptions& options) {
  if (options.rpe_unit == RpeUnit::kFrames) {
    throw InputError("--rpe-unit f",
                     "frame deltas are not comparable across runs; strict protocols support s, m and deg");
  }
  RpeEvaluation rpe;
  std::size_t dropped = 0;
  if (options.rpe_unit == RpeUnit::kSeconds) {
    const StrictRpeResult result = strict_rpe(matches, options.rpe_delta);
    dropped = result.dropped;
    if (result.errors) {
      rpe.translation_m = result.errors->translation_m;
      rpe.rotation_deg = result.errors->rotation_deg;
      rpe.pairs = result.errors->translation_m.count;
    }
  } else {
    const PosePairs found = strict_pairs(matches, options.rpe_delta, options.rpe_unit);
    const RelativeErrors errors = relative_errors(matches, found.pairs);
    dropped = found.dropped;
    rpe.pairs = found.pairs.size();
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
std::optional<double> jitter_of(MatchView matches, const Similarity& S_w_v) {
  if (matches.size() < 3) return std::nullopt;
  const auto error = [&](std::size_t i) -> Eigen::Vector3d {
    const MatchedPose match = matches[i];
    return S_w_v * match.est.p - match.gt.p;
  };
  Eigen::Vector3d previous = error(0);
  Eigen::Vector3d current = error(1);
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < matches.size(); ++i) {
    const Eigen::Vector3d next = error(i + 1);
    sum += (previous - 2.0 * current + next).squaredNorm();
    previous = std::exchange(current, next);
  }
  return std::sqrt(sum / static_cast<double>(matches.size() - 2));
}

/// The alignment, with the rotation of `complete_rotation` where it was fitted to a part of the matches,
/// since it decides the position errors of the others.
/// @throws InputError if position errors depend on what the matches do not determine
AlignedMatches strictly_aligned(MatchView matches, Alignment kind, std::size_t first_n) {
  AlignedMatches result = aligned(matches, kind, first_n);
  const CompletedAlignment& completed = result.completed;
  const bool no_scale = kind == Alignment::kSim3 && (completed.source == RotationSource::kStanding ||
                                                     completed.source == RotationSource::kUnlikePath);
  if (no_scale || (first_n > 0 && !completed.determined)) {
    throw InputError("strict protocol",
                     std::string(no_scale ? "the scale" : "the rotation") + " is not determined by " +
                         std::to_string(first_n > 0 ? std::min(first_n, matches.size()) : matches.size()) +
                         " matched poses (their positions coincide or are collinear); use --align " +
                         (no_scale ? "se3, first_pose or none" : "first_pose or none"));
  }
  if (first_n > 0) result.alignment.S_w_v = completed.S_w_v;
  return result;
}

/// Number of estimated poses between the first and the last one of the ground truth.
std::size_t covered_poses(const EvaluationInput& input) {
  if (input.gt.poses.empty()) return 0;
  const auto begin = std::ranges::lower_bound(input.est.poses, input.gt.poses.front().t, {}, &StampedPose::t);
  const auto end = std::ranges::upper_bound(input.est.poses, input.gt.poses.back().t, {}, &StampedPose::t);
  return begin < end ? static_cast<std::size_t>(end - begin) : 0;
}

/// Whether the matches and their SE(3) alignment are those of the correct rate.
bool has_errors_of_correct_rate(const EvaluationInput& input, MatchView matches, Alignment kind) {
  if (kind != Alignment::kSe3 || input.options.align_first_n > 0 ||
      input.options.max_difference_s.value_or(kStrictMaxGap) > kCorrectRateGap_s)
    return false;
  if (matches.size() == covered_poses(input)) return true;  // a longer gap adds none
  return associate_interpolated(input.gt, input.est, kCorrectRateGap_s).size() == matches.size();
}

/// An evaluation with the absolute errors and the correct rate.
Evaluation strict_errors(const EvaluationInput& input, MatchView matches, Alignment kind) {
  const ProtocolOptions& options = input.options;
  Evaluation evaluation = without_errors(matches);
  if (matches.size() >= kMinMatchedPoses) {
    const AlignedMatches aligned = strictly_aligned(matches, kind, options.align_first_n);
    const AteErrors errors = ate_errors(matches, aligned.alignment.S_w_v, aligned.completed);
    evaluation = ate_evaluation(aligned, errors, options);
    if (aligned.completed.determined && has_errors_of_correct_rate(input, matches, kind)) {
      evaluation.correct_rate = correct_rate(matches, errors, input.gt, options.correct);
      return evaluation;
    }
  }
  evaluation.correct_rate = correct_rate(input.gt, input.est, options.correct);
  return evaluation;
}

/// @param alignment used unless the options override it
/// @throws InputError if the matches do not determine the alignment, or for an RPE over frames
Evaluation evaluate_strict(const EvaluationInput& input, Alignment alignment) {
  const ProtocolOptions& options = input.options;
  if (options.offset_s != 0.0) {
    ProtocolOptions without_offset = options;
    without_offset.offset_s = 0.0;
    return evaluate_strict({input.gt, shifted(input.est, options.offset_s), without_offset}, alignment);
  }
  const Trajectory& est = input.est;
  const Alignment kind = options.alignment.value_or(alignment);
  PoseMatches matches(
      input.gt, est, associate_interpolated(input.gt, est, options.max_difference_s.value_or(kStrictMaxGap)));
  Evaluation evaluation = strict_errors(input, matches, kind);
  if (!input.gt.poses.empty()) {
    const TimeSpan whole{input.gt.poses.front().t, input.gt.poses.back().t};
    evaluation.lost = lost_spans(est, whole, kMaxHold);
    evaluation.coverage = time_coverage(evaluation.lost, whole);
    evaluation.first_pose_s = first_pose_seconds(est, whole.begin);
  }
  const std::vector<std::string> association = association_notes(input, matches.size());
  evaluation.notes.insert(evaluation.notes.end(), association.begin(), association.end());
  if (evaluation.correct_rate && (kind != Alignment::kSe3 || options.align_first_n > 0))
    evaluation.notes.emplace_back("CR is that after SE(3) alignment over all matches, whatever --align");
  if (matches.size() < kMinMatchedPoses) return evaluation;
  const Similarity S_w_v = evaluation.alignment.S_w_v;
  evaluation.jitter_m = jitter_of(matches, S_w_v);
  matches.align(S_w_v);
  evaluation = with_rpe(std::move(evaluation), strict_rpe_evaluation(matches, options));
  evaluation.segments =
      segment_errors(matches, {.lengths_m = options.segment_lengths_m, .tolerance = kSegmentTolerance});
  evaluation.drift_percent = drift_percent(evaluation.segments);
  return evaluation;
}

template <Alignment kAlignment>
Evaluation evaluate_strict(const EvaluationInput& input) {
  return evaluate_strict(input, kAlignment);
}

constexpr std::string_view kTumText =
    "ATE: stamps less than 20 ms apart, matched greedily and one-to-one from the closest on; SE(3) "
    "alignment over all pairs. RPE: each estimated pose with the one closest to delta later, without a "
    "tolerance, unless that is the last pose; ground truth closest to both, within twice its median "
    "interval; no alignment; all pairs (the tool samples 10000 of them). As evaluate_ate.py and "
    "evaluate_rpe.py --fixed_delta of the TUM RGB-D benchmark.";
constexpr std::string_view kEvoText =
    "Association: each stamp of the shorter trajectory with the closest one of the longer, at most 10 ms "
    "apart, not one-to-one. APE after SE(3) alignment over all pairs. RPE in the local frame, over "
    "consecutive pairs of frames, or over all pairs whose path length on the estimate is delta meters "
    "within 10 %. As evo_ape -a and evo_rpe [--all_pairs] of evo.";
constexpr std::string_view kRpgText =
    "Association: stamps less than 20 ms apart, greedy, one-to-one. Absolute errors after SE(3) "
    "alignment over all pairs. Relative errors over segments of 10, 20, 30, 40 and 50 % of the ground "
    "truth's path length, with a tolerance of 20 % of the length, rotated into the world frame. After a "
    "start without an end, later ends are assigned to shifted starts, as the tool does. As "
    "rpg_trajectory_evaluation; alignment yaw is posyaw of rpg_trajectory_evaluation and OpenVINS "
    "ov_eval.";
constexpr std::string_view kOpenlorisText =
    "Ground truth interpolated at each estimated pose, both neighbors less than 0.5 s away; SE(3) "
    "alignment over all matches. Correct rate: total validity of correct poses, at most 1 s each, "
    "divided by the duration of the ground truth. As evaluate.py of the OpenLORIS-Scene tools, whose "
    "error thresholds are infinite by default and which have no RPE.";
constexpr std::string_view kStrictText =
    "Ground truth interpolated at each estimated pose, both neighbors less than 0.11 s (--max-difference) "
    "away, "
    "exact stamps. Alignment over all matches; a rotation that positions do not determine (straight or "
    "standing) "
    "is that of the orientations, errors in degrees are n/a if these contradict each other. RPE from every "
    "match to "
    "the one closest to delta later; pairs that miss delta by more than half a frame interval or a tenth "
    "of delta are dropped and counted. Coverage: fraction of the ground truth's duration with a valid "
    "pose; a pose is valid for at most 1 s. Errors are only comparable together with the coverage.";

constexpr std::array<Protocol, 9> kProtocols{{
    {"compat:tum", 1, kTumText, evaluate_compat_tum},
    {"compat:evo", 1, kEvoText, evaluate_compat_evo},
    {"compat:rpg", 1, kRpgText, evaluate_compat_rpg},
    {"compat:openloris", 1, kOpenlorisText, evaluate_compat_openloris},
    {"strict:se3", 1, kStrictText, evaluate_strict<Alignment::kSe3>},
    {"strict:yaw", 1, kStrictText, evaluate_strict<Alignment::kYaw>},
    {"strict:sim3", 1, kStrictText, evaluate_strict<Alignment::kSim3>},
    {"strict:first_pose", 1, kStrictText, evaluate_strict<Alignment::kFirstPose>},
    {"strict:none", 1, kStrictText, evaluate_strict<Alignment::kNone>},
}};

/// Description of the overridden parameters.
std::string overrides_text(const ProtocolOptions& options) {
  std::string text;
  char buffer[96];
  if (options.alignment) {
    for (const auto& [kind, name] : enum_names(Alignment{})) {
      if (kind == *options.alignment) text += " Alignment: " + std::string(name) + ".";
    }
  }
  if (options.align_first_n > 0)
    text += " Aligned over the first " + std::to_string(options.align_first_n) + " matches.";
  if (options.max_difference_s) {
    std::snprintf(buffer, sizeof buffer, " Maximum difference of stamps: %g s.", *options.max_difference_s);
    text += buffer;
  }
  if (options.offset_s != 0.0) {
    std::snprintf(buffer, sizeof buffer, " Time offset added to the estimate: %.9g s.", options.offset_s);
    text += buffer;
  }
  return text;
}

/// Evaluates with the world of the estimate leveled if the alignment is in yaw and its tilt is known. The
/// alignment of the result includes the leveling.
Evaluation evaluate_leveled(const Protocol& protocol, const EvaluationInput& input) {
  const ProtocolOptions& options = input.options;
  const bool yaw = options.alignment ? *options.alignment == Alignment::kYaw : protocol.name == "strict:yaw";
  if (!yaw || !options.q_level_w) return protocol.evaluate(input);
  Trajectory leveled = input.est;
  for (StampedPose& pose : leveled.poses)
    pose.T_w_f = Pose{*options.q_level_w, Eigen::Vector3d::Zero()} * pose.T_w_f;
  Evaluation evaluation = protocol.evaluate({input.gt, leveled, options});
  Eigen::Quaterniond& q = evaluation.alignment.S_w_v.T_w_v.q;
  q = (q * *options.q_level_w).normalized();
  char note[96];
  std::snprintf(note, sizeof note, "the world was leveled by the estimated gravity, by %.3f deg",
                rotation_angle(*options.q_level_w) * 180.0 / std::numbers::pi);
  evaluation.notes.emplace_back(note);
  return evaluation;
}

}  // namespace

std::span<const Protocol> protocols() { return kProtocols; }

namespace {

std::string open_rotation_text(RotationSource source) {
  switch (source) {
    case RotationSource::kPositions:
      return "";
    case RotationSource::kLine:
      return "the path is a straight line: positions leave the rotation about it not determined";
    case RotationSource::kStanding:
      return "the positions stand still: they leave the rotation not determined";
    case RotationSource::kUnlikePath:
      break;
  }
  return "the positions do not follow those of the ground truth: they leave the rotation not determined";
}

/// What the positions leave open; empty if nothing.
std::string rotation_note(const Evaluation& evaluation) {
  const std::string open = open_rotation_text(evaluation.rotation_source);
  if (open.empty()) return "";
  return open + (evaluation.rotation_determined
                     ? "; errors in degrees are those after the rotation that fits the orientations best"
                     : ", and the orientations do not tell it: errors in degrees are n/a");
}

/// `evaluation` without the metrics that mean nothing, and with notes about doubtful ones.
Evaluation with_doubts(Evaluation evaluation, const EvaluationInput& input) {
  constexpr std::size_t kFewPoses = 10;
  const auto note = [&](const std::string& text) { evaluation.notes.push_back(text); };
  if (const std::string missing = missing_orientations(input.gt, input.est, input.options.offset_s);
      !missing.empty()) {
    note(missing);
    evaluation.rotation_determined = evaluation.rotation_source == RotationSource::kPositions;
    evaluation.ate_deg = evaluation.rpe_m = evaluation.rpe_deg = std::nullopt;
    evaluation.rpe_pairs = 0;
    for (PoseError& error : evaluation.per_pose) error.rotation_deg = kNotDetermined;
    evaluation.segments.clear();
    evaluation.drift_percent = evaluation.correct_rate = std::nullopt;
  }
  if (const std::string open = rotation_note(evaluation); !open.empty()) note(open);
  if (input.est.poses.size() == 1) {
    note("failed: the estimate has one pose, and no error can be computed from it");
  } else if (evaluation.pairs > 0 && evaluation.pairs < kFewPoses) {
    note("only " + std::to_string(evaluation.pairs) +
         (evaluation.pairs == 1 ? " pose was compared, which tells no error" : " poses were compared"));
  }
  if (evaluation.rpe_m && evaluation.rpe_pairs < kFewRpePairs)
    note("the RPE is that of only " + std::to_string(evaluation.rpe_pairs) + " pairs");
  const std::size_t comparable = std::min(input.gt.poses.size(), input.est.poses.size());
  if (evaluation.pairs > 0 && 2 * evaluation.pairs < comparable)
    note("only " + std::to_string(evaluation.pairs) + " of " + std::to_string(input.est.poses.size()) +
         " poses were compared, with " + std::to_string(input.gt.poses.size()) + " of the ground truth");
  if (evaluation.alignment.S_w_v.scale != 1.0) {
    char text[80];
    std::snprintf(text, sizeof text, "the estimate was scaled by %.5g", evaluation.alignment.S_w_v.scale);
    note(text);
  }
  return evaluation;
}

}  // namespace

Evaluation evaluate(std::string_view protocol, const EvaluationInput& input) {
  std::string known;
  for (const Protocol& candidate : kProtocols) {
    if (candidate.name == protocol) {
      Evaluation evaluation = with_doubts(evaluate_leveled(candidate, input), input);
      evaluation.protocol = candidate.name;
      evaluation.version = candidate.version;
      evaluation.text = std::string(candidate.text) + overrides_text(input.options);
      evaluation.gt_poses = input.gt.poses.size();
      evaluation.est_poses = input.est.poses.size();
      evaluation.rpe_delta = input.options.rpe_delta;
      evaluation.rpe_unit = input.options.rpe_unit;
      return evaluation;
    }
    known += (known.empty() ? "" : ", ") + std::string(candidate.name);
  }
  throw InputError("--protocol " + std::string(protocol), "unknown protocol; expected one of: " + known);
}

}  // namespace stillpoint::eval
