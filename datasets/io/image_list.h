// SPDX-License-Identifier: BSD-3-Clause
/// Lists of timestamped image files.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "eval/io/text_table.h"

namespace stillpoint::datasets {

struct StampedFile {
  Timestamp t;
  std::filesystem::path file;
};

/// Reads rows `t path`, paths relative to `root`. The images need not exist.
/// @param list text file; `unit` is the unit of its stamps
/// @return strictly increasing in time, not empty
/// @throws InputError if the list is missing, empty or unsorted
[[nodiscard]] std::vector<StampedFile> read_image_list(const std::filesystem::path& list,
                                                       const std::filesystem::path& root, eval::TimeUnit unit,
                                                       FaultLog& faults);

}  // namespace stillpoint::datasets
