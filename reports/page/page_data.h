// SPDX-License-Identifier: BSD-3-Clause
/// Data that is embedded in a report page: JSON lists of runs, time series in a compact encoding, ground
/// truths, manifests, and annotated images.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/store/store.h"
#include "reports/page/chart_data.h"

namespace stillpoint::report {

/// {"low", "step", "data"}: value = low + step * (16-bit little-endian number), 65535 = missing. The
/// quantization error is at most 1/131068 of the range.
[[nodiscard]] nlohmann::ordered_json packed_series(std::span<const double> values);

/// JSON of each run: frame index -> JPEG in base64. Images are added in rounds, the worst frame of every run
/// first, then the second worst of every run, until the budget is used up: every run gets its worst frames.
///
/// @param series       of each run
/// @param budget_bytes base64 size of all images together
/// @throws InputError if an image is missing or damaged
[[nodiscard]] std::vector<std::string> page_images(const bench::Store& store,
                                                   std::span<const bench::StoredRun> runs,
                                                   std::span<const RunSeries> series,
                                                   std::size_t budget_bytes);

struct PageData {
  std::string index;  ///< JSON: runs; truths and manifests by hash; flames; segments; tooltips of metrics
  std::vector<std::string> series;    ///< JSON of each run, in the order of the index
  std::vector<std::string> images;    ///< JSON of each run: annotated images by frame index
  std::vector<std::string> truths;    ///< JSON of each run: ground truth or null; empty if in the index
  std::vector<PlotBox> module_boxes;  ///< time per frame and module [ms], by variant
};

/// Where the data of the runs is.
enum class RunData {
  kEmbedded,   ///< in the page: thinned, and with the images of the worst frames, to limit its size
  kSideFiles,  ///< in a file per run: all frames, and up to 100 MB of images
};

/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] PageData page_data(const bench::Store& store, std::span<const bench::StoredRun> runs,
                                 RunData place);

}  // namespace stillpoint::report
