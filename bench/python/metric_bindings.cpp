// SPDX-License-Identifier: BSD-3-Clause
/// Errors of trajectories in Python: ATE, RPE, segments, coverage, protocols, and the comparison of runs.
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/python/eval_bindings.h"
#include "bench/python/records.h"
#include "eval/compare/common_support.h"
#include "eval/compare/conventions.h"
#include "eval/compare/time_offset.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/protocols/protocol.h"
#include "eval/score.h"

namespace stillpoint::python {
namespace {

using eval::Evaluation;
using eval::PoseMatches;
using eval::ProtocolOptions;
using ReleaseGil = py::call_guard<py::gil_scoped_release>;

void bind_summary(py::module_& m) {
  using eval::Statistics;
  Record<Statistics> record(m, "Statistics",
                            "Summary of a list of errors, in their unit; `sse` in its square.");
  record.field("count", &Statistics::count, "Number of values.")
      .field("rmse", &Statistics::rmse, "Root mean square.")
      .field("mean", &Statistics::mean, "Mean.")
      .field("median", &Statistics::median, "Mean of the two middle values if the count is even.")
      .field("std", &Statistics::std, "Of the population.")
      .field("min", &Statistics::min, "Smallest value.")
      .field("max", &Statistics::max, "Largest value.")
      .field("sse", &Statistics::sse, "Sum of squares.");
  for (std::size_t i = 0; i < eval::kPercentiles.size(); ++i) {
    const std::string name = "percentile_" + std::to_string(eval::kPercentiles[i]);
    record.field(
        name.c_str(), [i](const Statistics& values) { return values.percentiles[i]; },
        "Percentile with linear interpolation between the closest ranks.");
  }
  m.def(
      "statistics", [](const Doubles& values) { return eval::statistics(span_of(values)); },
      py::arg("values"), "Statistics of a list of numbers; None for an empty list.");
  m.def(
      "percentile",
      [](const Doubles& values, double fraction) {
        if (!(fraction >= 0.0 && fraction <= 1.0)) throw InputError("fraction", "must be in [0, 1]");
        return eval::percentile(span_of(values), fraction);
      },
      py::arg("values"), py::arg("fraction"),
      "Percentile with linear interpolation between the closest ranks; `fraction` in [0, 1]; None for an "
      "empty list.");
}

void bind_ate(py::module_& m) {
  using eval::AteErrors;
  using eval::AteResult;
  Record<AteResult>(m, "AteResult", "Absolute trajectory error.")
      .field("translation_m", &AteResult::translation_m, "Statistics, m.")
      .field("rotation_deg", &AteResult::rotation_deg, "Statistics, deg.")
      .field("alignment", &AteResult::alignment, "Of the estimate to the ground truth.")
      .field("pairs", &AteResult::pairs, "Matched poses.");
  m.def(
      "ate",
      [](const Trajectory& gt, const Trajectory& est, double max_difference_s, double offset_s) {
        return eval::ate(gt, est, {.max_difference_s = max_difference_s, .offset_s = offset_s});
      },
      py::arg("gt"), py::arg("est"), py::arg("max_difference_s") = 0.02, py::arg("offset_s") = 0.0,
      "ATE as evaluate_ate.py of the TUM benchmark computes it; None for fewer than two pairs.",
      ReleaseGil());
  m.def(
      "ate_errors",
      [](const PoseMatches& matches, const eval::Similarity& S_w_v) {
        AteErrors errors;
        {
          const py::gil_scoped_release release;
          errors = eval::ate_errors(matches, S_w_v);
        }
        return py::make_tuple(array_of(std::move(errors.translation_m)),
                              array_of(std::move(errors.rotation_deg)));
      },
      py::arg("matches"), py::arg("S_w_v") = eval::Similarity{},
      "Translation errors [n], m, and rotation errors [n] in [0, 180] deg of each match after the "
      "alignment.");
}

void bind_coverage(py::module_& m) {
  m.def(
      "coverage",
      [](const Trajectory& est, const py::object& expected_ns, double tolerance_s) {
        return eval::coverage(est, stamps_of(expected_ns, "expected_ns"), tolerance_s);
      },
      py::arg("est"), py::arg("expected_ns"), py::arg("tolerance_s") = 1e-3,
      "Fraction of the frames with a pose; `expected_ns`: stamps of the frames, int64 [n]; None without "
      "frames.");
  m.def(
      "correct_rate",
      [](const Trajectory& gt, const Trajectory& est, const eval::CorrectRateOptions& options,
         double offset_s) { return eval::correct_rate(gt, est, options, offset_s); },
      py::arg("gt"), py::arg("est"), py::arg("options") = eval::CorrectRateOptions{},
      py::arg("offset_s") = 0.0,
      "Fraction of the ground truth's duration with a pose within the thresholds (OpenLORIS); None if it is "
      "not "
      "determined.",
      ReleaseGil());
  m.def(
      "lost_spans",
      [](const Trajectory& est, std::int64_t begin_ns, std::int64_t end_ns, double max_hold_s) {
        std::vector<std::int64_t> spans;
        for (const eval::TimeSpan& span :
             eval::lost_spans(est, {Timestamp{begin_ns}, Timestamp{end_ns}}, max_hold_s))
          spans.insert(spans.end(), {span.begin.ns, span.end.ns});
        return table_of(std::move(spans), 2);
      },
      py::arg("est"), py::arg("begin_ns"), py::arg("end_ns"), py::arg("max_hold_s") = 1.0,
      "Intervals without a valid pose, int64 [n, 2], ns; a pose is valid until the next one, for at most "
      "`max_hold_s`.");
}

eval::RpeOptions rpe_options(double delta, const std::string& unit, double offset_s) {
  if (!(delta > 0.0) || !std::isfinite(delta)) throw InputError("delta", "must be a number > 0");
  return {.delta = delta, .unit = value_of<eval::RpeUnit>("unit", unit), .offset_s = offset_s};
}

std::vector<eval::PosePair> pose_pairs(const Integers& pairs, std::size_t matches) {
  require_shape(pairs, "pairs", {-1, 2});
  std::vector<eval::PosePair> result;
  for (py::ssize_t i = 0; i < pairs.shape(0); ++i) {
    for (const std::int64_t index : {pairs.at(i, 0), pairs.at(i, 1)}) {
      if (index < 0 || static_cast<std::size_t>(index) >= matches)
        throw InputError("pairs", "has an index that no match has: " + std::to_string(index));
    }
    result.push_back(
        {static_cast<eval::PoseIndex>(pairs.at(i, 0)), static_cast<eval::PoseIndex>(pairs.at(i, 1))});
  }
  return result;
}

py::array pose_pair_table(const std::vector<eval::PosePair>& pairs) {
  std::vector<std::int64_t> values;
  for (const eval::PosePair& pair : pairs) values.insert(values.end(), {pair.from, pair.to});
  return table_of(std::move(values), 2);
}

void bind_rpe(py::module_& m) {
  using eval::RpeResult;
  Record<RpeResult>(m, "RpeResult", "Relative pose error over `delta`.")
      .field("translation_m", &RpeResult::translation_m, "Statistics, m.")
      .field("rotation_deg", &RpeResult::rotation_deg, "Statistics, deg.")
      .field("self_pairs", &RpeResult::self_pairs, "Pairs of a pose with itself, included with zero error.")
      .field("dropped_gt", &RpeResult::dropped_gt, "Pairs without ground truth.");
  m.def(
      "rpe",
      [](const Trajectory& gt, const Trajectory& est, double delta, const std::string& unit,
         double offset_s) { return eval::rpe(gt, est, rpe_options(delta, unit, offset_s)); },
      py::arg("gt"), py::arg("est"), py::arg("delta") = 1.0, py::arg("unit") = "s", py::arg("offset_s") = 0.0,
      "RPE as evaluate_rpe.py of the TUM benchmark computes it over `delta` s, f (frames), m or deg; None "
      "without "
      "a pair.",
      ReleaseGil());
  using eval::StrictRpeResult;
  Record<StrictRpeResult>(m, "StrictRpeResult", "RPE over pairs with a tolerance on their time difference.")
      .field(
          "translation_m",
          [](const StrictRpeResult& result) {
            return result.errors ? std::optional(result.errors->translation_m) : std::nullopt;
          },
          "Statistics, m; None without pairs.")
      .field(
          "rotation_deg",
          [](const StrictRpeResult& result) {
            return result.errors ? std::optional(result.errors->rotation_deg) : std::nullopt;
          },
          "Statistics, deg; None without pairs.")
      .field("dropped", &StrictRpeResult::dropped, "Starts without an end within the tolerance.")
      .field("tolerance_s", &StrictRpeResult::tolerance_s, "On the time difference of a pair, s.");
  m.def(
      "strict_rpe",
      [](const PoseMatches& matches, double delta_s) { return eval::strict_rpe(matches, delta_s); },
      py::arg("matches"), py::arg("delta_s") = 1.0, "Strict RPE over `delta_s`.", ReleaseGil());
}

void bind_pairs(py::module_& m) {
  m.def(
      "pairs_over_frames",
      [](std::size_t poses, std::size_t step, bool every_start) {
        if (step < 1) throw InputError("step", "must be 1 or more");
        return pose_pair_table(eval::pairs_over_frames(poses, step, every_start));
      },
      py::arg("poses"), py::arg("step"), py::arg("every_start") = true, "Pairs (i, i + step), int64 [n, 2].");
  m.def(
      "pairs_over_seconds",
      [](const PoseMatches& matches, double delta_s, double tolerance_s) {
        return pose_pair_table(eval::pairs_over_seconds(matches, delta_s, tolerance_s).pairs);
      },
      py::arg("matches"), py::arg("delta_s"), py::arg("tolerance_s"),
      "Each match with the one whose time is closest to `delta_s` later, int64 [n, 2].");
  m.def(
      "path_lengths",
      [](const PoseMatches& matches) {
        return array_of(eval::path_lengths(matches, eval::PathOf::kGroundTruth));
      },
      py::arg("matches"), "Path length of the ground truth from the first match to each, [n], m.");
  m.def(
      "relative_errors",
      [](const PoseMatches& matches, const Integers& pairs) {
        eval::RelativeErrors errors = eval::relative_errors(matches, pose_pairs(pairs, matches.size()));
        return py::make_tuple(array_of(std::move(errors.translation_m)),
                              array_of(std::move(errors.rotation_deg)), array_of(std::move(errors.yaw_deg)));
      },
      py::arg("matches"), py::arg("pairs"),
      "Translation [n], m, rotation [n], deg, and yaw errors [n] in [0, 180] deg of pairs [n, 2] of "
      "matches.");
}

void bind_segments(py::module_& m) {
  using eval::SegmentErrors;
  Record<SegmentErrors>(m, "SegmentErrors", "Errors of all segments of one length.")
      .field("length_m", &SegmentErrors::length_m, "m.")
      .field("translation_m", &SegmentErrors::translation_m, "Statistics, m.")
      .field("rotation_deg", &SegmentErrors::rotation_deg, "Statistics, deg.")
      .field("yaw_deg", &SegmentErrors::yaw_deg, "Statistics, deg.")
      .field("translation_lower_quartile_m", &SegmentErrors::translation_lower_quartile_m, "m.")
      .field("translation_upper_quartile_m", &SegmentErrors::translation_upper_quartile_m, "m.")
      .field("dropped", &SegmentErrors::dropped, "Starts without an end within the tolerance.");
  m.def(
      "segment_errors",
      [](const PoseMatches& matches, const std::vector<double>& lengths_m, double tolerance) {
        return eval::segment_errors(matches, {.lengths_m = lengths_m, .tolerance = tolerance});
      },
      py::arg("matches"), py::arg("lengths_m") = std::vector<double>{}, py::arg("tolerance") = 0.02,
      "Errors over segments of the path; no lengths: 10 to 50 % of the path. `tolerance` is relative to the "
      "length.",
      ReleaseGil());
}

void bind_score(py::module_& m) {
  using eval::Score;
  Record<Score>(m, "Score", "Summary of a run; None: there is no data for the metric.")
      .field("ate", &Score::ate, "TUM, 20 ms, one-to-one, SE(3) alignment.")
      .field("rpe", &Score::rpe, "TUM, over `rpe_delta_s`.")
      .field("rpe_delta_s", &Score::rpe_delta_s, "s.")
      .field("correct_rate", &Score::correct_rate, "Within 1 m and 30 deg, in [0, 1].")
      .field("coverage", &Score::coverage, "Fraction of the expected frames with a pose.")
      .field("first_pose_s", &Score::first_pose_s, "From the first frame to the first pose, s.")
      .field("poses", &Score::poses, "Of the estimate.");
  m.def(
      "score",
      [](const Trajectory& gt, const Trajectory& est, const std::optional<py::object>& expected_ns,
         double offset_s) {
        eval::ScoreOptions options{.offset_s = offset_s};
        if (expected_ns) options.expected_times = stamps_of(*expected_ns, "expected_ns");
        const py::gil_scoped_release release;
        return eval::score(gt, est, options);
      },
      py::arg("gt"), py::arg("est"), py::arg("expected_ns") = py::none(), py::arg("offset_s") = 0.0,
      "The metrics of a result file; `expected_ns`: stamps of the frames, int64 [n].");
}

void bind_protocol_options(py::module_& m) {
  Options<eval::CorrectRateOptions>(m, "CorrectRateOptions", "Thresholds of a correct pose.")
      .number("max_translation_m", &eval::CorrectRateOptions::max_translation_m, "m; infinite by default.")
      .number("max_rotation_deg", &eval::CorrectRateOptions::max_rotation_deg, "deg; infinite by default.")
      .number("max_hold_s", &eval::CorrectRateOptions::max_hold_s, "How long a pose is valid at most, s.");
  Options<ProtocolOptions>(m, "ProtocolOptions", "Overrides of protocol parameters.")
      .property("alignment",
                std::pair(
                    [](const ProtocolOptions& o) {
                      return o.alignment ? std::optional(name_of(*o.alignment)) : std::nullopt;
                    },
                    [](ProtocolOptions& o, const std::optional<std::string>& name) {
                      o.alignment.reset();
                      if (name) o.alignment = value_of<eval::Alignment>("alignment", *name);
                    }),
                "none, first_pose, yaw, se3 or sim3; None: that of the protocol.")
      .field("align_first_n", &ProtocolOptions::align_first_n, "Align over the first n matches; 0: all.")
      .field("max_difference_s", &ProtocolOptions::max_difference_s,
             "Of associated stamps, s; None: of the protocol.")
      .number("rpe_delta", &ProtocolOptions::rpe_delta, "In `rpe_unit`.")
      .choice("rpe_unit", &ProtocolOptions::rpe_unit, "s, f (frames), m or deg.")
      .field("offset_s", &ProtocolOptions::offset_s, "Added to the stamps of the estimate, s.")
      .property("leveling_rotation_xyzw",
                std::pair(
                    [](const ProtocolOptions& o) {
                      return o.q_level_w ? std::optional(quaternion_array(*o.q_level_w)) : std::nullopt;
                    },
                    [](ProtocolOptions& o, const std::optional<Doubles>& q) {
                      o.q_level_w.reset();
                      if (q) o.q_level_w = quaternion_of(*q, "leveling_rotation_xyzw");
                    }),
                "Rotation (x, y, z, w) that levels the world of the estimate, as in result.json; None: it is "
                "level.")
      .field("correct", &ProtocolOptions::correct, "CorrectRateOptions; 1 m and 30 deg.")
      .field("segment_lengths_m", &ProtocolOptions::segment_lengths_m, "m; empty: 10 to 50 % of the path.")
      .field("per_pose", &ProtocolOptions::per_pose, "Whether errors per pose are computed.");
}

/// One column of the errors per pose, without a copy.
template <auto Member>
py::array error_column(const py::object& self) {
  const auto& errors = self.cast<const Evaluation&>().per_pose;
  using Value = std::remove_cvref_t<decltype(errors.front().*Member)>;
  using Number = std::conditional_t<std::is_same_v<Value, Timestamp>, std::int64_t, double>;
  const Number* first = nullptr;
  if constexpr (std::is_same_v<Value, Timestamp>) {
    if (!errors.empty()) first = &(errors.front().*Member).ns;
  } else {
    if (!errors.empty()) first = &(errors.front().*Member);
  }
  return column(std::span<const eval::PoseError>(errors), first, 1, self);
}

void bind_evaluation(py::module_& m) {
  py::class_<Evaluation> type =
      Record<Evaluation>(m, "Evaluation", "Result of one protocol for one estimate; None: n/a.")
          .field("protocol", &Evaluation::protocol, "Name, e.g. compat:tum.")
          .field("version", &Evaluation::version, "Of the protocol.")
          .field("text", &Evaluation::text, "Description of the protocol, including overrides.")
          .field("gt_poses", &Evaluation::gt_poses, "Poses of the ground truth.")
          .field("est_poses", &Evaluation::est_poses, "Poses of the estimate.")
          .field("pairs", &Evaluation::pairs, "Matched poses.")
          .field("alignment", &Evaluation::alignment, "AlignmentResult, by the positions alone.")
          .field("rotation_determined", &Evaluation::rotation_determined,
                 "Otherwise errors of orientations are None.")
          .field("ate_m", &Evaluation::ate_m, "Statistics, m.")
          .field("ate_deg", &Evaluation::ate_deg, "Statistics, deg.")
          .field("rpe_delta", &Evaluation::rpe_delta, "In `rpe_unit`.")
          .choice("rpe_unit", &Evaluation::rpe_unit, "s, f (frames), m or deg.")
          .field("rpe_m", &Evaluation::rpe_m, "Statistics over `rpe_delta`, m.")
          .field("rpe_deg", &Evaluation::rpe_deg, "Statistics over `rpe_delta`, deg.")
          .field("rpe_pairs", &Evaluation::rpe_pairs, "Pairs of two poses.")
          .field("segments", &Evaluation::segments, "List of SegmentErrors.")
          .field("drift_percent", &Evaluation::drift_percent,
                 "Mean translation error of segments by their length, %.")
          .field("correct_rate", &Evaluation::correct_rate, "In [0, 1].")
          .field("coverage", &Evaluation::coverage,
                 "Fraction of the ground truth's duration with a valid pose.")
          .field("first_pose_s", &Evaluation::first_pose_s, "s.")
          .field("jitter_m", &Evaluation::jitter_m,
                 "RMS of the second difference of the aligned position error, m.")
          .field(
              "lost_ns",
              [](const Evaluation& evaluation) {
                std::vector<std::int64_t> spans;
                for (const eval::TimeSpan& span : evaluation.lost)
                  spans.insert(spans.end(), {span.begin.ns, span.end.ns});
                return table_of(std::move(spans), 2);
              },
              "Intervals without a valid pose, int64 [n, 2], ns.")
          .field("notes", &Evaluation::notes, "Warnings about dropped data and limitations of the metrics.")
          .type();
  type.def_property_readonly("error_times_ns", &error_column<&eval::PoseError::t>,
                             "Stamps of the pairs, int64 [n], ns.")
      .def_property_readonly("errors_m", &error_column<&eval::PoseError::translation_m>,
                             "Of each pair, [n], m.")
      .def_property_readonly("errors_deg", &error_column<&eval::PoseError::rotation_deg>,
                             "Of each pair, [n], deg; NaN: not determined.");
}

void bind_protocols(py::module_& m) {
  m.def(
      "protocols",
      [] {
        std::map<std::string, std::string> texts;
        for (const eval::Protocol& protocol : eval::protocols()) texts.emplace(protocol.name, protocol.text);
        return texts;
      },
      "Names of the evaluation protocols and their descriptions.");
  m.def(
      "evaluate_protocol",
      [](const std::string& protocol, const Trajectory& gt, const Trajectory& est,
         const ProtocolOptions& options) {
        return eval::evaluate(protocol, {gt, est, options});
      },
      py::arg("protocol"), py::arg("gt"), py::arg("est"), py::arg("options") = ProtocolOptions{},
      "Evaluates with the named protocol.", ReleaseGil());
  m.def("require_overlap", &eval::require_overlap, py::arg("gt"), py::arg("est"), py::arg("offset_s"),
        py::arg("place"),
        "Raises InputError if no stamp of one lies between the first and the last of the other.",
        ReleaseGil());
}

void bind_comparison(py::module_& m) {
  using eval::ComparedRun;
  Record<ComparedRun>(m, "ComparedRun", "Errors of one run, over all its poses and over the common support.")
      .field("name", &ComparedRun::name, "Of the run.")
      .field("failed", &ComparedRun::failed, "Too few poses; ranked last.")
      .field("coverage", &ComparedRun::coverage, "Fraction of the ground truth's duration.")
      .field("own_ate_rmse_m", &ComparedRun::own_ate_rmse_m, "m.")
      .field("common_ate_rmse_m", &ComparedRun::common_ate_rmse_m, "m.")
      .field("common_rpe_m", &ComparedRun::common_rpe_m, "RMSE per second, m/s.")
      .field("common_rpe_deg", &ComparedRun::common_rpe_deg, "RMSE per second, deg/s.")
      .field("common_rpe_pairs", &ComparedRun::common_rpe_pairs, "Pairs of the relative errors.")
      .field("common_pairs", &ComparedRun::common_pairs, "Matched poses.");
  Record<eval::Comparison>(m, "Comparison", "Runs ranked by their ATE over the common support.")
      .field("ranking", &eval::Comparison::ranking, "List of ComparedRun, the best first.")
      .field("common_s", &eval::Comparison::common_s, "Duration of the common support, s.");
  m.def(
      "compare_runs",
      [](const Trajectory& gt, const std::map<std::string, const Trajectory*>& runs,
         const std::string& alignment) {
        std::vector<eval::NamedRun> named;
        for (const auto& [name, est] : runs) {
          if (est == nullptr)
            throw InputError("runs: " + name, "is None; leave out runs without a trajectory");
          named.push_back({name, *est});
        }
        return eval::compare_runs(gt, named,
                                  {.alignment = value_of<eval::Alignment>("alignment", alignment)});
      },
      py::arg("gt"), py::arg("runs"), py::arg("alignment") = "se3",
      "Ranks runs, a dict of trajectories by name, over the time in which all that did not fail have poses.");
  Record<eval::TimeOffset>(m, "TimeOffset", "Constant time offset of an estimate.")
      .field("offset_s", &eval::TimeOffset::offset_s, "To be added to the stamps of the estimate, s.")
      .field("ate_rmse_m", &eval::TimeOffset::ate_rmse_m, "At this offset, m.")
      .field("ate_rmse_at_zero_m", &eval::TimeOffset::ate_rmse_at_zero_m, "At offset 0, m.")
      .field("undetermined", &eval::TimeOffset::undetermined, "Why it is not determined; empty if it is.");
  m.def("find_time_offset", &eval::find_time_offset, py::arg("gt"), py::arg("est"),
        "The constant offset at which the motion of both agrees best; None if they have too few poses.",
        ReleaseGil());
  m.def(
      "find_convention_violations",
      [](const Trajectory& gt, const Trajectory& est) {
        std::vector<std::string> messages;
        for (const eval::ConventionFinding& finding : eval::find_convention_violations(gt, est))
          messages.push_back(finding.message);
        return messages;
      },
      py::arg("gt"), py::arg("est"),
      "Suspected violations of conventions (units, scale, frames, time), one sentence with a remedy for "
      "each.",
      ReleaseGil());
}

}  // namespace

void bind_metrics(py::module_& module) {
  bind_summary(module);
  bind_ate(module);
  bind_rpe(module);
  bind_pairs(module);
  bind_segments(module);
  bind_protocol_options(module);
  bind_coverage(module);
  bind_score(module);
  bind_evaluation(module);
  bind_protocols(module);
  bind_comparison(module);
}

}  // namespace stillpoint::python
