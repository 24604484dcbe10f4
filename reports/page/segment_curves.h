// SPDX-License-Identifier: BSD-3-Clause
/// Relative errors over stretches of the path, by variant: how errors grow with the way.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint {

struct SegmentCurve {
  std::string label;
  /// Median over the runs of a variant of each run's mean error [% of the length]; nothing where no run has
  /// such a stretch.
  std::vector<std::optional<double>> translation_percent;
};

/// All variants on one sequence.
struct SegmentFigure {
  std::string sequence;
  std::vector<double> lengths_m;  ///< 10, 20, 30, 40 and 50 % of the true path
  std::vector<SegmentCurve> curves;
};

/// Of runs outside sweeps whose sequence has a ground truth; as in Zhang and Scaramuzza, IROS 2018.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] std::vector<SegmentFigure> segment_figures(const Store& store, std::span<const StoredRun> runs);

}  // namespace stillpoint
