// SPDX-License-Identifier: BSD-3-Clause
/// Stored runs for tests of comparisons.
#pragma once

#include <string>

#include <fmt/format.h>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// A succeeded run of variant "vo" whose trajectory is a function of sequence, error and repetition;
/// repetition i has the perturbation seed i - 1.
inline StoredRun compared_run(const std::string& sequence, double ate_m, int repetition,
                              const std::string& build = "base") {
  StoredRun run;
  run.identity = {.variant = "vo",
                  .sequence = sequence,
                  .sequence_id = "files of " + sequence,
                  .config_hash = perturbed_hash("0123456789abcdef", repetition - 1),
                  .build = build,
                  .repetition = repetition};
  run.metrics = {{"ate_rmse_m", "", "m", ate_m}, {"process_cpu_s", "", "s", 10.0}};
  run.blobs = {{"trajectory", fmt::format("{} {} {}", sequence, ate_m, repetition)}};
  return run;
}

}  // namespace stillpoint::bench
