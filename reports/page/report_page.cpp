// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/report_page.h"

#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/analysis/comparison.h"
#include "bench/model/metrics.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/openloris_figure.h"
#include "reports/page/charts/openloris_runs.h"
#include "reports/page/html_parts.h"
#include "reports/page/page_data.h"
#include "reports/page/summary.h"
#include "reports/tables/escaping.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/timing_runs.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLicenses[] = {"vendor/LICENSE.uPlot", "vendor/LICENSE.d3-flame-graph",
                                     "vendor/LICENSE.d3"};
constexpr std::string_view kScripts[] = {"vendor/uPlot.iife.min.js",
                                         "vendor/d3-flamegraph.iife.min.js",
                                         "unpack.js",
                                         "charts.js",
                                         "curves.js",
                                         "paths.js",
                                         "inspector.js",
                                         "histograms.js",
                                         "explorer.js",
                                         "flames.js",
                                         "downloads.js",
                                         "page.js"};

/// Runs of the latest other build, the baseline of the change summary; empty without one.
std::vector<bench::StoredRun> previous_runs(const ReportSubject& subject) {
  if (subject.other_runs.empty()) return {};
  const std::string build = subject.other_runs.back().identity.build;
  if (build == subject.runs.back().identity.build) return {};
  std::vector<bench::StoredRun> runs = subject.other_runs;
  std::erase_if(runs, [&](const bench::StoredRun& run) { return run.identity.build != build; });
  return runs;
}

std::string summary_html(const ReportSubject& subject) {
  std::vector<std::string> sentences = outcome_sentences(subject.runs);
  if (const std::string best = best_sentence(subject.runs); !best.empty()) sentences.push_back(best);
  if (const std::vector<bench::StoredRun> previous = previous_runs(subject); !previous.empty()) {
    const bench::Comparison comparison = bench::compare_runs(previous, subject.runs);
    for (const std::string& sentence : change_sentences(previous.front().identity.build, comparison))
      sentences.push_back(sentence);
  }
  std::string text;
  for (const std::string& sentence : sentences) text += "<li>" + escape_html(sentence) + "</li>";
  for (const std::string& gap : subject.gaps) text += "<li class=\"gap\">" + escape_html(gap) + "</li>";
  return "<ul class=\"summary\">" + text + "</ul>";
}

/// The first table is expanded, the others are collapsed.
std::string tables_html(const std::vector<ReportTable>& tables, bool published) {
  const char* none = published ? "No run shares a sequence with a published table."
                               : "All runs are sweep points; see the curves below.";
  constexpr std::size_t kOpen = 1;
  std::string text;
  std::size_t shown = 0;
  for (const ReportTable& table : tables) {
    if (table.name.starts_with("published_") != published) continue;
    text += fmt::format("<details{}><summary>{}</summary>{}</details>\n", shown++ < kOpen ? " open" : "",
                        escape_html(table.title), table_html(table));
  }
  return text.empty() ? fmt::format("<p class=\"none\">{}</p>", none) : text;
}

std::string heat_html(const ReportSubject& subject) {
  std::string text;
  for (const PlanAblation& ablation : subject.ablations.ablations) {
    for (const bench::MetricDescriptor* metric : bench::metrics_of(bench::MetricSource::kTrajectory)) {
      const bool is_error = metric->gate && metric->direction == bench::MetricDirection::kSmallerIsBetter;
      if (is_error) text += heat_map_html(ablation, *metric);
    }
  }
  for (const std::string& sentence : subject.ablations.missing)
    text += "<p class=\"none\">" + escape_html(sentence) + "</p>\n";
  return text.empty() ? "<p class=\"none\">No pair of runs has an error to compare.</p>" : text;
}

std::string timing_notes_html(const ReportSubject& subject) {
  std::string text;
  for (const std::string& sentence : time_source_sentences(subject.runs))
    text += "<p class=\"none\">" + escape_html(sentence) + "</p>\n";
  return text;
}

/// Explains every metric and module of the runs.
std::string runs_glossary(const ReportSubject& subject) {
  std::set<std::string> names;
  for (const bench::StoredRun& run : subject.runs) {
    for (const bench::Metric& metric : run.metrics) names.insert(metric.name);
    for (const bench::ModuleCost& cost : run.costs) names.insert(cost.module);
  }
  return glossary_html(names);
}

std::string plans_html(const bench::Store& store, const ReportSubject& subject) {
  std::string text;
  for (const bench::StoredPlan& plan : subject.plans) {
    text += fmt::format(
        "<h3>{}</h3><pre class=\"command\">stillpoint bench {} --store {}</pre>"
        "<details><summary>Plan file</summary><pre>{}</pre></details>\n",
        escape_html(plan.title.empty() ? plan.name : plan.title), escape_html(plan.name),
        escape_html(store.file().filename().string()), preformatted(plan.text));
  }
  return text;
}

std::string openloris_html(const bench::Store& store, const ReportSubject& subject) {
  const eval::OpenlorisBenchmark benchmark = openloris_of_runs(store, subject.runs);
  if (benchmark.systems.empty()) return "";
  std::string svg = svg_text(openloris_figure(benchmark));
  return "<h3>Correct rate per scene (OpenLORIS figure of the paper)</h3><figure class=\"openloris\" "
         "role=\"img\" aria-label=\"Timelines of correct poses by system and scene\">" +
         svg.substr(svg.find("<svg")) + "</figure>";
}

/// Run keys of each plan; used to build the command that repeats a run.
std::string plans_json(const std::vector<bench::StoredPlan>& plans) {
  Json json = Json::array();
  for (const bench::StoredPlan& plan : plans)
    json.push_back({{"name", clean_line(plan.name)}, {"runs", plan.run_keys}});
  return json.dump();
}

std::string data_html(const PageData& data, const ReportSubject& subject,
                      const std::vector<ReportTable>& tables) {
  Json files = Json::array();
  for (const ReportTable& table : tables) {
    for (const bench::OutputFile& file : table_files(table))
      files.push_back({{"name", file.name}, {"text", file.text}});
  }
  std::string text = data_script("index", data.index) + data_script("plans", plans_json(subject.plans));
  text += data_script("files", files.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace));
  for (std::size_t i = 0; i < data.series.size(); ++i) {
    text += data_script(fmt::format("series-{}", i), data.series[i]);
    text += data_script(fmt::format("images-{}", i), data.images[i]);
  }
  return text;
}

std::string licenses_html() {
  std::string text;
  for (const char* name : kLicenses) text += preformatted(std::string(web_file(name))) + "\n";
  return text;
}

}  // namespace

std::string report_html(const bench::Store& store, const ReportSubject& subject) {
  const PageData data = page_data(store, subject.runs);
  const std::vector<ReportTable> tables = report_tables(subject);
  return filled_template(
      web_file("page.html"),
      {{"title", escape_html(subject.title)},
       {"styles", std::string(web_file("vendor/uPlot.min.css")) + std::string(web_file("page.css"))},
       {"summary", summary_html(subject)},
       {"results", tables_html(tables, false)},
       {"glossary", runs_glossary(subject)},
       {"heat", heat_html(subject)},
       {"published", tables_html(tables, true)},
       {"openloris", openloris_html(store, subject)},
       {"timing_notes", data.module_boxes.empty() ? "" : timing_notes_html(subject)},
       {"boxes", box_plot_svg(data.module_boxes, "Time per frame and module", "ms")},
       {"plans", plans_html(store, subject)},
       {"licenses", licenses_html()},
       {"data", data_html(data, subject, tables)},
       {"scripts", scripts_html(kScripts)}});
}

}  // namespace stillpoint::report
