// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/names_apart.h"

#include <set>
#include <tuple>

namespace stillpoint {
namespace {

/// What a name means at one seed and one point of a sweep, and in which plan it was met first.
struct Meaning {
  std::string hash;
  std::string plan;
};
using Point = std::tuple<std::string, std::int64_t, std::string, double>;

/// Walks over runs plan by plan and finds names that change their meaning.
class Clashes {
 public:
  void meet(const std::string& name, const std::string& hash, const RunIdentity& at,
            const std::string& plan) {
    const auto [known, is_new] =
        meanings_.insert({{name, at.seed, at.axis, at.axis_value}, {.hash = hash, .plan = plan}});
    if (!is_new && known->second.hash != hash && known->second.plan != plan) clashes_.insert({name, plan});
  }
  [[nodiscard]] bool has(const std::string& name, const std::string& plan) const {
    return clashes_.contains({name, plan});
  }

 private:
  std::map<Point, Meaning> meanings_;
  std::set<std::pair<std::string, std::string>> clashes_;
};

std::map<std::string, std::string> plans_by_run(std::span<const StoredPlan> plans) {
  std::map<std::string, std::string> names;
  for (const StoredPlan& plan : plans) {
    for (const std::string& key : plan.run_keys) names.insert({key, plan.name});
  }
  return names;
}

std::string with_plan(const std::string& name, const std::string& plan) { return name + " (" + plan + ")"; }

}  // namespace

NameChanges names_apart(std::span<const StoredPlan> plans, std::span<const StoredRun> runs) {
  std::map<std::string, std::string> plan_of = plans_by_run(plans);
  Clashes variants;
  Clashes sequences;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    const std::string& plan = plan_of[run.key];
    variants.meet(identity.system + " " + identity.variant, identity.config_hash, identity, plan);
    sequences.meet(identity.sequence, identity.sequence_id, identity, plan);
  }
  NameChanges changes;
  for (const StoredRun& run : runs) {
    const RunIdentity& identity = run.identity;
    const std::string& plan = plan_of[run.key];
    if (variants.has(identity.system + " " + identity.variant, plan))
      changes.variants[{identity.variant, identity.config_hash}] = with_plan(identity.variant, plan);
    if (sequences.has(identity.sequence, plan))
      changes.sequences[{identity.sequence, identity.sequence_id}] = with_plan(identity.sequence, plan);
  }
  return changes;
}

std::vector<StoredRun> renamed(std::vector<StoredRun> runs, const NameChanges& changes) {
  for (StoredRun& run : runs) {
    RunIdentity& identity = run.identity;
    const auto variant = changes.variants.find({identity.variant, identity.config_hash});
    const auto sequence = changes.sequences.find({identity.sequence, identity.sequence_id});
    if (variant != changes.variants.end()) identity.variant = variant->second;
    if (sequence != changes.sequences.end()) identity.sequence = sequence->second;
  }
  return runs;
}

}  // namespace stillpoint
