// SPDX-License-Identifier: BSD-3-Clause
/// Recipes of our own: exact stamps, no partner across a gap, and coverage beside every error.
#pragma once

#include "eval/recipes/recipe.h"

namespace stillpoint {

/// @param alignment unless the options name another
/// @throws InputError when the alignment is not determined by the matches, or for RPE over frames
[[nodiscard]] Evaluation evaluate_strict(const EvaluationInput& input, Alignment alignment);

template <Alignment kAlignment>
[[nodiscard]] Evaluation evaluate_strict(const EvaluationInput& input) {
  return evaluate_strict(input, kAlignment);
}

}  // namespace stillpoint
