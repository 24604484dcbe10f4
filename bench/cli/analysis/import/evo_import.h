// SPDX-License-Identifier: BSD-3-Clause
/// Results of evo_ape and evo_rpe as runs of a store. `--save_results` writes a zip file with info.json
/// (title, label, names of the files), stats.json (rmse, mean, ...) and error_array.npy, one error per pose
/// or pair.
#pragma once

#include <filesystem>
#include <string>

#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

/// Whether a file begins like a zip file.
[[nodiscard]] bool is_zip_file(const std::filesystem::path& file);

/// Names that replace those in the result; empty: from its paths.
struct EvoNames {
  std::string system;
  std::string sequence;
};

/// Adds one run. Its sequence is named by the path of the reference, its system by that of the estimate: the
/// file without its extension, or the first folder above it that does not have a general name such as
/// "groundtruth" (for systems also: the name of the sequence). Its metric is the RMSE: `ate_rmse_m`,
/// `ate_rmse_deg`, `rpe_rmse_m` or `rpe_rmse_deg`, by label and title; the title is its protocol.
/// @throws InputError if the file is no such result, has another pose relation or unit, names no system or
/// sequence, the RMSE is not that of the errors, sqrt(mean e^2), or the store has another value or protocol
/// of this metric, system and sequence
[[nodiscard]] MergeReport import_evo(const std::filesystem::path& file, const std::filesystem::path& store,
                                     const EvoNames& names);

}  // namespace stillpoint::bench
