// SPDX-License-Identifier: BSD-3-Clause
/// A self-contained HTML report of a store, and its tables as files; a pure function of the store.
///
/// Converts stored runs on OpenLORIS scenes to input of the OpenLORIS benchmark.
///
/// Summary sentences of a report: number of runs, failures, best variant, changes since an earlier build.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/analysis/comparison.h"
#include "bench/model/stored_run.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "eval/openloris/benchmark.h"
#include "reports/page/plan_ablations.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// Runs on sequences named after an OpenLORIS scene, rendered or recorded, excluding sweeps; each seed counts
/// as one sequence of its scene. `systems` is empty without such runs.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] eval::OpenlorisBenchmark openloris_of_runs(const bench::Store& store,
                                                         std::span<const bench::StoredRun> runs);

/// Number of runs, and the failed ones; at most five are listed individually.
[[nodiscard]] std::vector<std::string> outcome_sentences(std::span<const bench::StoredRun> runs);

/// The variant with the smallest median ATE on most sequences; empty with fewer than two variants.
[[nodiscard]] std::string best_sentence(std::span<const bench::StoredRun> runs);

/// Metrics that improved or regressed since an earlier build.
/// @param base name of that build
[[nodiscard]] std::vector<std::string> change_sentences(const std::string& base,
                                                        const bench::Comparison& comparison);

/// Contents of a report page.
struct ReportSubject {
  std::string title;
  std::vector<bench::StoredPlan> plans;      ///< the plans that the runs belong to
  std::vector<bench::StoredRun> runs;        ///< shown on the page
  std::vector<bench::StoredRun> other_runs;  ///< of other builds, for the comparison
  std::vector<std::string> gaps;             ///< runs with missing or damaged files, one sentence each
  std::vector<std::string> published;        ///< names of published tables to compare with
  std::vector<ReportTable> paper;            ///< the paper's tables that plans of the page reproduce
  PlanAblations ablations;                   ///< of `plans`, with the names that each plan uses
};

/// All plans of the store or a single one; of each plan the runs of the newest build.
/// @param plan name; empty: all plans, or all runs where there are no plans
/// @throws InputError if the store has no such plan or no finished runs
[[nodiscard]] ReportSubject report_subject(const bench::Store& store, const std::string& plan);

/// Paper tables, metric tables, module times, and comparisons with published tables.
[[nodiscard]] std::vector<ReportTable> report_tables(const ReportSubject& subject);

/// A table as NAME.md, NAME.tex, NAME.csv and NAME.json.
[[nodiscard]] std::vector<bench::OutputFile> table_files(const ReportTable& table);

/// index.html.
[[nodiscard]] std::string report_html(const bench::Store& store, const ReportSubject& subject);

}  // namespace stillpoint::report
