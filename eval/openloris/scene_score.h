// SPDX-License-Identifier: BSD-3-Clause
/// OpenLORIS-Scene metrics of one system over a scene, by the tools' rules of aggregation.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "eval/metrics/statistics.h"
#include "eval/openloris/sequence_score.h"

namespace stillpoint {

/// Root mean squares over all sequences' pairs together, and how many pairs.
struct PooledRpe {
  std::optional<double> trans_rmse_m_per_s;
  std::optional<double> rot_rmse_deg_per_s;
  std::size_t pairs = 0;
  std::size_t dropped = 0;
};

/// One system on one sequence.
struct OpenlorisRun {
  OpenlorisSequenceScore score;
  std::optional<Statistics> rpe_m;  ///< strict, over 1 s
  std::optional<Statistics> rpe_deg;
  std::size_t rpe_dropped = 0;
};

/// Parameters as `score_openloris_sequence`.
[[nodiscard]] OpenlorisRun score_openloris_run(const Trajectory& gt, const Trajectory& est,
                                               const Similarity& S_w_v, const OpenlorisOptions& options = {});

/// One system on one scene. Three correct rates and two errors exist in the tools; each has its own name
/// here.
struct OpenlorisSceneScore {
  std::size_t sequences = 0;           ///< that have a result
  std::size_t expected_sequences = 0;  ///< that the ground truth has
  double figure_correct_rate = 0.0;    ///< correct time / time of all sequences, failed and missing ones too
  std::optional<double> tracked_rate;  ///< CR-T: correct time / time since each first match
  std::optional<double> weighted_ate_rmse_m;  ///< mean of C_ATE weighted by correct poses, as the tools print
  std::optional<double> pooled_ate_rmse_m;    ///< RMSE over all correct poses together
  PooledRpe rpe;
};

/// @param runs by sequence number
/// @param gt_durations_s of every sequence of the scene, by number
[[nodiscard]] OpenlorisSceneScore score_openloris_scene(const std::map<int, OpenlorisRun>& runs,
                                                        const std::map<int, double>& gt_durations_s);

/// A scene's ground truth, and what one system made of it.
struct OpenlorisScene {
  std::map<int, OpenlorisRun> runs;
  OpenlorisSceneScore score;
};

/// Scores by system and scene.
struct OpenlorisBenchmark {
  std::map<std::string, std::map<int, double>> gt_durations_s;           ///< scene -> sequence -> [s]
  std::map<std::string, std::map<std::string, OpenlorisScene>> systems;  ///< system -> scene
};

}  // namespace stillpoint
