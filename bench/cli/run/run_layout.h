// SPDX-License-Identifier: BSD-3-Clause
/// Contents of the output folders of `run` and `profile`, and how earlier outputs are recognized.
#pragma once

#include "bench/record/output_guard.h"

namespace stillpoint::bench {

[[nodiscard]] OutputLayout run_layout();
[[nodiscard]] OutputLayout video_layout();  ///< of --video
[[nodiscard]] OutputLayout profile_layout();

}  // namespace stillpoint::bench
