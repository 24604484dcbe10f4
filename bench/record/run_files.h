// SPDX-License-Identifier: BSD-3-Clause
/// The three files of a run: trajectory.tum, result.json, manifest.json.
#pragma once

#include <filesystem>
#include <string>

#include "bench/record/output_folder.h"
#include "bench/record/run_manifest.h"
#include "bench/run/run_result.h"

namespace stillpoint {

/// Text of result.json; numbers without data are null.
[[nodiscard]] std::string result_json(const RunResult& result);

/// Text of manifest.json.
[[nodiscard]] std::string manifest_json(const RunManifest& manifest);

/// Text of trajectory.tum; the first line of an unfinished one says so.
[[nodiscard]] std::string trajectory_text(const RunResult& result);

/// Writes the three files and the dumps that were asked for, together or not at all.
/// @throws InputError if the folder cannot be written
void write_run(const std::filesystem::path& folder, const RunResult& result, const RunManifest& manifest,
               std::vector<OutputFile> dumps = {});

}  // namespace stillpoint
