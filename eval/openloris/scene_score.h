// SPDX-License-Identifier: BSD-3-Clause
/// OpenLORIS-Scene metrics of one system over the sequences q of a scene (Shi et al., ICRA 2020):
///
///   figure correct rate = sum_q c_q / sum_q d_q        over all sequences of the ground truth
///   CR-T                = sum_q r_q T_q / sum_q T_q    over sequences with a result
///   weighted ATE        = sum_q n_q a_q / sum_q n_q
///   pooled ATE          = sqrt(sum_q n_q a_q^2 / sum_q n_q)
///
/// c_q: correct time; d_q: duration of the ground truth; T_q: time since the first match; r_q = c_q / T_q;
/// n_q: number of correct poses; a_q: their ATE RMSE (see sequence_score.h).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "eval/metrics/statistics.h"
#include "eval/openloris/sequence_score.h"

namespace stillpoint::eval {

/// RMSE over the pairs of all sequences together.
struct PooledRpe {
  std::optional<double> trans_rmse_m_per_s;
  std::optional<double> rot_rmse_deg_per_s;
  std::size_t pairs = 0;
  std::size_t dropped = 0;  ///< starts without an end within the tolerance
};

/// One system on one sequence.
struct OpenlorisRun {
  OpenlorisSequenceScore score;
  std::optional<Statistics> rpe_m;  ///< strict RPE with delta 1 s, see strict_rpe.h
  std::optional<Statistics> rpe_deg;
  std::size_t rpe_dropped = 0;
};

/// Same parameters as `score_openloris_sequence`.
[[nodiscard]] OpenlorisRun score_openloris_run(const Trajectory& gt, const Trajectory& est,
                                               const Similarity& S_w_v, const OpenlorisOptions& options = {});

/// One system on one scene. Each of the three correct rates and two scene ATEs of the tools has its own name.
struct OpenlorisSceneScore {
  std::size_t sequences = 0;                  ///< with a result
  std::size_t expected_sequences = 0;         ///< in the ground truth
  double figure_correct_rate = 0.0;           ///< includes failed and missing sequences
  std::optional<double> tracked_rate;         ///< CR-T
  std::optional<double> weighted_ate_rmse_m;  ///< printed by the tools
  std::optional<double> pooled_ate_rmse_m;
  PooledRpe rpe;
};

/// @param runs by sequence number
/// @param gt_durations_s of every sequence of the scene, by number
[[nodiscard]] OpenlorisSceneScore score_openloris_scene(const std::map<int, OpenlorisRun>& runs,
                                                        const std::map<int, double>& gt_durations_s);

/// Results of one system on one scene; `runs` by sequence number.
struct OpenlorisScene {
  std::map<int, OpenlorisRun> runs;
  OpenlorisSceneScore score;
};

/// Results of all systems on all scenes.
struct OpenlorisBenchmark {
  std::map<std::string, std::map<int, double>> gt_durations_s;           ///< scene -> sequence -> [s]
  std::map<std::string, std::map<std::string, OpenlorisScene>> systems;  ///< system -> scene
};

}  // namespace stillpoint::eval
