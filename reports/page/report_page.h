// SPDX-License-Identifier: BSD-3-Clause
/// One page about a store that needs nothing but itself, and its tables as files: a pure function of the
/// store.
#pragma once

#include <string>
#include <vector>

#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "reports/tables/report_table.h"

namespace stillpoint {

/// What a page is about.
struct ReportSubject {
  std::string title;
  std::vector<StoredPlan> plans;       ///< the benchmarks that the runs belong to
  std::vector<StoredRun> runs;         ///< those of the page
  std::vector<StoredRun> other_runs;   ///< of other builds, to tell what changed
  std::vector<std::string> published;  ///< names of quoted tables to stand beside
  std::vector<ReportTable> paper;      ///< the paper's tables whose plans are among those of the page
};

/// Everything in the store, or one plan of it; the newest runs of each plan.
/// @param plan name; empty: all plans, or all runs where there are no plans
/// @throws InputError if the store has no such plan, or no runs
[[nodiscard]] ReportSubject report_subject(const Store& store, const std::string& plan);

/// Tables of a subject: the paper's, metrics, module times, beside quoted ones.
[[nodiscard]] std::vector<ReportTable> report_tables(const ReportSubject& subject);

/// A table as NAME.md, NAME.tex, NAME.csv, NAME.json.
[[nodiscard]] std::vector<OutputFile> table_files(const ReportTable& table);

/// index.html.
[[nodiscard]] std::string report_html(const Store& store, const ReportSubject& subject);

}  // namespace stillpoint
