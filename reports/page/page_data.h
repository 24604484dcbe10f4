// SPDX-License-Identifier: BSD-3-Clause
/// JSON data of a report page: list of runs, time series, ground truths and manifests.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/charts/box_plot.h"

namespace stillpoint::report {

struct PageData {
  std::string index;  ///< JSON: runs; truths and manifests by hash; flames; segments; tooltips of metrics
  std::vector<std::string> series;    ///< JSON of each run, in the order of the index
  std::vector<std::string> images;    ///< JSON of each run: annotated images by frame index
  std::vector<PlotBox> module_boxes;  ///< time per frame and module [ms], by variant
};

/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] PageData page_data(const bench::Store& store, std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
