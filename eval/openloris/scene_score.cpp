// SPDX-License-Identifier: BSD-3-Clause
#include "eval/openloris/scene_score.h"

#include <cmath>

#include "eval/metrics/strict_rpe.h"

namespace stillpoint::eval {
namespace {

constexpr double kRpeDelta = 1.0;  // [s]

/// Weighted mean; nullopt while the total weight is 0.
class WeightedMean {
 public:
  void add(double value, double weight) {
    sum_ += value * weight;
    weight_ += weight;
  }
  [[nodiscard]] std::optional<double> mean() const {
    if (weight_ <= 0.0) return std::nullopt;
    return sum_ / weight_;
  }
  [[nodiscard]] std::optional<double> root_mean() const {
    const std::optional<double> value = mean();
    if (!value) return std::nullopt;
    return std::sqrt(*value);
  }

 private:
  double sum_ = 0.0;
  double weight_ = 0.0;
};

PooledRpe pool_rpe(const std::map<int, OpenlorisRun>& runs) {
  PooledRpe pooled;
  WeightedMean translation;
  WeightedMean rotation;
  for (const auto& [number, run] : runs) {
    pooled.dropped += run.rpe_dropped;
    if (!run.rpe_m || !run.rpe_deg) continue;
    const double count = static_cast<double>(run.rpe_m->count);
    translation.add(run.rpe_m->rmse * run.rpe_m->rmse, count);
    rotation.add(run.rpe_deg->rmse * run.rpe_deg->rmse, count);
    pooled.pairs += run.rpe_m->count;
  }
  pooled.trans_rmse_m_per_s = translation.root_mean();
  pooled.rot_rmse_deg_per_s = rotation.root_mean();
  return pooled;
}

}  // namespace

OpenlorisRun score_openloris_run(const Trajectory& gt, const Trajectory& est, const Similarity& S_w_v,
                                 const OpenlorisOptions& options) {
  OpenlorisRun run;
  run.score = score_openloris_sequence(gt, est, S_w_v, options);
  Trajectory aligned = est;
  for (StampedPose& pose : aligned.poses) pose.T_w_f = S_w_v * pose.T_w_f;
  const StrictRpeResult rpe = strict_rpe(strict_matches(gt, aligned), kRpeDelta);
  if (rpe.errors) {
    run.rpe_m = rpe.errors->translation_m;
    run.rpe_deg = rpe.errors->rotation_deg;
  }
  run.rpe_dropped = rpe.dropped;
  return run;
}

OpenlorisSceneScore score_openloris_scene(const std::map<int, OpenlorisRun>& runs,
                                          const std::map<int, double>& gt_durations_s) {
  OpenlorisSceneScore scene;
  scene.expected_sequences = gt_durations_s.size();
  scene.sequences = runs.size();
  WeightedMean tracked_rate;
  WeightedMean weighted_ate;
  WeightedMean squared_ate;
  double correct_time_s = 0.0;
  for (const auto& [number, run] : runs) {
    const OpenlorisSequenceScore& score = run.score;
    tracked_rate.add(score.tracked_rate, score.tracked_time_s);
    correct_time_s += score.correct_time_s;
    if (!score.correct_ate_rmse_m) continue;
    const double correct = static_cast<double>(score.correct);
    weighted_ate.add(*score.correct_ate_rmse_m, correct);
    squared_ate.add(*score.correct_ate_rmse_m * *score.correct_ate_rmse_m, correct);
  }
  double duration_s = 0.0;
  for (const auto& [number, seconds] : gt_durations_s) duration_s += seconds;
  if (duration_s > 0.0) scene.figure_correct_rate = correct_time_s / duration_s;
  scene.tracked_rate = tracked_rate.mean();
  scene.weighted_ate_rmse_m = weighted_ate.mean();
  scene.pooled_ate_rmse_m = squared_ate.root_mean();
  scene.rpe = pool_rpe(runs);
  return scene;
}

}  // namespace stillpoint::eval
