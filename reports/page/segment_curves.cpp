// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/segment_curves.h"

#include <algorithm>

#include "eval/metrics/segments.h"
#include "eval/metrics/strict_rpe.h"
#include "reports/tables/run_cells.h"

namespace stillpoint {
namespace {

constexpr double kShares[] = {0.1, 0.2, 0.3, 0.4, 0.5};  // of the path, as the tool of the paper cited

std::vector<double> lengths_of(const Trajectory& truth) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < truth.poses.size(); ++i)
    path_m += (truth.poses[i].T_w_f.p - truth.poses[i - 1].T_w_f.p).norm();
  std::vector<double> lengths;
  for (const double share : kShares) lengths.push_back(share * path_m);
  return lengths;
}

/// Mean error of each length [%], nothing where the run has no such stretch.
std::vector<std::optional<double>> errors_of(const Trajectory& truth, const Trajectory& path,
                                             const std::vector<double>& lengths) {
  std::vector<std::optional<double>> errors(lengths.size());
  const std::vector<MatchedPose> matches = strict_matches(truth, path);
  for (const SegmentErrors& segment : segment_errors(matches, {.lengths_m = lengths})) {
    const auto place = std::find(lengths.begin(), lengths.end(), segment.length_m);
    if (place != lengths.end())
      errors[static_cast<std::size_t>(place - lengths.begin())] =
          100.0 * segment.translation_m.mean / segment.length_m;
  }
  return errors;
}

SegmentCurve curve_of(const Store& store, const std::vector<const StoredRun*>& runs, const std::string& label,
                      const std::vector<double>& lengths) {
  std::vector<std::vector<double>> errors(lengths.size());
  for (const StoredRun* run : runs) {
    const auto own = errors_of(store.truth(*run), store.trajectory(*run), lengths);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (own[i]) errors[i].push_back(*own[i]);
    }
  }
  SegmentCurve curve{.label = label, .translation_percent = {}};
  for (const std::vector<double>& values : errors)
    curve.translation_percent.push_back(percentile(values, 0.5));
  return curve;
}

}  // namespace

std::vector<SegmentFigure> segment_figures(const Store& store, std::span<const StoredRun> runs) {
  std::vector<SegmentFigure> figures;
  for (const std::string& sequence :
       distinct(runs, [](const RunIdentity& identity) { return identity.sequence; })) {
    SegmentFigure figure{.sequence = sequence, .lengths_m = {}, .curves = {}};
    for (const std::string& label : distinct(runs, system_label)) {
      const std::vector<const StoredRun*> own = runs_of(runs, label, sequence);
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

}  // namespace stillpoint
