// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/report_page.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/compare/comparison.h"
#include "reports/openloris_figure.h"
#include "reports/page/embedded_web.h"
#include "reports/page/heat_map.h"
#include "reports/page/html_parts.h"
#include "reports/page/openloris_runs.h"
#include "reports/page/page_data.h"
#include "reports/page/summary.h"
#include "reports/svg_drawing.h"
#include "reports/tables/escaping.h"
#include "reports/tables/table_formats.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLibraries[] = {"vendor/uPlot.iife.min.js", "vendor/d3-flamegraph.iife.min.js"};
constexpr const char* kLicences[] = {"vendor/LICENSE.uPlot", "vendor/LICENSE.d3-flame-graph",
                                     "vendor/LICENSE.d3"};
constexpr const char* kScripts[] = {"unpack.js",    "charts.js",     "curves.js",   "paths.js",
                                    "inspector.js", "histograms.js", "explorer.js", "flames.js",
                                    "downloads.js", "page.js"};
constexpr const char* kHeatMetrics[] = {"ate_rmse_m", "rpe_trans_rmse_m_per_s", "rpe_rot_rmse_deg_per_s"};

/// Runs of the latest other build, which a change is told against; empty without one.
std::vector<StoredRun> previous_runs(const ReportSubject& subject) {
  if (subject.other_runs.empty()) return {};
  const std::string build = subject.other_runs.back().identity.build;
  if (build == subject.runs.back().identity.build) return {};
  std::vector<StoredRun> runs = subject.other_runs;
  std::erase_if(runs, [&](const StoredRun& run) { return run.identity.build != build; });
  return runs;
}

std::string summary_html(const ReportSubject& subject) {
  std::vector<std::string> sentences = outcome_sentences(subject.runs);
  if (const std::string best = best_sentence(subject.runs); !best.empty()) sentences.push_back(best);
  if (const std::vector<StoredRun> previous = previous_runs(subject); !previous.empty()) {
    const Comparison comparison = compare_runs(previous, subject.runs);
    if (comparison.pairs > 0) {
      for (const std::string& sentence : change_sentences(previous.front().identity.build, comparison))
        sentences.push_back(sentence);
    }
  }
  std::string text;
  for (const std::string& sentence : sentences) text += "<li>" + escape_html(sentence) + "</li>";
  return "<ul class=\"summary\">" + text + "</ul>";
}

/// The first tables open, the others a click away.
std::string tables_html(const std::vector<ReportTable>& tables, bool quoted) {
  const char* none = quoted ? "No runs here share a sequence with a quoted table."
                            : "Every run here is a point of a sweep: see its curves below.";
  constexpr std::size_t kOpen = 1;
  std::string text;
  std::size_t shown = 0;
  for (const ReportTable& table : tables) {
    if (table.name.starts_with("beside_") != quoted) continue;
    text += fmt::format("<details{}><summary>{}</summary>{}</details>\n", shown++ < kOpen ? " open" : "",
                        escape_html(table.title), table_html(table));
  }
  return text.empty() ? fmt::format("<p class=\"none\">{}</p>", none) : text;
}

std::string heat_html(const ReportSubject& subject) {
  const std::string base = base_variant(subject.runs);
  std::string text;
  for (const char* metric : kHeatMetrics) text += heat_map_html(subject.runs, base, metric);
  return text.empty() ? "<p class=\"none\">One variant alone has nothing to be compared with.</p>" : text;
}

std::string plans_html(const Store& store, const ReportSubject& subject) {
  std::string text;
  for (const StoredPlan& plan : subject.plans) {
    text += fmt::format(
        "<h3>{}</h3><pre class=\"command\">stillpoint bench {} --store {}</pre>"
        "<details><summary>The plan</summary><pre>{}</pre></details>\n",
        escape_html(plan.title.empty() ? plan.name : plan.title), escape_html(plan.name),
        escape_html(store.file().filename().string()), preformatted(plan.text));
  }
  return text;
}

std::string openloris_html(const Store& store, const ReportSubject& subject) {
  const OpenlorisBenchmark benchmark = openloris_of_runs(store, subject.runs);
  if (benchmark.systems.empty()) return "";
  std::string svg = svg_text(openloris_figure(benchmark));
  return "<h3>Correct rates, as the OpenLORIS figure of the paper has them</h3><figure class=\"openloris\" "
         "role=\"img\" aria-label=\"Time lines of correct poses by system and scene\">" +
         svg.substr(svg.find("<svg")) + "</figure>";
}

/// Which plan makes which runs, for the command that repeats one.
std::string plans_json(const std::vector<StoredPlan>& plans) {
  Json json = Json::array();
  for (const StoredPlan& plan : plans)
    json.push_back({{"name", clean_line(plan.name)}, {"runs", plan.run_keys}});
  return json.dump();
}

std::string data_html(const PageData& data, const ReportSubject& subject,
                      const std::vector<ReportTable>& tables) {
  Json files = Json::array();
  for (const ReportTable& table : tables) {
    for (const OutputFile& file : table_files(table))
      files.push_back({{"name", file.name}, {"text", file.text}});
  }
  std::string text = data_script("index", data.index) + data_script("plans", plans_json(subject.plans));
  text += data_script("files", files.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace));
  for (std::size_t i = 0; i < data.series.size(); ++i) {
    text += data_script(fmt::format("series-{}", i), data.series[i]);
    text += data_script(fmt::format("pictures-{}", i), data.pictures[i]);
  }
  return text;
}

std::string scripts_html() {
  std::string text;
  for (const char* name : kLibraries) text += fmt::format("<script>{}</script>\n", web_file(name));
  for (const char* name : kScripts) text += fmt::format("<script>\n{}</script>\n", web_file(name));
  return text;
}

std::string licences_html() {
  std::string text;
  for (const char* name : kLicences) text += preformatted(std::string(web_file(name))) + "\n";
  return text;
}

}  // namespace

std::string report_html(const Store& store, const ReportSubject& subject) {
  const PageData data = page_data(store, subject.runs);
  const std::vector<ReportTable> tables = report_tables(subject);
  return filled_template(
      web_file("page.html"),
      {{"title", escape_html(subject.title)},
       {"styles", std::string(web_file("vendor/uPlot.min.css")) + std::string(web_file("page.css"))},
       {"summary", summary_html(subject)},
       {"results", tables_html(tables, false)},
       {"heat", heat_html(subject)},
       {"published", tables_html(tables, true)},
       {"openloris", openloris_html(store, subject)},
       {"boxes", box_plot_svg(data.module_boxes, "Time of each frame in each module", "ms")},
       {"plans", plans_html(store, subject)},
       {"licences", licences_html()},
       {"data", data_html(data, subject, tables)},
       {"scripts", scripts_html()}});
}

}  // namespace stillpoint
