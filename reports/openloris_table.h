// SPDX-License-Identifier: BSD-3-Clause
/// The scene table of an OpenLORIS evaluation, RPE beside the correct rate.
#pragma once

#include <string>

#include "eval/openloris/scene_score.h"
#include "reports/text_table.h"

namespace stillpoint {

/// A row a system and scene, every correct rate and error by its own name.
[[nodiscard]] std::string openloris_table(const OpenlorisBenchmark& benchmark, TableStyle style);

}  // namespace stillpoint
