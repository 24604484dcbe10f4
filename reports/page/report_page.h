// SPDX-License-Identifier: BSD-3-Clause
/// A self-contained HTML report of a store; a pure function of the store.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/store.h"
#include "eval/openloris/benchmark.h"
#include "reports/page/report_subject.h"

namespace stillpoint::report {

/// Input of the OpenLORIS benchmark: runs on sequences named after an OpenLORIS scene, rendered or recorded,
/// excluding sweeps; each seed counts as one sequence of its scene. `systems` is empty without such runs.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] eval::OpenlorisBenchmark openloris_of_runs(const bench::Store& store,
                                                         std::span<const bench::StoredRun> runs);

/// Number of runs, and the failed ones; at most five are listed individually.
[[nodiscard]] std::vector<std::string> outcome_sentences(std::span<const bench::StoredRun> runs);

/// The variant with the smallest median ATE on most sequences; empty with fewer than two variants.
[[nodiscard]] std::string best_sentence(std::span<const bench::StoredRun> runs);

/// The page in one file.
[[nodiscard]] std::string report_html(const bench::Store& store, const ReportSubject& subject);

/// The page with the data of each run in a file of its own, which is loaded when the run is selected:
/// index.html and runs/KEY.json. It must be served; a browser does not load files of a folder.
[[nodiscard]] std::vector<bench::OutputFile> served_report(const bench::Store& store,
                                                           const ReportSubject& subject);

}  // namespace stillpoint::report
