// SPDX-License-Identifier: BSD-3-Clause
/// Scene table of an OpenLORIS evaluation: correct rates, ATE and RPE.
#pragma once

#include <string>

#include "eval/openloris/scene_score.h"
#include "reports/tables/text_table.h"

namespace stillpoint::report {

/// One row per system and scene; every definition of correct rate and error has a column of its own.
[[nodiscard]] std::string openloris_table(const eval::OpenlorisBenchmark& benchmark, TableStyle style);

}  // namespace stillpoint::report
