// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/dashboard_data.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/record/content_hash.h"
#include "reports/dashboard/history_text.h"
#include "reports/tables/escaping.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

/// A number at the precision that charts show, so that a page is no heavier than it has to be.
double rounded(double value) { return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr); }

/// Names by the order of their first appearance.
class Names {
 public:
  std::size_t index(const std::string& name) {
    const auto [place, is_new] = indices_.insert({name, names_.size()});
    if (is_new) names_.push_back(clean_line(name));
    return place->second;
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> names_;
};

std::string family_name(const std::optional<MetricRule>& rule) {
  if (!rule) return "other";
  return rule->family == MetricFamily::kAccuracy ? "accuracy" : "cost";
}

Json commits_json(const std::vector<Commit>& commits) {
  Json list = Json::array();
  for (const Commit& commit : commits) {
    list.push_back({{"name", clean_line(commit.name)},
                    {"label", commit_label(commit.name)},
                    {"time", clean_line(commit.time)},
                    {"page", commit_file(commit)}});
  }
  return list;
}

Json series_json(const HistorySeries& series, std::size_t subject) {
  Json values = Json::array();
  for (const double value : series.values) values.push_back(rounded(value));
  return {{"subject", subject},
          {"metric", clean_line(series.metric)},
          {"unit", clean_line(series.unit)},
          {"family", family_name(series.rule)},
          {"commits", series.commits},
          {"values", values},
          {"runs", series.runs}};
}

Json shift_json(const LevelShift& shift) {
  Json json = {{"series", shift.series},
               {"before", shift.before},
               {"after", shift.after},
               {"from", rounded(shift.level_before)},
               {"to", rounded(shift.level_after)},
               {"change", change_label(shift)},
               {"interval", interval_label(shift)},
               {"state", state_name(shift.state)}};
  if (!shift.reason.empty()) json["reason"] = clean_line(shift.reason);
  return json;
}

}  // namespace

std::string commit_file(const Commit& commit) {
  std::string name;
  for (const char letter : commit.name.substr(0, 12)) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0) name += letter;
  }
  return "commits/" + name + "-" + hash_text(content_hash(commit.name)) + ".html";
}

std::vector<HistorySubject> subjects_of(const CommitHistory& history) {
  std::vector<HistorySubject> subjects;
  for (const HistorySeries& series : history.series) {
    if (subjects.empty() || subjects.back() != series.subject) subjects.push_back(series.subject);
  }
  return subjects;
}

std::string dashboard_data(const CommitHistory& history, const HistoryChanges& changes) {
  Names plans;
  Names hosts;
  Json subjects = Json::array();
  for (const HistorySubject& subject : subjects_of(history)) {
    subjects.push_back({{"label", subject_label(subject)},
                        {"data", clean_line(subject.sequence_id)},
                        {"host", hosts.index(subject.host)},
                        {"plans", Json::array()}});
  }
  Json all_series = Json::array();
  std::size_t subject = 0;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const HistorySeries& series = history.series[i];
    if (i > 0 && series.subject != history.series[i - 1].subject) ++subject;
    all_series.push_back(series_json(series, subject));
    if (!subjects[subject]["plans"].empty()) continue;
    for (const std::string& plan : series.plans) subjects[subject]["plans"].push_back(plans.index(plan));
  }
  Json shifts = Json::array();
  for (const LevelShift& shift : changes.shifts) shifts.push_back(shift_json(shift));
  Json creeps = Json::array();
  for (const Creep& creep : changes.creeps) {
    creeps.push_back({{"series", creep.series},
                      {"first", creep.first},
                      {"last", creep.last},
                      {"from", rounded(creep.start)},
                      {"to", rounded(creep.end)},
                      {"worse", creep.worse}});
  }
  const Json json = {{"commits", commits_json(history.commits)},
                     {"plans", plans.all()},
                     {"hosts", hosts.all()},
                     {"subjects", subjects},
                     {"series", all_series},
                     {"shifts", shifts},
                     {"creeps", creeps}};
  return json.dump();
}

}  // namespace stillpoint
