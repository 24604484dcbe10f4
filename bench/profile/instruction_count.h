// SPDX-License-Identifier: BSD-3-Clause
/// Executed instructions of the odometry, stage by stage: the same number in every run of the same program,
/// however busy the machine is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/process/child_process.h"
#include "bench/profile/callgrind_file.h"
#include "bench/store/stored_run.h"

namespace stillpoint {

/// Its name in the folder of a run.
inline constexpr const char* kCallgrindFile = "callgrind.out";

/// Turns `stillpoint run` into the same under callgrind, which writes `kCallgrindFile` into a folder.
/// What could change a count from run to run is fixed: one processor and no thread for decoding, so that
/// nobody waits; threads that libraries start take turns; memory lies at the same addresses; the environment
/// and the paths of results are the same. The processor is valgrind's, whatever the real one: it has AVX2.
/// @param run    with the absolute path of its sequence, and --sequence-id: a checksum would take longer than
/// the run
/// @param folder where results and counts go; made if need be
/// @throws InputError if there is no valgrind
[[nodiscard]] ProcessSpec under_callgrind(ProcessSpec run, const std::filesystem::path& folder);

/// What one stage of the odometry executed.
struct StageInstructions {
  std::string stage;
  std::int64_t count = 0;
};

/// Tracking, object detection and optimisation, in this order; decoding and recording are left out.
/// @throws InputError if the counts name none of them
[[nodiscard]] std::vector<StageInstructions> stage_instructions(const CallgrindCounts& counts,
                                                                const std::string& place);

/// "instructions" of all stages together, and "instructions_" and its name of each.
[[nodiscard]] std::vector<Metric> instruction_metrics(const std::vector<StageInstructions>& stages);

/// Reads and sums what a run under `under_callgrind` left behind.
/// @throws InputError if it left nothing
[[nodiscard]] std::vector<StageInstructions> read_instructions(const std::filesystem::path& folder);

}  // namespace stillpoint
