// SPDX-License-Identifier: BSD-3-Clause
/// What happened at each frame of a run: where it was, how far off, what it counted, how long it took.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint {

/// One number for each frame; NaN where there is none.
struct SeriesColumn {
  std::string name;  ///< e.g. "error_m", "x", "ms:feature_tracking"
  std::vector<double> values;
};

struct RunSeries {
  double start_s = 0.0;     ///< stamp of the first frame
  std::vector<double> t_s;  ///< since then
  /// x, y, z [m] aligned to the ground truth (as estimated, without one), error_m, error_deg, growth_m
  /// (see eval/metrics/error_growth.h), features,
  /// landmarks, dynamic (share of the features), ms:MODULE. Those without any number are left out.
  std::vector<SeriesColumn> columns;
  /// Frames that people should look at, the one at which the error grew most first: those that have a
  /// picture, else the 20 worst. Positions in `t_s`.
  std::vector<std::size_t> worst;
  std::map<std::size_t, std::string> pictures;  ///< kind of attachment by position
};

/// @throws InputError if files of the run are missing or damaged
[[nodiscard]] RunSeries run_series(const Store& store, const StoredRun& run);

}  // namespace stillpoint
