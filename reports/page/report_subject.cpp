// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/report_subject.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <nlohmann/json.hpp>

#include "bench/analysis/run_groups.h"
#include "bench/config/settings.h"
#include "bench/config/toml_source.h"
#include "bench/systems/published_table.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "reports/tables/paper_tables.h"
#include "reports/tables/result_tables.h"
#include "reports/tables/table_formats.h"

namespace stillpoint::report {
namespace {

/// Hash behind a name at one seed and one sweep point, and the plan in which it occurred first.
struct Definition {
  std::string hash;
  std::string plan;
};
using Point = std::tuple<std::string, std::int64_t, std::string, double>;

/// Collects names whose hash differs between plans.
class NameConflicts {
 public:
  void add(const std::string& name, const std::string& hash, const bench::RunIdentity& at,
           const std::string& plan) {
    const auto [known, is_new] =
        definitions_.insert({{name, at.seed, at.axis, at.axis_value}, {.hash = hash, .plan = plan}});
    if (!is_new && known->second.hash != hash && known->second.plan != plan) conflicts_.insert({name, plan});
  }
  [[nodiscard]] bool contains(const std::string& name, const std::string& plan) const {
    return conflicts_.contains({name, plan});
  }

 private:
  std::map<Point, Definition> definitions_;
  std::set<std::pair<std::string, std::string>> conflicts_;
};

std::map<std::string, std::string> plans_by_run(std::span<const bench::StoredPlan> plans) {
  std::map<std::string, std::string> names;
  for (const bench::StoredPlan& plan : plans) {
    for (const std::string& key : plan.run_keys) names.insert({key, plan.name});
  }
  return names;
}

std::string qualified_name(const std::string& name, const std::string& plan) {
  return name + " (" + plan + ")";
}

}  // namespace

NameChanges disambiguate_names(std::span<const bench::StoredPlan> plans,
                               std::span<const bench::StoredRun> runs) {
  std::map<std::string, std::string> plan_of = plans_by_run(plans);
  NameConflicts variants;
  NameConflicts sequences;
  for (const bench::StoredRun& run : runs) {
    const bench::RunIdentity& identity = run.identity;
    const std::string& plan = plan_of[run.key];
    variants.add(identity.system + " " + identity.variant, identity.config_hash, identity, plan);
    sequences.add(identity.sequence, identity.sequence_id, identity, plan);
  }
  NameChanges changes;
  for (const bench::StoredRun& run : runs) {
    const bench::RunIdentity& identity = run.identity;
    const std::string& plan = plan_of[run.key];
    if (variants.contains(identity.system + " " + identity.variant, plan))
      changes.variants[{identity.variant, identity.config_hash}] = qualified_name(identity.variant, plan);
    if (sequences.contains(identity.sequence, plan))
      changes.sequences[{identity.sequence, identity.sequence_id}] = qualified_name(identity.sequence, plan);
  }
  return changes;
}

std::vector<bench::StoredRun> renamed(std::vector<bench::StoredRun> runs, const NameChanges& changes) {
  for (bench::StoredRun& run : runs) {
    bench::RunIdentity& identity = run.identity;
    const auto variant = changes.variants.find({identity.variant, identity.config_hash});
    const auto sequence = changes.sequences.find({identity.sequence, identity.sequence_id});
    if (variant != changes.variants.end()) identity.variant = variant->second;
    if (sequence != changes.sequences.end()) identity.sequence = sequence->second;
  }
  return runs;
}

namespace {

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
    return run.identity.system == bench::kOwnSystem && run.identity.build != newest;
  };
  std::copy_if(subject.runs.begin(), subject.runs.end(), std::back_inserter(subject.other_runs), is_older);
  std::erase_if(subject.runs, is_older);
  return subject;
}

/// The published tables that the plans name (`[table] published`), in the order of the plans.
std::vector<std::string> published_of(const std::vector<bench::StoredPlan>& plans) {
  std::vector<std::string> names;
  const std::vector<std::string> known = bench::published_names();
  const auto add = [&](const std::string& name) {
    const bool is_new = std::ranges::find(names, name) == names.end();
    if (is_new && std::ranges::find(known, name) != known.end()) names.push_back(name);
  };
  for (const bench::StoredPlan& plan : plans) {
    try {
      for (const bench::Setting& setting : bench::parse_settings(plan.text, "plan " + plan.name)) {
        const auto* const values = std::get_if<std::vector<std::string>>(&setting.value);
        if (setting.key == "table.published" && values != nullptr) std::ranges::for_each(*values, add);
      }
    } catch (const InputError&) {
      continue;  // written by hand or by another version; the runs are valid without it
    }
  }
  return names;
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

/// Number of the other runs with a build of the shown ones.
std::size_t unplanned_runs(const ReportSubject& subject) {
  std::set<std::pair<std::string, std::string>> builds;  // with their systems
  for (const bench::StoredRun& run : subject.runs) builds.insert({run.identity.system, run.identity.build});
  return static_cast<std::size_t>(std::ranges::count_if(subject.other_runs, [&](const bench::StoredRun& run) {
    return builds.contains({run.identity.system, run.identity.build});
  }));
}

}  // namespace

ReportSubject report_subject(const bench::Store& store, const std::string& plan) {
  ReportSubject subject;
  subject.plans = chosen_plans(store, plan);
  subject.title = title_of(store, subject.plans);
  if (!plan.empty() && subject.plans.empty())
    static_cast<void>(store.plan_runs(plan));  // throws and lists the known plans
  std::set<std::string> keys, planned_systems;
  for (const bench::StoredPlan& stored : subject.plans) {
    for (bench::StoredRun& run : store.plan_runs(stored.name)) {
      planned_systems.insert(run.identity.system);
      if (keys.insert(run.key).second) subject.runs.push_back(std::move(run));
    }
  }
  for (bench::StoredRun& run : store.runs()) {
    if (keys.contains(run.key)) continue;
    const bool is_imported = plan.empty() && !planned_systems.contains(run.identity.system);
    (is_imported ? subject.runs : subject.other_runs).push_back(std::move(run));
  }
  if (subject.runs.empty())
    throw InputError(store.file().string(),
                     "contains no finished runs; create some with `stillpoint bench PLAN --store FILE`");
  subject = with_newest_build(std::move(subject));
  if (plan.empty()) subject.unplanned = unplanned_runs(subject);
  subject.paper = paper_tables(subject);
  subject.ablations = plan_ablations(subject.plans, subject.runs);
  const NameChanges changes = disambiguate_names(subject.plans, subject.runs);
  subject.runs = renamed(std::move(subject.runs), changes);
  subject.other_runs = renamed(std::move(subject.other_runs), changes);
  subject.published = published_of(subject.plans);
  bench::ReadableRuns readable = bench::without_unreadable_files(store, std::move(subject.runs));
  subject.runs = std::move(readable.runs);
  subject.gaps = std::move(readable.gaps);
  return subject;
}

std::string unplanned_sentence(const ReportSubject& subject) {
  if (subject.unplanned == 0) return "";
  return counted(subject.unplanned, "run") +
         " of these builds left out: no plan of the store has them, as after the plan was changed, or "
         "another "
         "one of its name was executed.";
}

std::string plan_argument(const bench::StoredPlan& plan) {
  for (const bench::EmbeddedFile& file : bench::embedded_files()) {
    if (file.path == "bench/plans/" + plan.name + ".toml" && file.text == plan.text) return plan.name;
  }
  return plan.name + ".toml";
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
