// SPDX-License-Identifier: BSD-3-Clause
/// The OpenLORIS-Scene figure of the paper (Sec. IV): one timeline per system and scene.
///
/// Black dots on the top line mark the start of each sequence. Per system, blue dots mark first poses and
/// blue bars the spans with correct poses. Above the bars: correct rate over the whole scene and ATE [m];
/// below: strict T.RPE [m/s] and R.RPE [deg/s], "-" where a system has no pose pair 1 s apart, or no
/// run.
#pragma once

#include "eval/openloris/benchmark.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// Every system and scene of the benchmark; 1000 units wide, legible when printed at the width of a column.
[[nodiscard]] Drawing openloris_figure(const eval::OpenlorisBenchmark& benchmark);

}  // namespace stillpoint::report
