// SPDX-License-Identifier: BSD-3-Clause
/// Protocols that reproduce the numbers of public tools, including their known limitations.
#pragma once

#include "eval/protocols/protocol.h"

namespace stillpoint::eval {

[[nodiscard]] Evaluation evaluate_compat_tum(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_evo(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_rpg(const EvaluationInput& input);
[[nodiscard]] Evaluation evaluate_compat_openloris(const EvaluationInput& input);

/// Fills the alignment, the ATE and the errors per pose.
void fill_ate(Evaluation& evaluation, std::span<const MatchedPose> matches, const AlignmentResult& alignment);

}  // namespace stillpoint::eval
