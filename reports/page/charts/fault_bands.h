// SPDX-License-Identifier: BSD-3-Clause
/// Times at which sensor faults were injected into a run.
#pragma once

#include <string>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint::report {

/// A fault is active during [begin, end), in seconds since the first frame.
struct FaultBand {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string fault;  ///< as in `--fault`
};

/// @param manifest of the run, JSON; empty or without faults: no bands
/// @param first, last timestamps of the frames
/// @throws InputError for faults of an unknown kind
[[nodiscard]] std::vector<FaultBand> fault_bands(const std::string& manifest, Timestamp first,
                                                 Timestamp last);

}  // namespace stillpoint::report
