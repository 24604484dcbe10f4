// SPDX-License-Identifier: BSD-3-Clause
/// Scores a folder of OpenLORIS results (one subfolder per system) against a folder of ground truth.
#pragma once

#include <filesystem>
#include <vector>

#include "eval/openloris/scene_score.h"

namespace stillpoint::eval {

struct OpenlorisBenchmarkOptions {
  OpenlorisOptions metric;
  bool lifelong_thresholds = false;  ///< correct: 1 m (office), 3 m (home, cafe), 5 m (others), and 30 deg
  bool keep_repeated_poses = false;
  std::vector<std::string> scaled_systems{"dso", "svo"};  ///< aligned by Sim(3), as in the tools
};

struct OpenlorisEvaluation {
  OpenlorisBenchmark benchmark;
  std::vector<std::string> skipped;  ///< messages about skipped results and rows
};

/// Scores every `*.txt` file in every subfolder of `results` against `gt_<scene>_1.txt` in `ground_truth`.
/// Scenes without a ground-truth file are skipped and listed in `skipped`.
/// @throws InputError for an unreadable folder or file, two results for one sequence, or no scene at all
[[nodiscard]] OpenlorisEvaluation evaluate_openloris(const std::filesystem::path& results,
                                                     const std::filesystem::path& ground_truth,
                                                     const OpenlorisBenchmarkOptions& options = {});

}  // namespace stillpoint::eval
