// SPDX-License-Identifier: BSD-3-Clause
#include "reports/live/live_page.h"

#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kLiveScripts[] = {"unpack.js", "tables.js", "live/live.js"};

/// Metrics of the list of runs.
std::array<const bench::MetricDescriptor*, 3> shown_metrics() {
  return {&bench::headline_metric(), bench::find_metric("coverage"), bench::find_metric("process_wall_s")};
}

std::string live_text(const Json& json) {
  return json.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace);
}

std::string live_label(const bench::RunIdentity& identity) {
  std::string label =
      fmt::format("{} on {}, seed {}", system_label(identity), identity.sequence, identity.seed);
  if (identity.repetition > 1) label += fmt::format(", repetition {}", identity.repetition);
  if (!identity.axis.empty()) label += fmt::format(", {} = {}", identity.axis, identity.axis_value);
  return clean_line(label);
}

Json number_json(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

Json live_plan_json(const bench::PlanProgress& plan) {
  return {{"name", clean_line(plan.name)},
          {"title", clean_line(plan.title)},
          {"runs", plan.runs},
          {"ended", plan.ended},
          {"failed", plan.failed},
          {"executed", plan.is_executed},
          {"per_s", number_json(plan.runs_per_s)},
          {"left_s", number_json(plan.remaining_s)}};
}

Json live_run_json(const bench::StoredRun& run) {
  Json values = Json::array();
  for (const bench::MetricDescriptor* metric : shown_metrics())
    values.push_back(number_json(bench::metric_value(run, metric->id)));
  return {{"key", run.key},
          {"label", live_label(run.identity)},
          {"outcome", bench::outcome_name(run.outcome)},
          {"detail", clean_line(run.detail)},
          {"ended", clean_line(run.ended)},
          {"values", values}};
}

}  // namespace

std::string live_html(const std::string& store, const std::string& events) {
  Json columns = Json::array();
  for (const bench::MetricDescriptor* metric : shown_metrics()) {
    columns.push_back({{"label", std::string(metric->label)},
                       {"unit", std::string(metric->unit)},
                       {"decimals", metric->decimals}});
  }
  const Json index = {{"columns", columns}, {"events", events}};
  return filled_template(
      web_file("live/live.html"),
      {{"styles", std::string(web_file("page.css")) + std::string(web_file("live/live.css"))},
       {"store", escape_html(store)},
       {"data", data_script("index", live_text(index)) + data_script("files", "[]")},
       {"scripts", scripts_html(kLiveScripts)}});
}

std::string progress_json(const bench::StoreProgress& progress, std::size_t rendered) {
  Json json = {{"workers", progress.workers}, {"ended", progress.ended},  {"pages", rendered},
               {"plans", Json::array()},      {"running", Json::array()}, {"runs", Json::array()}};
  for (const bench::PlanProgress& plan : progress.plans) json["plans"].push_back(live_plan_json(plan));
  for (const bench::RunningRun& run : progress.running)
    json["running"].push_back({{"label", live_label(run.identity)}, {"seconds", run.running_s}});
  for (const bench::StoredRun& run : progress.newest) json["runs"].push_back(live_run_json(run));
  return live_text(json);
}

}  // namespace stillpoint::report
