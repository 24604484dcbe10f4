// SPDX-License-Identifier: BSD-3-Clause
/// Lists of timestamped image files, and the association of two lists by time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/io/fault_log.h"

namespace stillpoint::datasets {

struct StampedFile {
  Timestamp t;
  std::filesystem::path file;
};

/// Reads rows `t path`, t in seconds, paths relative to the list's folder. The files need not exist.
/// @return strictly increasing in time, not empty
/// @throws InputError if the list is missing, empty or unsorted
[[nodiscard]] std::vector<StampedFile> read_image_list(const std::filesystem::path& file, FaultLog& faults);

/// Associates two lists as `associate.py` of the TUM RGB-D benchmark does (Sturm et al. 2012): greedily, in
/// order of increasing time difference, each index used once.
/// @param a, b strictly increasing in time
/// @return pairs (index in a, index in b) at most `max_difference_s` apart, sorted by time
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> associate(std::span<const StampedFile> a,
                                                                         std::span<const StampedFile> b,
                                                                         double max_difference_s);

}  // namespace stillpoint::datasets
