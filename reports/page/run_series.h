// SPDX-License-Identifier: BSD-3-Clause
/// What happened at each frame of a run: where it was, how far off, what it counted, how long it took.
#pragma once

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
  /// x, y, z [m] aligned to the ground truth (as estimated, without one), error_m, error_deg, features,
  /// landmarks, dynamic (share of the features), ms:MODULE. Those without any number are left out.
  std::vector<SeriesColumn> columns;
};

/// @throws InputError if files of the run are missing or damaged
[[nodiscard]] RunSeries run_series(const Store& store, const StoredRun& run);

}  // namespace stillpoint
