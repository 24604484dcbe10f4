// SPDX-License-Identifier: BSD-3-Clause
/// Comparison of two stores by content: whether the same plan gave the same results at two places.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint::bench {

/// Differences between the completed runs and the plans of two stores, one line each; empty if they are
/// equal. A run is compared by its identity, outcome, metrics, manifest, timed modules and attachments. Not
/// compared: what depends on the machine or on the time of execution, that is, times, memory and load, the
/// host in the manifest, time stamps, and the attachments "result", "timings", "stacks" and "log".
/// @throws InputError if one of them cannot be read
[[nodiscard]] std::vector<std::string> store_differences(const std::filesystem::path& first,
                                                         const std::filesystem::path& second);

}  // namespace stillpoint::bench
