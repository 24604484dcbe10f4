// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error over path segments of increasing length, by variant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::report {

struct SegmentCurve {
  std::string label;
  std::size_t runs = 0;  ///< with any error
  /// Per segment length: median over the variant's runs of each run's mean translational error [% of the
  /// length]; nullopt where no run has a segment of that length.
  std::vector<std::optional<double>> translation_percent;
};

/// All variants on one sequence.
struct SegmentFigure {
  std::string sequence;
  std::vector<double> lengths_m;  ///< 10, 20, 30, 40 and 50 % of the ground truth's path length
  std::vector<SegmentCurve> curves;
};

/// Runs outside sweeps with a ground truth. Metric: Zhang and Scaramuzza, IROS 2018.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] std::vector<SegmentFigure> segment_figures(const bench::Store& store,
                                                         std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
