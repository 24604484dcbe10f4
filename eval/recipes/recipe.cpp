// SPDX-License-Identifier: BSD-3-Clause
#include "eval/recipes/recipe.h"

#include <array>
#include <cstdio>

#include "core/base/error.h"
#include "eval/recipes/compat.h"
#include "eval/recipes/strict.h"

namespace stillpoint {
namespace {

constexpr std::string_view kTumText =
    "ATE: pairs closer than 20 ms, greedily from the closest on, one-to-one; rigid alignment over all pairs; "
    "RPE: each estimate with the estimate nearest to one delta later, however far, unless that is the last; "
    "ground truth nearest to both, within twice its median interval; no alignment; all pairs, where the tool "
    "draws 10000 of them. As evaluate_ate.py and evaluate_rpe.py --fixed_delta of the TUM RGB-D benchmark.";
constexpr std::string_view kEvoText =
    "Pairs: each stamp of the shorter trajectory with the nearest of the longer, at most 10 ms apart, not "
    "one-to-one; APE after rigid alignment over all pairs; RPE between consecutive pairs of frames, or "
    "between "
    "all pairs of positions whose path on the estimate is delta metres within 10 %, in the local frame. As "
    "evo_ape -a and evo_rpe [--all_pairs] of evo.";
constexpr std::string_view kRpgText =
    "Pairs closer than 20 ms, greedily, one-to-one; absolute errors after rigid alignment over all pairs; "
    "relative errors over stretches of 10, 20, 30, 40 and 50 % of the ground truth's path, end within 20 % "
    "of "
    "the length, rotated into the world. After a start without an end the tool shifts the later starts; so "
    "do "
    "we. As rpg_trajectory_evaluation; yaw alignment as posyaw of it and of OpenVINS ov_eval.";
constexpr std::string_view kOpenlorisText =
    "Ground truth interpolated at each estimate, both neighbours nearer than 0.5 s; rigid alignment over all "
    "matches; correct rate: time for which a correct pose stands, 1 s each at most, over the ground truth's "
    "time. As evaluate.py of the OpenLORIS-Scene tools, whose thresholds are infinite by default; RPE is not "
    "part of them.";
constexpr std::string_view kStrictText =
    "Ground truth interpolated at each estimate, both neighbours nearer than 0.11 s, exact stamps; alignment "
    "over all matches, an error when they do not determine it; RPE from every match to the one delta later, "
    "dropped when that is off by more than half a frame interval or a tenth of delta, the dropped counted; "
    "coverage: share of the ground truth's time in which a pose stands, 1 s each at most. Read the errors "
    "beside the coverage.";

constexpr std::array<Recipe, 9> kRecipes{{
    {"compat:tum", 1, kTumText, evaluate_tum},
    {"compat:evo", 1, kEvoText, evaluate_evo},
    {"compat:rpg", 1, kRpgText, evaluate_rpg},
    {"compat:openloris", 1, kOpenlorisText, evaluate_openloris_recipe},
    {"strict:se3", 1, kStrictText, evaluate_strict<Alignment::kSe3>},
    {"strict:yaw", 1, kStrictText, evaluate_strict<Alignment::kYaw>},
    {"strict:sim3", 1, kStrictText, evaluate_strict<Alignment::kSim3>},
    {"strict:first_pose", 1, kStrictText, evaluate_strict<Alignment::kFirstPose>},
    {"strict:none", 1, kStrictText, evaluate_strict<Alignment::kNone>},
}};

/// What the options changed, appended to the recipe's text.
std::string changes_text(const RecipeOptions& options) {
  std::string text;
  char buffer[96];
  if (options.alignment) {
    for (const auto& [kind, name] : enum_names(Alignment{})) {
      if (kind == *options.alignment) text += " Alignment: " + std::string(name) + ".";
    }
  }
  if (options.align_first_n > 0)
    text += " Aligned over the first " + std::to_string(options.align_first_n) + ".";
  if (options.max_difference_s) {
    std::snprintf(buffer, sizeof buffer, " Greatest difference of stamps: %g s.", *options.max_difference_s);
    text += buffer;
  }
  if (options.offset_s != 0.0) {
    std::snprintf(buffer, sizeof buffer, " %.9g s were added to the estimate's stamps.", options.offset_s);
    text += buffer;
  }
  return text;
}

}  // namespace

std::span<const Recipe> recipes() { return kRecipes; }

Evaluation evaluate(std::string_view recipe, const EvaluationInput& input) {
  std::string known;
  for (const Recipe& candidate : kRecipes) {
    if (candidate.name == recipe) {
      Evaluation evaluation = candidate.evaluate(input);
      evaluation.recipe = candidate.name;
      evaluation.version = candidate.version;
      evaluation.text = std::string(candidate.text) + changes_text(input.options);
      evaluation.gt_poses = input.gt.poses.size();
      evaluation.est_poses = input.est.poses.size();
      evaluation.rpe_delta = input.options.rpe_delta;
      evaluation.rpe_unit = input.options.rpe_unit;
      return evaluation;
    }
    known += (known.empty() ? "" : ", ") + std::string(candidate.name);
  }
  throw InputError("--recipe " + std::string(recipe), "is not known; there are " + known);
}

}  // namespace stillpoint
