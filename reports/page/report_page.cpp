// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/report_page.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/analysis/comparison.h"
#include "bench/model/metrics.h"
#include "core/base/counted.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/openloris_figure.h"
#include "reports/page/page_data.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/table_formats.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

constexpr const char* kScenes[] = {"home", "cafe", "corridor", "office", "market"};

bool is_scene(const std::string& sequence) {
  return std::any_of(std::begin(kScenes), std::end(kScenes),
                     [&](const char* scene) { return sequence.starts_with(scene); });
}

}  // namespace

eval::OpenlorisBenchmark openloris_of_runs(const bench::Store& store,
                                           std::span<const bench::StoredRun> runs) {
  eval::OpenlorisBenchmark benchmark;
  for (const bench::StoredRun& run : runs) {
    if (!is_scene(run.identity.sequence) || !run.identity.axis.empty()) continue;
    const Trajectory truth = store.truth(run);
    if (truth.poses.empty()) continue;
    const std::string scene = clean_line(run.identity.sequence);
    const int number = static_cast<int>(run.identity.seed);
    benchmark.gt_durations_s[scene][number] = seconds_between(truth.poses.front().t, truth.poses.back().t);
    const Trajectory path = store.trajectory(run);
    const eval::Similarity S_w_v = eval::align_openloris({{number, truth}}, {{number, path}});
    benchmark.systems[clean_line(system_label(run.identity))][scene].runs.emplace(
        number, eval::score_openloris_run(truth, path, S_w_v));
  }
  for (auto& [system, scenes] : benchmark.systems) {
    for (const auto& [scene, durations] : benchmark.gt_durations_s)
      scenes[scene].score = eval::score_openloris_scene(scenes[scene].runs, durations);
  }
  return benchmark;
}

namespace {

constexpr std::size_t kMaxListed = 5;

std::string failure_sentence(const bench::StoredRun& run) {
  std::string text =
      system_label(run.identity) + " on " + run.identity.sequence + ": " + bench::outcome_name(run.outcome);
  return run.detail.empty() ? text + "." : text + ", " + run.detail + ".";
}

/// Labels with the smallest median error on a sequence, among those of comparable coverage.
struct BestLabels {
  std::vector<std::string> labels;  ///< several with equal errors; empty if fewer than two labels have one
  std::vector<std::size_t> counts;  ///< number of runs behind each compared median
};

BestLabels best_on(std::span<const bench::StoredRun> runs, const std::vector<std::string>& labels,
                   const std::string& sequence) {
  std::vector<TableCell> cells;
  cells.reserve(labels.size());
  for (const std::string& label : labels)
    cells.push_back(metric_cell(runs_of(runs, label, sequence), bench::headline_metric().id));
  std::vector<TableCell*> compared;
  compared.reserve(cells.size());
  for (TableCell& cell : cells) compared.push_back(&cell);
  mark_best(compared, false);
  BestLabels best;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].number) continue;
    if (cells[i].is_best) best.labels.push_back(labels[i]);
    best.counts.push_back(cells[i].count);
  }
  return best.counts.size() < 2 ? BestLabels{} : best;
}

std::string change_text(const bench::MetricChange& change) {
  const std::string interval =
      change.is_absolute ? fmt::format("n = {}", change.change.count) : interval_text(change.change);
  return fmt::format("{} of {} by {} ({})", change.metric, change.subject,
                     amount_text(change, change.change.median), interval);
}

/// Metrics that improved or regressed since an earlier build.
/// @param base name of that build
std::vector<std::string> change_sentences(const std::string& base, const bench::Comparison& comparison) {
  std::vector<std::string> sentences = {fmt::format("Compared with build {}: {}; {}.", base,
                                                    change_class_name(comparison.result()),
                                                    count_sentence(comparison))};
  for (const bench::ChangeClass wanted : {bench::ChangeClass::kWorse, bench::ChangeClass::kBetter}) {
    std::size_t listed = 0;
    for (const bench::MetricChange& change : comparison.changes) {
      if (change.result != wanted || listed++ >= kMaxListed) continue;
      sentences.push_back((wanted == bench::ChangeClass::kWorse ? "Worse: " : "Better: ") +
                          change_text(change) + ".");
    }
  }
  return sentences;
}

}  // namespace

std::vector<std::string> outcome_sentences(std::span<const bench::StoredRun> runs) {
  if (runs.empty()) return {"There are no runs."};
  std::vector<const bench::StoredRun*> failed;
  for (const bench::StoredRun& run : runs) {
    if (run.outcome != bench::Outcome::kOk) failed.push_back(&run);
  }
  std::string first = counted(runs.size(), "run") + " of " +
                      counted(distinct(runs, system_label).size(), "variant") + " on " +
                      counted(sequences_of(runs).size(), "sequence") + ": ";
  first += failed.empty() ? "all succeeded." : counted(failed.size(), "run") + " failed.";
  std::vector<std::string> sentences = {first};
  for (std::size_t i = 0; i < std::min(failed.size(), kMaxListed); ++i)
    sentences.push_back(failure_sentence(*failed[i]));
  if (failed.size() > kMaxListed)
    sentences.push_back(
        fmt::format("{} more failed; they are marked in the tables.", failed.size() - kMaxListed));
  return sentences;
}

std::string best_sentence(std::span<const bench::StoredRun> runs) {
  const std::vector<std::string> labels = distinct(runs, system_label);
  std::map<std::string, std::size_t> wins;
  std::vector<std::size_t> counts;
  std::size_t compared = 0;
  for (const std::string& sequence : sequences_of(runs)) {
    const BestLabels best = best_on(runs, labels, sequence);
    if (best.labels.empty()) continue;
    ++compared;
    for (const std::string& label : best.labels) ++wins[label];
    counts.insert(counts.end(), best.counts.begin(), best.counts.end());
  }
  if (compared == 0) return "";
  std::size_t most = 0;
  for (const auto& [label, count] : wins) most = std::max(most, count);
  std::vector<std::string> winners;
  for (const std::string& label : labels) {
    if (wins.contains(label) && wins.at(label) == most) winners.push_back(label);
  }
  const char* verb = winners.size() == 1 ? "has" : "each have";
  const auto [fewest, largest] = std::minmax_element(counts.begin(), counts.end());
  return fmt::format(
      "{} {} the smallest median {} on {} of {} sequences ({}; not a statement of significance).",
      fmt::join(winners, ", "), verb, bench::headline_metric().label, most, compared,
      count_text(*fewest, *largest));
}

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLicenses[] = {"vendor/LICENSE.uPlot", "vendor/LICENSE.d3-flame-graph",
                                     "vendor/LICENSE.d3", "vendor/LICENSE.three"};
constexpr std::string_view kScripts[] = {"vendor/uPlot.iife.min.js",
                                         "vendor/d3-flamegraph.iife.min.js",
                                         "unpack.js",
                                         "url_state.js",
                                         "tables.js",
                                         "legend.js",
                                         "charts.js",
                                         "curves.js",
                                         "paths.js",
                                         "scene.js",
                                         "inspector.js",
                                         "histograms.js",
                                         "matrix.js",
                                         "explorer.js",
                                         "compare.js",
                                         "flames.js",
                                         "downloads.js",
                                         "page.js"};

/// Runs of the latest other build, the baseline of the change summary; empty without one.
std::vector<bench::StoredRun> previous_runs(const ReportSubject& subject) {
  if (subject.other_runs.empty()) return {};
  const std::string build = subject.other_runs.back().identity.build;
  if (std::ranges::any_of(subject.runs,
                          [&](const bench::StoredRun& run) { return run.identity.build == build; }))
    return {};
  std::vector<bench::StoredRun> runs = subject.other_runs;
  std::erase_if(runs, [&](const bench::StoredRun& run) { return run.identity.build != build; });
  return runs;
}

std::optional<double> headline_value(const bench::StoredRun& run) {
  const auto found = std::ranges::find(run.metrics, bench::headline_metric().id, &bench::Metric::name);
  const bool has = run.outcome == bench::Outcome::kOk && found != run.metrics.end();
  return has && std::isfinite(found->value) ? std::optional(found->value) : std::nullopt;
}

/// The run with the largest error outside sweeps; null with fewer than two runs that have one.
const bench::StoredRun* worst_run(std::span<const bench::StoredRun> runs) {
  const bench::StoredRun* worst = nullptr;
  std::size_t count = 0;
  for (const bench::StoredRun& run : runs) {
    const std::optional<double> value = headline_value(run);
    if (!value || !run.identity.axis.empty()) continue;
    ++count;
    if (worst == nullptr || *value > *headline_value(*worst)) worst = &run;
  }
  return count < 2 ? nullptr : worst;
}

std::string worst_html(const bench::StoredRun& run) {
  const bench::MetricDescriptor& metric = bench::headline_metric();
  return fmt::format("The run with the largest {} ({:.4g} {}) is <a href=\"#run={}\">{} on {}, seed {}</a>.",
                     metric.label, *headline_value(run), metric.unit, escape_html(run.key),
                     escape_html(system_label(run.identity)), escape_html(run.identity.sequence),
                     run.identity.seed);
}

std::string summary_html(const ReportSubject& subject) {
  std::vector<std::string> sentences = outcome_sentences(subject.runs);
  if (const std::string best = best_sentence(subject.runs); !best.empty()) sentences.push_back(best);
  if (const std::string unplanned = unplanned_sentence(subject); !unplanned.empty())
    sentences.push_back(unplanned);
  const bench::StoredRun* const worst = worst_run(subject.runs);
  if (const std::vector<bench::StoredRun> previous = previous_runs(subject); !previous.empty()) {
    const bench::Comparison comparison = bench::compare_runs(previous, subject.runs);
    for (const std::string& sentence : change_sentences(previous.front().identity.build, comparison))
      sentences.push_back(sentence);
  }
  std::string text;
  for (const std::string& sentence : sentences) text += "<li>" + escape_html(sentence) + "</li>";
  if (worst != nullptr) text += "<li>" + worst_html(*worst) + "</li>";
  for (const std::string& gap : subject.gaps) text += "<li class=\"gap\">" + escape_html(gap) + "</li>";
  return "<ul class=\"summary\">" + text + "</ul>";
}

/// The first table is expanded, the others are collapsed.
std::string tables_html(const std::vector<ReportTable>& tables, bool published) {
  const char* none =
      published ? "No plan names a published table to compare with, or no run shares a sequence with one."
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
        "<details><summary>Plan file{}</summary><pre>{}</pre></details>\n",
        escape_html(plan.title.empty() ? plan.name : plan.title), escape_html(plan_argument(plan)),
        escape_html(store.file().filename().string()),
        plan_argument(plan) == plan.name ? "" : escape_html(": save it as " + plan.name + ".toml"),
        preformatted(plan.text));
  }
  return text;
}

/// A chart that is scrolled where the window is narrow, so that its texts stay legible; empty without a
/// chart.
std::string wide_html(const std::string& label, const std::string& chart) {
  if (chart.empty()) return "";
  return fmt::format(R"(<div class="wide" tabindex="0" role="group" aria-label="{}">{}</div>)", label, chart);
}

std::string openloris_html(const bench::Store& store, const ReportSubject& subject) {
  const eval::OpenlorisBenchmark benchmark = openloris_of_runs(store, subject.runs);
  if (benchmark.systems.empty()) return "";
  std::string svg = svg_text(openloris_figure(benchmark));
  return "<h3>Correct rate per scene (OpenLORIS figure of the paper)</h3>" +
         wide_html(
             "Figure of correct rates",
             "<figure class=\"openloris\" role=\"img\" aria-label=\"Timelines of correct poses by system "
             "and scene\">" +
                 svg.substr(svg.find("<svg")) + "</figure>");
}

/// Run keys of each plan; used to build the command that repeats a run.
std::string plans_json(const std::vector<bench::StoredPlan>& plans) {
  Json json = Json::array();
  for (const bench::StoredPlan& plan : plans)
    json.push_back({{"name", clean_line(plan.name)},
                    {"argument", clean_line(plan_argument(plan))},
                    {"runs", plan.run_keys}});
  return json.dump();
}

std::string data_html(const PageData& data, const ReportSubject& subject,
                      const std::vector<ReportTable>& tables) {
  Json files = Json::array();
  for (const ReportTable& table : tables) {
    for (const bench::OutputFile& file : table_files(table))
      files.push_back({{"name", file.name}, {"text", file.text}});
  }
  for (const bench::StoredPlan& plan : subject.plans)
    files.push_back({{"name", plan.name + ".toml"}, {"text", plan.text}});
  std::string text = data_script("index", data.index) + data_script("plans", plans_json(subject.plans));
  return text + data_script("files", files.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace));
}

std::string embedded_runs_html(const PageData& data) {
  std::string text;
  for (std::size_t i = 0; i < data.series.size(); ++i) {
    text += data_script(fmt::format("series-{}", i), data.series[i]);
    text += data_script(fmt::format("images-{}", i), data.images[i]);
  }
  return text;
}

/// three.js, compressed; decoded by scene.js when it is first used.
std::string scene_library_html() {
  return fmt::format("<script type=\"application/octet-stream\" id=\"three\">{}</script>\n",
                     web_file("vendor/three.iife.min.js.gz.base64"));
}

std::string licenses_html() {
  std::string text;
  for (const char* name : kLicenses) text += preformatted(std::string(web_file(name))) + "\n";
  return text;
}

std::string page_html(const bench::Store& store, const ReportSubject& subject, const PageData& data,
                      RunData place) {
  const bool embeds = place == RunData::kEmbedded;
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
       {"boxes",
        wide_html("Chart of times", box_plot_svg(data.module_boxes, "Time per frame and module", "ms"))},
       {"plans", plans_html(store, subject)},
       {"licenses", licenses_html()},
       {"connections", embeds ? "" : "; connect-src 'self'"},
       {"data",
        data_html(data, subject, tables) + (embeds ? embedded_runs_html(data) : "") + scene_library_html()},
       {"scripts", scripts_html(kScripts)}});
}

}  // namespace

std::string report_html(const bench::Store& store, const ReportSubject& subject) {
  return page_html(store, subject, page_data(store, subject.runs, RunData::kEmbedded), RunData::kEmbedded);
}

std::vector<bench::OutputFile> served_report(const bench::Store& store, const ReportSubject& subject) {
  const PageData data = page_data(store, subject.runs, RunData::kSideFiles);
  std::vector<bench::OutputFile> files = {
      {"index.html", page_html(store, subject, data, RunData::kSideFiles)}};
  for (std::size_t i = 0; i < subject.runs.size(); ++i) {
    files.push_back({"runs/" + subject.runs[i].key + ".json",
                     fmt::format(R"({{"series":{},"images":{},"truth":{}}})", data.series[i], data.images[i],
                                 data.truths[i])});
  }
  return files;
}

}  // namespace stillpoint::report
