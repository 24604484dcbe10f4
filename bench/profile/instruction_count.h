// SPDX-License-Identifier: BSD-3-Clause
/// Executed instructions per stage of the odometry, counted by Valgrind's callgrind: reproducible between
/// runs of the same binary, independent of the machine's load.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/process/child_process.h"

namespace stillpoint::bench {

/// Executed instructions by function, with callgrind's function names (including parameter types).
struct CallgrindCounts {
  std::int64_t total = 0;
  std::map<std::string, std::int64_t> self;       ///< without callees
  std::map<std::string, std::int64_t> inclusive;  ///< with callees, summed over all calls
};

/// @param text  callgrind.out with the single event "Ir"; names may be compressed (the default)
/// @param place name of the text in messages
/// @throws InputError with the line of the first error
/// Source: Callgrind Format Specification, Valgrind manual 3.19.
[[nodiscard]] CallgrindCounts parse_callgrind(std::string_view text, const std::string& place);

/// File name in the folder of a run.
inline constexpr const char* kCallgrindFile = "callgrind.out";

/// Wraps `stillpoint run` in callgrind, which writes `kCallgrindFile` into a folder.
/// Everything that could change a count is fixed: one processor, no decoding thread, fair scheduling of
/// library threads, no address space randomization, constant environment and result paths. The instruction
/// set is that of valgrind's virtual CPU (with AVX2), not of the host.
/// @param run    with the absolute path of its sequence, and --sequence-id (a checksum would take longer than
///               the run)
/// @param folder for results and counts; created if it does not exist
/// @throws InputError if valgrind is not installed
[[nodiscard]] ProcessSpec under_callgrind(ProcessSpec run, const std::filesystem::path& folder);

/// Executed instructions of one stage.
struct StageInstructions {
  std::string stage;
  std::int64_t count = 0;
};

/// Tracking, object detection and optimization, in this order; decoding and recording are excluded.
/// @throws InputError if the counts contain none of them
[[nodiscard]] std::vector<StageInstructions> stage_instructions(const CallgrindCounts& counts,
                                                                const std::string& place);

/// The metrics of source `MetricSource::kInstructions`: the sum of all stages, and each stage.
[[nodiscard]] std::vector<Metric> instruction_metrics(const std::vector<StageInstructions>& stages);

/// Reads the output of a run of `under_callgrind`.
/// @throws InputError if there is none
[[nodiscard]] std::vector<StageInstructions> read_instructions(const std::filesystem::path& folder);

}  // namespace stillpoint::bench
