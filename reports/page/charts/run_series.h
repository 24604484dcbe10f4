// SPDX-License-Identifier: BSD-3-Clause
/// Per-frame time series of a run: position, errors, counters and module times.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/charts/fault_bands.h"

namespace stillpoint::report {

/// One value per frame; NaN = missing.
struct SeriesColumn {
  std::string name;  ///< e.g. "error_m", "x", "ms:feature_tracking"
  std::vector<double> values;
};

struct RunSeries {
  double start_s = 0.0;     ///< stamp of the first frame
  std::vector<double> t_s;  ///< since the first frame
  /// x, y, z [m] aligned to the ground truth (unaligned without one), error_m, error_deg, three_sigma_m and
  /// three_sigma_deg (claimed, along the least certain direction), frame_to_frame_error_m (see
  /// eval/metrics/frame_to_frame_error.h), features, landmarks, dynamic (fraction of the features), status
  /// (position in `OdometryStatus`), ms:MODULE. Empty columns are omitted.
  std::vector<SeriesColumn> columns;
  /// Indices into `t_s` by falling frame-to-frame error: the frames that have an image, else the 20 worst.
  std::vector<std::size_t> worst;
  std::vector<FaultBand> faults;              ///< injected ones
  std::map<std::size_t, std::string> images;  ///< attachment kind by index into `t_s`
};

/// @throws InputError if files of the run are missing or damaged
[[nodiscard]] RunSeries run_series(const bench::Store& store, const bench::StoredRun& run);

}  // namespace stillpoint::report
