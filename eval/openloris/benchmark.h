// SPDX-License-Identifier: BSD-3-Clause
/// The OpenLORIS-Scene metrics (Shi et al., ICRA 2020; evaluate.py of its tools): of one run on one sequence,
/// of one system over the sequences of a scene, and of a folder of results (one subfolder per system) against
/// a folder of ground truth.
///
/// One run on one sequence:
///
///   correct(k)  = e_k <= max_translation_m and theta_k <= max_rotation_deg   (e_k, theta_k: see ate.h)
///   c           = sum over correct k of min(max_hold_s, t_(k+1) - t_k),  t_(N+1) = t_max
///   CR          = c / (t_max - t_min),  CR-T = c / (t_max - t_1)
///   C_ATE       = RMSE of e_k over correct k
///   reloc score = exp(-(t_1 - t_min) / 60 s) if correct(1), else 0
///
/// t_k: stamps of the N matches; t_min: start of the ground truth; t_max: the later one of the end of the
/// ground truth and t_N.
///
/// One system over the sequences q of a scene:
///
///   figure correct rate = sum_q c_q / sum_q d_q        over all sequences of the ground truth
///   CR-T                = sum_q r_q T_q / sum_q T_q    over sequences with a result
///   weighted ATE        = sum_q n_q a_q / sum_q n_q
///   pooled ATE          = sqrt(sum_q n_q a_q^2 / sum_q n_q)
///
/// c_q: correct time; d_q: duration of the ground truth; T_q: time since the first match; r_q = c_q / T_q;
/// n_q: number of correct poses; a_q: their ATE RMSE, C_ATE.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {

struct OpenlorisOptions {
  CorrectRateOptions correct;  ///< thresholds infinite by default, as in the tools
  double max_gap_s = 0.5;      ///< to each ground-truth neighbor
  bool scale = false;          ///< align by Sim(3) instead of SE(3)
};

/// Interval of valid correct poses [s since the start of the ground truth].
struct TrackedSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Scores of one sequence. Without matches the errors are absent and the rates are 0.
struct OpenlorisSequenceScore {
  std::size_t poses = 0;             ///< of the estimate, without repeated ones
  std::size_t matches = 0;           ///< poses with ground truth
  std::size_t correct = 0;           ///< correct matches
  std::optional<double> ate_rmse_m;  ///< over all matches
  std::optional<double> aoe_rmse_deg;
  std::optional<double> correct_ate_rmse_m;  ///< C_ATE
  std::optional<double> correct_aoe_rmse_deg;
  double correct_rate = 0.0;  ///< CR
  double tracked_rate = 0.0;  ///< CR-T
  double gt_duration_s = 0.0;
  double tracked_time_s = 0.0;                  ///< t_max - t_1
  double correct_time_s = 0.0;                  ///< c
  std::optional<double> relocalization_time_s;  ///< t_1 - t_min, at least 0
  double relocalization_score = 0.0;
  std::vector<TrackedSpan> tracked_spans;
};

/// @param gt ground truth of the body frame of the estimate
/// @param est poses as in the result file, before the alignment
/// @param S_w_v alignment, see `align_openloris`
/// @param options `scale` has no effect: the alignment is given
[[nodiscard]] OpenlorisSequenceScore score_openloris_sequence(const Trajectory& gt, const Trajectory& est,
                                                              const Similarity& S_w_v,
                                                              const OpenlorisOptions& options = {});

/// Alignment for all sequences of a result file: that of its lowest-numbered sequence with matches, or
/// identity.
/// @param gt by sequence number, of the body frame of the estimate
/// @param est by sequence number
/// @param options `correct` has no effect: all matches are aligned
[[nodiscard]] Similarity align_openloris(const std::map<int, Trajectory>& gt,
                                         const std::map<int, Trajectory>& est,
                                         const OpenlorisOptions& options = {});

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
  std::optional<Statistics> rpe_m;  ///< strict RPE with delta 1 s, see rpe.h
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

/// Pose T_base_sensor of a sensor in base_link, for the robot that recorded `scene`: one robot recorded
/// office, corridor, home and cafe, the other one market. Values of the OpenLORIS-Scene tools (MIT license).
/// @param scene in lower case
/// @param frame base_link, d400_color, d400_depth, d400_imu, t265_fisheye1, t265_fisheye2 or t265_imu
/// @throws InputError for an unknown scene or frame; the message lists the known ones
[[nodiscard]] Pose openloris_frame(std::string_view scene, std::string_view frame);

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
