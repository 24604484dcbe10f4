// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/protocol.h"

#include <array>
#include <cstdio>
#include <numbers>

#include "core/base/error.h"
#include "eval/metrics/ate.h"
#include "eval/protocols/compat.h"
#include "eval/protocols/strict.h"

namespace stillpoint::eval {
namespace {

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
    "Ground truth interpolated at each estimated pose, both neighbors less than 0.11 s away, exact "
    "stamps. Alignment over all matches, an error if they do not determine it. RPE from every match to "
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

Evaluation evaluate(std::string_view protocol, const EvaluationInput& input) {
  std::string known;
  for (const Protocol& candidate : kProtocols) {
    if (candidate.name == protocol) {
      Evaluation evaluation = evaluate_leveled(candidate, input);
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
