// SPDX-License-Identifier: BSD-3-Clause
/// Protocols that reproduce the numbers of public tools, including their known limitations.
#pragma once

#include "eval/protocols/protocol.h"

namespace stillpoint::eval {

[[nodiscard]] Evaluation evaluate_compat_tum(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_evo(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_rpg(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_openloris(const EvaluationInput& input);

/// An evaluation with the alignment, the ATE and the errors per pose; the other fields are empty.
[[nodiscard]] Evaluation ate_evaluation(std::span<const MatchedPose> matches,
                                        const AlignmentResult& alignment);

/// `evaluation` with an RPE and its notes.
[[nodiscard]] Evaluation with_rpe(Evaluation evaluation, const RpeEvaluation& rpe);

}  // namespace stillpoint::eval
