// SPDX-License-Identifier: BSD-3-Clause
/// The OpenLORIS-Scene figure of the paper (Sec. IV): a time line per system and scene.
///
/// Black dots on the top line begin a sequence. For each system, blue dots are first poses, blue bars are
/// spans in which a correct pose stands; the number at their left is the correct rate over the whole scene,
/// the first line below is the ATE [m], the second T.RPE [m/s] and R.RPE [deg/s]. Here RPE is the strict one:
/// it shows "-" where a system has no motion over 1 s.
#pragma once

#include "eval/openloris/scene_score.h"
#include "reports/drawing.h"

namespace stillpoint {

/// Every system and scene of the benchmark; 1000 units wide, legible when printed at the width of a column.
[[nodiscard]] Drawing openloris_figure(const OpenlorisBenchmark& benchmark);

}  // namespace stillpoint
