// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/disambiguate_names.h"

#include <set>
#include <tuple>

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

}  // namespace stillpoint::report
