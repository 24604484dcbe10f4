// SPDX-License-Identifier: BSD-3-Clause
/// The subject of a report: the plans and runs of a store that it shows, and their tables. Variant and
/// sequence names that the plans use for different configs or data are disambiguated.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "reports/page/plan_ablations.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// New names by old name and by the hash of the config or data.
struct NameChanges {
  std::map<std::pair<std::string, std::string>, std::string> variants;   ///< by variant, config hash
  std::map<std::pair<std::string, std::string>, std::string> sequences;  ///< by sequence, its id
};

/// A variant whose config, or a sequence whose files, differ from those in an earlier plan gets its plan's
/// name as a suffix: "vo (table2_ablation)". Different seeds or sweep points are not a conflict.
[[nodiscard]] NameChanges disambiguate_names(std::span<const bench::StoredPlan> plans,
                                             std::span<const bench::StoredRun> runs);

/// The runs with their new names.
[[nodiscard]] std::vector<bench::StoredRun> renamed(std::vector<bench::StoredRun> runs,
                                                    const NameChanges& changes);

/// Contents of a report page.
struct ReportSubject {
  std::string title;
  std::vector<bench::StoredPlan> plans;      ///< the plans that the runs belong to
  std::vector<bench::StoredRun> runs;        ///< shown on the page
  std::vector<bench::StoredRun> other_runs;  ///< of other builds, for the comparison
  std::vector<std::string> gaps;             ///< runs with missing or damaged files, one sentence each
  std::vector<std::string> published;        ///< published tables that plans name to compare with
  std::vector<ReportTable> paper;            ///< the paper's tables that plans of the page reproduce
  PlanAblations ablations;                   ///< of `plans`, with the names that each plan uses
  std::size_t unplanned = 0;                 ///< other runs of the shown builds: see `unplanned_sentence`
};

/// All plans of the store or a single one; of each plan the runs of the newest build.
/// @param plan name; empty: all plans, and the runs of systems of which no plan has a run, as imported ones
/// @throws InputError if the store has no such plan or no finished runs
[[nodiscard]] ReportSubject report_subject(const bench::Store& store, const std::string& plan);

/// Names the runs that no plan has, as of a plan that another one of the same name has replaced; empty
/// without one, and on the page of one plan.
[[nodiscard]] std::string unplanned_sentence(const ReportSubject& subject);

/// What `stillpoint bench` is called with to execute a plan again: its name if the program has this plan,
/// else "NAME.toml", a file with its stored text.
[[nodiscard]] std::string plan_argument(const bench::StoredPlan& plan);

/// Paper tables, metric tables, module times, and comparisons with published tables.
[[nodiscard]] std::vector<ReportTable> report_tables(const ReportSubject& subject);

/// A table as NAME.md, NAME.tex, NAME.csv and NAME.json.
[[nodiscard]] std::vector<bench::OutputFile> table_files(const ReportTable& table);

}  // namespace stillpoint::report
