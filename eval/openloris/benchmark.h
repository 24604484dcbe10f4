// SPDX-License-Identifier: BSD-3-Clause
/// A folder of OpenLORIS result files, one folder a system, scored against a folder of ground truth.
#pragma once

#include <filesystem>
#include <vector>

#include "eval/openloris/scene_score.h"

namespace stillpoint {

struct OpenlorisBenchmarkOptions {
  OpenlorisOptions metric;
  bool lifelong_thresholds = false;  ///< correct within 1 m (office), 3 m (home, cafe), 5 m (others), 30 deg
  bool keep_repeated_poses = false;
  std::vector<std::string> scaled_systems{"dso", "svo"};  ///< monocular: scale is estimated, as in the tools
};

struct OpenlorisEvaluation {
  OpenlorisBenchmark benchmark;
  std::vector<std::string> skipped;  ///< a sentence each
};

/// Scores every `*.txt` of every folder below `results` against `gt_<scene>_1.txt` in `ground_truth`. Scenes
/// without a ground-truth file are left out and named in `skipped`.
/// @throws InputError for an unreadable folder or file, two results for one sequence, or no scene at all
[[nodiscard]] OpenlorisEvaluation evaluate_openloris(const std::filesystem::path& results,
                                                     const std::filesystem::path& ground_truth,
                                                     const OpenlorisBenchmarkOptions& options = {});

}  // namespace stillpoint
