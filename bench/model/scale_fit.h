// SPDX-License-Identifier: BSD-3-Clause
/// Scale of estimates that have none, such as those of one camera without depth and IMU.
#pragma once

#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"
#include "core/types/trajectory.h"

namespace stillpoint::bench {

/// What the protocols of metrics state if the scale was fitted.
inline constexpr std::string_view kScaleFitted = ", scale fitted to the ground truth";

/// Multiplies the positions of an estimate by the scale of the Sim(3) alignment with the ground truth
/// (eval/trajectory/alignment.h), over poses that are associated as by the TUM tools.
/// @param truth poses of the same body frame
/// @return the factor; 1 if the poses do not determine it
double fit_scale(Trajectory& estimate, const Trajectory& truth);

/// Appends `kScaleFitted` to the protocols.
void state_fitted_scale(std::vector<Metric>& metrics);

}  // namespace stillpoint::bench
