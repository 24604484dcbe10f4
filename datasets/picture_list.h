// SPDX-License-Identifier: BSD-3-Clause
/// Lists of stamped pictures, and the pairing of two of them by time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/fault_log.h"

namespace stillpoint {

struct StampedFile {
  Timestamp t;
  std::filesystem::path file;
};

/// Reads rows `t path`, t in seconds, paths relative to the list's folder. The pictures need not exist.
/// @return strictly rising, not empty
/// @throws InputError if the list is missing, empty or unsorted
[[nodiscard]] std::vector<StampedFile> read_picture_list(const std::filesystem::path& file, FaultLog& faults);

/// Pairs (index in a, index in b) no further apart than `max_difference_s`, each index used once, taken in
/// the order of rising difference; sorted by time. As the TUM RGB-D benchmark's associate tool does it (Sturm
/// et al. 2012).
/// @param a, b strictly rising
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> associate(std::span<const StampedFile> a,
                                                                         std::span<const StampedFile> b,
                                                                         double max_difference_s);

}  // namespace stillpoint
