// SPDX-License-Identifier: BSD-3-Clause
/// Checks that an estimate and its ground truth are of the same time.
#pragma once

#include <string>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// @param gt, est not empty
/// @param offset_s added to the stamps of the estimate
/// @param place the estimate, as the user wrote it
/// @throws InputError if no stamp of one lies between the first and the last of the other
void require_overlap(const Trajectory& gt, const Trajectory& est, double offset_s, const std::string& place);

}  // namespace stillpoint::eval
