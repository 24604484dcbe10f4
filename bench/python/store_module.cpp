// SPDX-License-Identifier: BSD-3-Clause
/// The extension module `stillpoint._store`: stores of results, their statistics and comparisons.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/analysis/comparison.h"
#include "bench/analysis/metric_change.h"
#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "bench/model/metrics.h"
#include "bench/python/arrays.h"
#include "bench/python/records.h"
#include "bench/store/store.h"

namespace stillpoint::python {
namespace {

using bench::Store;
using bench::StoredRun;
using Runs = std::vector<StoredRun>;
using ReleaseGil = py::call_guard<py::gil_scoped_release>;

template <auto Member>
auto identity() {
  return [](const StoredRun& run) { return run.identity.*Member; };
}

std::map<std::string, double> metric_values(const StoredRun& run) {
  std::map<std::string, double> values;
  for (const bench::Metric& metric : run.metrics) values.emplace(metric.name, metric.value);
  return values;
}

void bind_run(py::module_& m) {
  using bench::RunIdentity;
  Record<bench::ModuleCost>(m, "ModuleCost", "Time spent in one module, ms.")
      .field("module", &bench::ModuleCost::module, "Name.")
      .field("per", &bench::ModuleCost::per, "Unit of the statistics: call, or frame.")
      .field("calls", &bench::ModuleCost::calls, "Number of calls.")
      .field("mean_ms", &bench::ModuleCost::mean_ms, "ms.")
      .field("median_ms", &bench::ModuleCost::median_ms, "ms.")
      .field("p95_ms", &bench::ModuleCost::p95_ms, "ms.")
      .field("max_ms", &bench::ModuleCost::max_ms, "ms.");
  Record<StoredRun>(m, "StoredRun", "A completed run.")
      .field("id", &StoredRun::id, "Number in the store.")
      .field("key", &StoredRun::key, "Hash of its identity.")
      .field("system", identity<&RunIdentity::system>(), "stillpoint, or the name of an external system.")
      .field("variant", identity<&RunIdentity::variant>(), "Name of the config.")
      .field("sequence", identity<&RunIdentity::sequence>(), "Name in tables.")
      .field("build", identity<&RunIdentity::build>(), "Git commit.")
      .field("mode", identity<&RunIdentity::mode>(), "How it was executed.")
      .field("kind", identity<&RunIdentity::kind>(), "accuracy or timing.")
      .field("seed", identity<&RunIdentity::seed>(), "Of the sequence and the odometry.")
      .field("repetition", identity<&RunIdentity::repetition>(), "From 1.")
      .field("axis", identity<&RunIdentity::axis>(), "Config key that a sweep varies; empty without one.")
      .field("axis_value", identity<&RunIdentity::axis_value>(), "Its value.")
      .field(
          "outcome", [](const StoredRun& run) { return bench::outcome_name(run.outcome); },
          "ok, lost, crashed, ...")
      .field("detail", &StoredRun::detail, "Reason when not ok; else why the errors are doubtful.")
      .field("started", &StoredRun::started, "UTC, ISO 8601.")
      .field("ended", &StoredRun::ended, "UTC, ISO 8601.")
      .field("machine", &StoredRun::machine, "CPU model and count.")
      .field("metrics", &metric_values, "Value by name; metrics without data are absent.")
      .field("costs", &StoredRun::costs, "List of ModuleCost.");
}

/// Frame counters as columns.
py::dict counter_columns(const Store& store, const StoredRun& run) {
  const std::vector<bench::FrameCounters> rows = store.frame_counters(run);
  py::dict columns;
  const auto add = [&](const char* name, auto member) {
    using Value = std::remove_cvref_t<decltype(rows.front().*member)>;
    if constexpr (std::is_same_v<Value, std::string>) {
      py::list values;
      for (const bench::FrameCounters& row : rows) values.append(row.*member);
      columns[name] = values;
    } else {
      py::array_t<Value> values(static_cast<py::ssize_t>(rows.size()));
      for (std::size_t i = 0; i < rows.size(); ++i) values.mutable_data()[i] = rows[i].*member;
      columns[name] = values;
    }
  };
  add("frame", &bench::FrameCounters::frame);
  add("t_ns", &bench::FrameCounters::t_ns);
  add("status", &bench::FrameCounters::status);
  add("tracked_features", &bench::FrameCounters::tracked_features);
  add("window_landmarks", &bench::FrameCounters::window_landmarks);
  add("depth_landmarks", &bench::FrameCounters::depth_landmarks);
  add("dynamic_features", &bench::FrameCounters::dynamic_features);
  add("solver_iterations", &bench::FrameCounters::solver_iterations);
  add("keyframe", &bench::FrameCounters::keyframe);
  add("reset", &bench::FrameCounters::reset);
  return columns;
}

/// Times per frame as columns.
py::dict timing_columns(const Store& store, const StoredRun& run) {
  py::list modules;
  std::vector<std::int64_t> frames;
  std::vector<std::int64_t> nanoseconds;
  std::vector<std::int64_t> calls;
  for (const bench::TimingSample& sample : store.timing_samples(run)) {
    modules.append(sample.module);
    frames.push_back(sample.frame);
    nanoseconds.push_back(sample.ns);
    calls.push_back(sample.calls);
  }
  py::dict columns;
  columns["frame"] = array_of(std::move(frames));
  columns["module"] = modules;
  columns["ns"] = array_of(std::move(nanoseconds));
  columns["calls"] = array_of(std::move(calls));
  return columns;
}

void bind_store(py::module_& m) {
  // Reading runs is a transaction of the connection, which threads share: one at a time, with the
  // interpreter.
  py::class_<Store>(m, "Store", "A store of results, open for reading; it may be written at the same time.")
      .def(py::init<const std::filesystem::path&>(), py::arg("path"),
           "Raises InputError if there is none, it is damaged, or was written by a newer version.")
      .def(
          "runs",
          [](const Store& store, const std::string& system, const std::string& variant,
             const std::string& sequence, const std::string& build, const std::string& kind) {
            return store.runs({system, variant, sequence, build, kind});
          },
          py::arg("system") = "", py::arg("variant") = "", py::arg("sequence") = "", py::arg("build") = "",
          py::arg("kind") = "", "Completed runs in the order of their start; empty arguments match all.")
      .def("plan_runs", &Store::plan_runs, py::arg("plan"), "The completed runs of a plan, in its order.")
      .def(
          "plans",
          [](const Store& store) {
            std::map<std::string, std::string> texts;
            for (const bench::StoredPlan& plan : store.plans()) texts.emplace(plan.name, plan.text);
            return texts;
          },
          "TOML text of each plan by its name.")
      .def("trajectory", &Store::trajectory, py::arg("run"),
           "Estimated poses T_w_c; empty if the run has none.", ReleaseGil())
      .def("truth", &Store::truth, py::arg("run"), "Ground-truth poses T_w_c; empty if there are none.",
           ReleaseGil())
      .def("manifest_json", &Store::manifest, py::arg("run"), "JSON; empty if the run has none.",
           ReleaseGil())
      .def(
          "attachment",
          [](const Store& store, const StoredRun& run, const std::string& kind) {
            return py::bytes(store.attachment(run, kind));
          },
          py::arg("run"), py::arg("kind"),
          "Content of a file of a run, e.g. result or log; empty if it has none.")
      .def(
          "attachments",
          [](const Store&, const StoredRun& run) {
            std::vector<std::string> kinds;
            for (const auto& [kind, file] : run.blobs) kinds.push_back(kind);
            return kinds;
          },
          py::arg("run"), "Kinds of files that the run has.")
      .def("frame_counters", &counter_columns, py::arg("run"), "Counters per frame by name, [n] each.")
      .def("timing_samples", &timing_columns, py::arg("run"),
           "Time per frame and module by name, [n] each, ns.");
}

void bind_metric_list(py::module_& m) {
  m.def(
      "metric_list",
      [] {
        py::list metrics;
        for (const bench::MetricDescriptor& metric : bench::all_metrics()) {
          py::dict row;
          row["name"] = metric.id;
          row["label"] = metric.label;
          row["unit"] = metric.unit;
          row["description"] = metric.description;
          row["direction"] = metric.direction == bench::MetricDirection::kNone ? "none"
                             : metric.direction == bench::MetricDirection::kSmallerIsBetter
                                 ? "smaller is better"
                                 : "larger is better";
          metrics.append(row);
        }
        return metrics;
      },
      "Name, label, unit, description and direction of every metric.");
}

void bind_groups(py::module_& m) {
  using bench::RunGroup;
  Record<RunGroup>(m, "RunGroup", "Runs of one build on one machine in one mode, which may be pooled.")
      .field("build", &RunGroup::build, "Git commit.")
      .field("machine", &RunGroup::machine, "CPU model and count.")
      .field("mode", &RunGroup::mode, "Mode, kind and processors.")
      .field("runs", &RunGroup::runs, "List of StoredRun.");
  m.def(
      "select_runs",
      [](const Store& store, Runs runs, const std::string& build) {
        bench::RunSelection selection = bench::select_runs(store, std::move(runs), build);
        return std::pair(std::move(selection.groups), std::move(selection.left_out));
      },
      py::arg("store"), py::arg("runs"), py::arg("build") = "",
      "Groups of runs that may be pooled, and sentences about those that are in none. `build`: a build, all, "
      "or empty for "
      "the newest.",
      ReleaseGil());
}

void bind_run_statistics(py::module_& m) {
  using bench::RunSpread;
  Record<RunSpread>(m, "RunSpread", "The runs of one variant on one sequence.")
      .field("sequence", &RunSpread::sequence, "Name.")
      .field("variant", &RunSpread::variant, "Name.")
      .field("axis", &RunSpread::axis, "Of a sweep; empty without one.")
      .field("axis_value", &RunSpread::axis_value, "Its value.")
      .field("runs", &RunSpread::runs, "Number.")
      .field("failed", &RunSpread::failed, "Runs that did not succeed.")
      .field("without_value", &RunSpread::without_value, "Succeeded runs without a finite value.")
      .field("copies", &RunSpread::copies,
             "Runs with the result of another one to the bit, which do not count.")
      .field("spread", &RunSpread::spread, "eval.Spread; None without a value.")
      .field("doubt", &RunSpread::doubt, "Why the result is doubtful; empty without a reason.");
  m.def(
      "run_spreads",
      [](const Runs& runs, const std::string& metric) { return bench::run_spreads(runs, metric); },
      py::arg("runs"), py::arg("metric"),
      "Spread of a metric per variant and sequence; the runs may be pooled, as those of a RunGroup.",
      ReleaseGil());
  using bench::AblationRow;
  Record<AblationRow>(m, "AblationRow", "Difference between a variant and the base.")
      .field("variant", &AblationRow::variant, "Name.")
      .field("sequence", &AblationRow::sequence, "Empty: all sequences.")
      .field("newly_failed", &AblationRow::newly_failed, "Pairs in which only the variant did not succeed.")
      .field("newly_without_value", &AblationRow::newly_without_value,
             "Pairs in which only the base has a value.")
      .field("copies", &AblationRow::copies, "Pairs that do not count.")
      .field("sequences", &AblationRow::sequences,
             "Number of sequences with a pair; the pairs of a single one are the replicates.")
      .field("difference", &AblationRow::difference, "eval.PairedDifference; None without pairs.")
      .field("change", &AblationRow::change,
             "eval.RelativeChange; None without pairs, or if a value of 0 changes.")
      .field("doubt", &AblationRow::doubt, "Why the errors are not comparable; empty without a reason.");
  m.def(
      "ablation",
      [](const Runs& runs, const std::string& base, const std::string& metric) {
        return bench::ablation(runs, base, metric);
      },
      py::arg("runs"), py::arg("base"), py::arg("metric"),
      "Paired differences of each variant from `base`, over all sequences and for each.", ReleaseGil());
  using bench::RepetitionRow;
  Record<RepetitionRow>(m, "RepetitionRow", "Repeatability of one run.")
      .field("label", &RepetitionRow::label, "Sequence, variant, seed.")
      .field("repetitions", &RepetitionRow::repetitions, "Number.")
      .field("failed", &RepetitionRow::failed, "Repetitions that did not succeed.")
      .field("distinct_trajectories", &RepetitionRow::distinct_trajectories, "Of those that succeeded.")
      .field("first_difference", &RepetitionRow::first_difference, "Frame and stage; empty if none.")
      .field("is_repeatable", &RepetitionRow::is_repeatable, "Whether all succeeded with one trajectory.");
  m.def(
      "repetition_report",
      [](const Store& store, const Runs& runs) { return bench::repetition_report(store, runs); },
      py::arg("store"), py::arg("runs"), "One row for each run with at least two repetitions.", ReleaseGil());
}

void bind_changes(py::module_& m) {
  using bench::MetricChange;
  Record<MetricChange>(m, "MetricChange", "Change of one metric on one subject.")
      .field("metric", &MetricChange::metric, "Name of a metric or timed module.")
      .field("subject", &MetricChange::subject, "Variant, and sequence if tested per sequence.")
      .field("unit", &MetricChange::unit, "Of the metric.")
      .field("base_median", &MetricChange::base_median, "In the unit.")
      .field("head_median", &MetricChange::head_median, "In the unit.")
      .field("change", &MetricChange::change, "eval.RelativeChange.")
      .field("is_absolute", &MetricChange::is_absolute, "Whether `change` is a difference in the unit.")
      .field("level", &MetricChange::level, "Largest p-value that is significant.")
      .field("decides", &MetricChange::decides, "Whether it is more than reported.")
      .field(
          "result", [](const MetricChange& c) { return bench::change_class_name(c.result); },
          "same, better, inconclusive, missing in HEAD, worse or error.");
  using bench::Comparison;
  Record<Comparison>(m, "StoreComparison", "Regression test of head against base.")
      .field("pairs", &Comparison::pairs, "Runs in both.")
      .field("compared", &Comparison::compared, "Pairs that succeeded on both sides.")
      .field("bit_equal", &Comparison::bit_equal, "Compared pairs with bit-equal trajectories.")
      .field("newly_failed", &Comparison::newly_failed, "Succeeded at base, but not at head.")
      .field("newly_succeeded", &Comparison::newly_succeeded, "The reverse.")
      .field("only_in_base", &Comparison::only_in_base, "Runs without counterpart.")
      .field("only_in_head", &Comparison::only_in_head, "Runs without counterpart.")
      .field("changes", &Comparison::changes, "List of MetricChange.")
      .field("notes", &Comparison::notes, "Remarks.")
      .field("summary", &bench::count_sentence, "The counts as a sentence.")
      .field(
          "result", [](const Comparison& c) { return bench::change_class_name(c.result()); },
          "The worst class over all metrics that decide.");
  m.def(
      "compare_runs", [](const Runs& base, const Runs& head) { return bench::compare_runs(base, head); },
      py::arg("base"), py::arg("head"),
      "Compares runs that differ in their build only, as `stillpoint compare`.", ReleaseGil());
  m.def(
      "newest_build", [](const Runs& runs) { return bench::newest_build(runs); }, py::arg("runs"),
      "The build with the latest commit time; empty without runs.");
}

}  // namespace
}  // namespace stillpoint::python

PYBIND11_MODULE(_store, module) {
  using namespace stillpoint::python;  // of the functions above
  module.doc() = "Stores of results; the public names are those of stillpoint.store.";
  pybind11::module_::import("stillpoint._eval");  // its types and its exception
  bind_run(module);
  bind_store(module);
  bind_metric_list(module);
  bind_groups(module);
  bind_run_statistics(module);
  bind_changes(module);
}
