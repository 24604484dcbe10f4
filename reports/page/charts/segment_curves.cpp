// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/segment_curves.h"

#include <algorithm>

#include "eval/metrics/segments.h"
#include "eval/metrics/strict_rpe.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

// Of the path length; defaults of rpg_trajectory_evaluation (Zhang and Scaramuzza, IROS 2018).
constexpr double kLengthFractions[] = {0.1, 0.2, 0.3, 0.4, 0.5};

std::vector<double> lengths_of(const Trajectory& truth) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < truth.poses.size(); ++i)
    path_m += (truth.poses[i].T_w_f.p - truth.poses[i - 1].T_w_f.p).norm();
  std::vector<double> lengths;
  for (const double fraction : kLengthFractions) lengths.push_back(fraction * path_m);
  return lengths;
}

/// Mean translational error per length [%]; nullopt where the run has no segment of that length.
std::vector<std::optional<double>> errors_of(const Trajectory& truth, const Trajectory& path,
                                             const std::vector<double>& lengths) {
  std::vector<std::optional<double>> errors(lengths.size());
  const std::vector<eval::MatchedPose> matches = eval::strict_matches(truth, path);
  for (const eval::SegmentErrors& segment : eval::segment_errors(matches, {.lengths_m = lengths})) {
    const auto found = std::find(lengths.begin(), lengths.end(), segment.length_m);
    if (found != lengths.end())
      errors[static_cast<std::size_t>(found - lengths.begin())] =
          100.0 * segment.translation_m.mean / segment.length_m;
  }
  return errors;
}

SegmentCurve curve_of(const bench::Store& store, const std::vector<const bench::StoredRun*>& runs,
                      const std::string& label, const std::vector<double>& lengths) {
  std::vector<std::vector<double>> errors(lengths.size());
  SegmentCurve curve{.label = label, .runs = 0, .translation_percent = {}};
  for (const bench::StoredRun* run : runs) {
    const auto own = errors_of(store.truth(*run), store.trajectory(*run), lengths);
    curve.runs +=
        std::any_of(own.begin(), own.end(), [](const auto& error) { return error.has_value(); }) ? 1 : 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (own[i]) errors[i].push_back(*own[i]);
    }
  }
  for (const std::vector<double>& values : errors)
    curve.translation_percent.push_back(eval::percentile(values, 0.5));
  return curve;
}

}  // namespace

std::vector<SegmentFigure> segment_figures(const bench::Store& store,
                                           std::span<const bench::StoredRun> runs) {
  std::vector<SegmentFigure> figures;
  for (const std::string& sequence :
       distinct(runs, [](const bench::RunIdentity& identity) { return identity.sequence; })) {
    SegmentFigure figure{.sequence = sequence, .lengths_m = {}, .curves = {}};
    for (const std::string& label : distinct(runs, system_label)) {
      const std::vector<const bench::StoredRun*> own = runs_of(runs, label, sequence);
      if (own.empty()) continue;
      if (figure.lengths_m.empty()) figure.lengths_m = lengths_of(store.truth(*own.front()));
      SegmentCurve curve = curve_of(store, own, label, figure.lengths_m);
      const auto& errors = curve.translation_percent;
      if (std::any_of(errors.begin(), errors.end(), [](const auto& error) { return error.has_value(); }))
        figure.curves.push_back(std::move(curve));
    }
    if (!figure.curves.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace stillpoint::report
