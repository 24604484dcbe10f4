// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include <nlohmann/json.hpp>

#include "bench/analysis/run_groups.h"
#include "bench/store/store.h"
#include "bench/systems/published_table.h"
#include "core/base/error.h"
#include "reports/page/disambiguate_names.h"
#include "reports/page/report_page.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/paper_tables.h"
#include "reports/tables/result_tables.h"

namespace stillpoint::report {
namespace {

constexpr const char* kOwnSystem = "stillpoint";

std::vector<bench::StoredPlan> chosen_plans(const bench::Store& store, const std::string& plan) {
  std::vector<bench::StoredPlan> plans = store.plans();
  if (!plan.empty())
    std::erase_if(plans, [&](const bench::StoredPlan& stored) { return stored.name != plan; });
  return plans;
}

std::string title_of(const bench::Store& store, const std::vector<bench::StoredPlan>& plans) {
  std::string title;
  for (const bench::StoredPlan& plan : plans)
    title += (title.empty() ? "" : "; ") + (plan.title.empty() ? plan.name : plan.title);
  return title.empty() ? "Runs of " + store.file().filename().string() : title;
}

/// The subject with runs of older Stillpoint builds moved to `other_runs`; runs of other systems stay.
/// Numbers of different builds are never combined.
ReportSubject with_newest_build(ReportSubject subject) {
  const std::string newest = bench::newest_build(subject.runs);
  const auto is_older = [&](const bench::StoredRun& run) {
    return run.identity.system == kOwnSystem && run.identity.build != newest;
  };
  std::copy_if(subject.runs.begin(), subject.runs.end(), std::back_inserter(subject.other_runs), is_older);
  std::erase_if(subject.runs, is_older);
  return subject;
}

std::vector<ReportTable> paper_tables(const ReportSubject& subject) {
  std::vector<ReportTable> tables;
  for (const bench::StoredPlan& plan : subject.plans) {
    const std::optional<PaperTable> table = paper_table_of(plan.name);
    if (!table) continue;
    std::vector<bench::StoredRun> runs = subject.runs;
    std::erase_if(runs, [&](const bench::StoredRun& run) {
      return std::find(plan.run_keys.begin(), plan.run_keys.end(), run.key) == plan.run_keys.end();
    });
    ReportTable paper = paper_table(*table, runs);
    paper.name = plan.name;
    tables.push_back(std::move(paper));
  }
  return tables;
}

}  // namespace

ReportSubject report_subject(const bench::Store& store, const std::string& plan) {
  ReportSubject subject;
  subject.plans = chosen_plans(store, plan);
  subject.title = title_of(store, subject.plans);
  if (!plan.empty() && subject.plans.empty())
    static_cast<void>(store.plan_runs(plan));  // throws and lists the known plans
  std::set<std::string> keys;
  for (const bench::StoredPlan& stored : subject.plans) {
    for (bench::StoredRun& run : store.plan_runs(stored.name)) {
      if (keys.insert(run.key).second) subject.runs.push_back(std::move(run));
    }
  }
  for (bench::StoredRun& run : store.runs()) {
    if (keys.contains(run.key)) continue;
    (subject.plans.empty() ? subject.runs : subject.other_runs).push_back(std::move(run));
  }
  if (subject.runs.empty())
    throw InputError(store.file().string(),
                     "contains no finished runs; create some with `stillpoint bench PLAN --store FILE`");
  subject = with_newest_build(std::move(subject));
  subject.paper = paper_tables(subject);
  subject.ablations = plan_ablations(subject.plans, subject.runs);
  const NameChanges changes = disambiguate_names(subject.plans, subject.runs);
  subject.runs = renamed(std::move(subject.runs), changes);
  subject.other_runs = renamed(std::move(subject.other_runs), changes);
  subject.published = bench::published_names();
  bench::ReadableRuns readable = bench::without_unreadable_files(store, std::move(subject.runs));
  subject.runs = std::move(readable.runs);
  subject.gaps = std::move(readable.gaps);
  return subject;
}

std::vector<ReportTable> report_tables(const ReportSubject& subject) {
  std::vector<ReportTable> tables = subject.paper;
  for (ReportTable& table : metric_tables(subject.runs)) tables.push_back(std::move(table));
  tables.push_back(cost_table(subject.runs));
  for (const std::string& name : subject.published)
    tables.push_back(published_comparison_table(subject.runs, bench::load_published(name)));
  std::erase_if(tables, [](const ReportTable& table) { return table.rows.empty(); });
  return tables;
}

std::vector<bench::OutputFile> table_files(const ReportTable& table) {
  return {{table.name + ".md", table_markdown(table, TableDetail::kSpread)},
          {table.name + ".tex", table_latex(table)},
          {table.name + ".csv", table_csv(table)},
          {table.name + ".json", table_json(table).dump(2) + "\n"}};
}

}  // namespace stillpoint::report
