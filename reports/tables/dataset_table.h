// SPDX-License-Identifier: BSD-3-Clause
/// A metric on all sequences of a dataset: published systems beside ours, one row per sequence.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/systems/published_table.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

struct DatasetTableLayout {
  std::string name;  ///< base name of the files
  std::string title;
  std::vector<std::string> sequences;  ///< of the plan; also those without data
  std::vector<std::string> variants;   ///< of the plan
};

/// Sequences without data are rows without numbers. The last row contains the mean of each column over the
/// sequences with a number; a note states how many these are.
/// @param published may have no rows; its metric selects the numbers of the runs
[[nodiscard]] ReportTable dataset_table(const DatasetTableLayout& layout,
                                        std::span<const bench::StoredRun> runs,
                                        const bench::PublishedTable& published);

}  // namespace stillpoint::report
