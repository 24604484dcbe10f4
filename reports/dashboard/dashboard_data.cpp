// SPDX-License-Identifier: BSD-3-Clause
#include "reports/dashboard/dashboard_data.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "core/base/content_hash.h"
#include "core/base/module_timings.h"
#include "reports/dashboard/history_text.h"
#include "reports/tables/escaping.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

/// Rounds to 6 significant digits, the precision of the charts, to keep the page small.
double rounded(double value) { return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr); }

/// Assigns indices to names in order of first appearance.
class NameTable {
 public:
  std::size_t index(const std::string& name) {
    const auto [entry, is_new] = indices_.insert({name, names_.size()});
    if (is_new) names_.push_back(clean_line(name));
    return entry->second;
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::map<std::string, std::size_t> indices_;
  std::vector<std::string> names_;
};

std::string family_name(bench::MetricFamily family) {
  return family == bench::MetricFamily::kAccuracy ? "accuracy" : "cost";
}

/// Metrics that the charts show first, by family: the first that a subject has.
Json preferred_json() {
  Json json = {{"accuracy", Json::array()}, {"cost", Json::array()}};
  for (const bench::MetricDescriptor& metric : bench::all_metrics()) {
    if (!metric.gate) continue;
    const bool is_module = metric.id == bench::metric_id::kModuleTime;
    json[family_name(metric.gate->family)].push_back(
        std::string(is_module ? module_name(Module::kStateOptimization) : metric.id));
  }
  return json;
}

Json tooltips_json(const bench::CommitHistory& history) {
  Json json = Json::object();
  for (const bench::HistorySeries& series : history.series)
    json[clean_line(series.metric)] = bench::tooltip_of(series.metric);
  return json;
}

Json commits_json(const std::vector<bench::Commit>& commits) {
  Json list = Json::array();
  for (const bench::Commit& commit : commits) {
    list.push_back({{"name", clean_line(commit.name)},
                    {"label", commit_label(commit.name)},
                    {"time", clean_line(commit.time)},
                    {"page", commit_file(commit)}});
  }
  return list;
}

Json series_json(const bench::HistorySeries& series, std::size_t subject) {
  Json values = Json::array();
  for (const double value : series.values) values.push_back(rounded(value));
  return {{"subject", subject},
          {"metric", clean_line(series.metric)},
          {"unit", clean_line(series.unit)},
          {"family", series.gated == nullptr ? "other" : family_name(series.gated->gate->family)},
          {"commits", series.commits},
          {"values", values},
          {"runs", series.runs}};
}

Json shift_json(const bench::LevelShift& shift) {
  Json json = {{"series", shift.series},
               {"before", shift.before},
               {"after", shift.after},
               {"from", rounded(shift.level_before)},
               {"to", rounded(shift.level_after)},
               {"change", change_label(shift)},
               {"interval", interval_label(shift)},
               {"state", bench::state_name(shift.state)}};
  if (!shift.reason.empty()) json["reason"] = clean_line(shift.reason);
  return json;
}

Json drifts_json(const std::vector<bench::MetricDrift>& found) {
  Json drifts = Json::array();
  for (const bench::MetricDrift& drift : found) {
    drifts.push_back({{"series", drift.series},
                      {"first", drift.first},
                      {"last", drift.last},
                      {"from", rounded(drift.start)},
                      {"to", rounded(drift.end)},
                      {"worse", drift.worse}});
  }
  return drifts;
}

}  // namespace

std::string commit_file(const bench::Commit& commit) {
  std::string name;
  for (const char letter : commit.name.substr(0, 12)) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0) name += letter;
  }
  return "commits/" + name + "-" + hash_text(content_hash(commit.name)) + ".html";
}

std::vector<bench::HistorySubject> subjects_of(const bench::CommitHistory& history) {
  std::vector<bench::HistorySubject> subjects;
  for (const bench::HistorySeries& series : history.series) {
    if (subjects.empty() || subjects.back() != series.subject) subjects.push_back(series.subject);
  }
  return subjects;
}

std::string dashboard_data(const bench::CommitHistory& history, const bench::HistoryChanges& changes) {
  NameTable plans;
  NameTable hosts;
  Json subjects = Json::array();
  for (const bench::HistorySubject& subject : subjects_of(history)) {
    subjects.push_back({{"label", subject_label(subject)},
                        {"data", clean_line(subject.sequence_id)},
                        {"host", hosts.index(subject.host)},
                        {"plans", Json::array()}});
  }
  Json all_series = Json::array();
  std::size_t subject = 0;
  for (std::size_t i = 0; i < history.series.size(); ++i) {
    const bench::HistorySeries& series = history.series[i];
    if (i > 0 && series.subject != history.series[i - 1].subject) ++subject;
    all_series.push_back(series_json(series, subject));
    if (!subjects[subject]["plans"].empty()) continue;
    for (const std::string& plan : series.plans) subjects[subject]["plans"].push_back(plans.index(plan));
  }
  Json shifts = Json::array();
  for (const bench::LevelShift& shift : changes.shifts) shifts.push_back(shift_json(shift));
  const Json json = {{"commits", commits_json(history.commits)},
                     {"plans", plans.all()},
                     {"hosts", hosts.all()},
                     {"subjects", subjects},
                     {"preferred", preferred_json()},
                     {"tooltips", tooltips_json(history)},
                     {"series", all_series},
                     {"shifts", shifts},
                     {"drifts", drifts_json(changes.drifts)}};
  return json.dump();
}

}  // namespace stillpoint::report
