// SPDX-License-Identifier: BSD-3-Clause
/// Times of the modules of an external system, read from the file that `timings` of its description names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/process/child_process.h"
#include "bench/systems/external_system.h"

namespace stillpoint::bench {

/// Times in one of three formats:
///
///   JSON           {"modules": {NAME: TIME}, "threads": {NAME: TIME}}, or these as the member "timings".
///   TIME
///                  is a list of milliseconds, one per call (of a thread: per frame), or an object with
///                  calls, and mean, median, p95 and max in milliseconds.
///   CSV            a file named *.csv with a header: the columns that [timing] names; without it those whose
///                  names end in "_ms". One row per call; an empty cell is no call.
///   lines of text  with [timing] and any other file, or the messages of the program if `timings` is empty:
///                  each match of the pattern of a module is a call, its group is the time.
///
/// Times of the last two are in `timing_unit`.
/// @param work output folder of the run
/// @param process for its messages
/// @return without modules that were never called, whose time is not 0; empty if the description has neither
/// `timings` nor [timing]
/// @throws InputError if the file cannot be read, is in another format, a module of [timing] is not in it, or
/// a time is no finite number of at least 0
[[nodiscard]] std::vector<ModuleCost> read_module_times(const ExternalSystem& system,
                                                        const std::filesystem::path& work,
                                                        const ProcessResult& process);

/// What `read_module_times` throws for these arguments; empty if it returns.
[[nodiscard]] std::string times_problem(const ExternalSystem& system, const std::filesystem::path& work,
                                        const ProcessResult& process);

/// The problem of the pattern of a module; empty if it is a regular expression with one group.
[[nodiscard]] std::string pattern_problem(const std::string& pattern);

}  // namespace stillpoint::bench
