// SPDX-License-Identifier: BSD-3-Clause
/// What the scripts of a page read: the list of runs, their series, true paths and manifests.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/box_plot.h"

namespace stillpoint {

struct PageData {
  std::string index;                  ///< JSON: runs; truths and manifests by name; flames; segments
  std::vector<std::string> series;    ///< JSON of each run, in the order of the index
  std::vector<std::string> pictures;  ///< likewise: annotated pictures by position of their frame
  std::vector<PlotBox> module_boxes;  ///< time of each frame in each module [ms], by variant
};

/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] PageData page_data(const Store& store, std::span<const StoredRun> runs);

}  // namespace stillpoint
