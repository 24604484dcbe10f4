// SPDX-License-Identifier: BSD-3-Clause
/// Strict protocols: exact time stamps, no interpolation or RPE pair across a gap, coverage with every error.
#pragma once

#include "eval/protocols/protocol.h"

namespace stillpoint::eval {

/// @param input both trajectories have the same body frame
/// @param alignment used unless the options override it
/// @throws InputError if the matches do not determine the alignment, or for an RPE over frames
[[nodiscard]] Evaluation evaluate_strict(const EvaluationInput& input, Alignment alignment);

template <Alignment kAlignment>
[[nodiscard]] Evaluation evaluate_strict(const EvaluationInput& input) {
  return evaluate_strict(input, kAlignment);
}

}  // namespace stillpoint::eval
