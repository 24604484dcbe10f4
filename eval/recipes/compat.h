// SPDX-License-Identifier: BSD-3-Clause
/// Recipes that print what the public tools print, their traps included.
#pragma once

#include "eval/recipes/recipe.h"

namespace stillpoint {

[[nodiscard]] Evaluation evaluate_tum(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_evo(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_rpg(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_openloris_recipe(const EvaluationInput& input);

/// Fills the absolute errors, per pose too, and the coverage of the ground truth's time.
void fill_absolute(Evaluation& evaluation, std::span<const MatchedPose> matches,
                   const AlignmentResult& alignment);

}  // namespace stillpoint
