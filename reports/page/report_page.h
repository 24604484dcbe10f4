// SPDX-License-Identifier: BSD-3-Clause
/// A self-contained HTML report of a store, and its tables as files; a pure function of the store.
#pragma once

#include <string>
#include <vector>

#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "reports/page/plan_ablations.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

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
