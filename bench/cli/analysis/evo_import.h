// SPDX-License-Identifier: BSD-3-Clause
/// Results of evo_ape and evo_rpe as runs of a store. `--save_results` writes a zip file with info.json
/// (title, label, names of the files), stats.json (rmse, mean, ...) and error_array.npy, one error per pose
/// or pair.
#pragma once

#include <filesystem>

#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

/// Whether a file begins like a zip file.
[[nodiscard]] bool is_zip_file(const std::filesystem::path& file);

/// Adds one run, whose system is the name of the estimate and whose sequence is that of the reference. Its
/// metric is the RMSE: `ate_rmse_m`, `ate_rmse_deg`, `rpe_rmse_m` or `rpe_rmse_deg`, by the label; the title
/// is its protocol.
/// @throws InputError if the file is no such result, the label has another unit, or the RMSE is not that of
/// the errors, sqrt(mean e^2)
[[nodiscard]] MergeReport import_evo(const std::filesystem::path& file, const std::filesystem::path& store);

}  // namespace stillpoint::bench
