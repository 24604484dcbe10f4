// SPDX-License-Identifier: BSD-3-Clause
#include "eval/openloris/benchmark.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/base/error.h"
#include "eval/io/openloris_file.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

constexpr double kRelocalizationScale = 60.0;  // [s]

std::optional<double> rmse(std::span<const double> values) {
  const std::optional<Statistics> summary = statistics(values);
  if (!summary) return std::nullopt;
  return summary->rmse;
}

/// Per match, whether it is correct.
std::vector<bool> correct_mask(const AteErrors& errors, const CorrectRateOptions& limits) {
  std::vector<bool> correct;
  for (std::size_t i = 0; i < errors.translation_m.size(); ++i) {
    correct.push_back(errors.translation_m[i] <= limits.max_translation_m &&
                      errors.rotation_deg[i] <= limits.max_rotation_deg);
  }
  return correct;
}

std::vector<double> select(std::span<const double> values, const std::vector<bool>& mask) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (mask[i]) result.push_back(values[i]);
  }
  return result;
}

std::vector<TrackedSpan> spans_of(MatchView matches, const std::vector<bool>& correct, const Trajectory& gt,
                                  double max_hold_s) {
  const Timestamp start = gt.poses.front().t;
  const Timestamp end = std::max(gt.poses.back().t, matches.back().t);
  std::vector<TrackedSpan> spans;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!correct[i]) continue;
    const double begin_s = seconds_between(start, matches[i].t);
    const double until_s = seconds_between(start, i + 1 < matches.size() ? matches[i + 1].t : end);
    const double end_s = std::min(until_s, begin_s + max_hold_s);
    if (!spans.empty() && begin_s <= spans.back().end_s) {
      spans.back().end_s = end_s;
    } else {
      spans.push_back({begin_s, end_s});
    }
  }
  return spans;
}

}  // namespace

OpenlorisSequenceScore score_openloris_sequence(const Trajectory& gt, const Trajectory& est,
                                                const Similarity& S_w_v, const OpenlorisOptions& options) {
  STILLPOINT_CHECK(!gt.poses.empty());
  OpenlorisSequenceScore score;
  score.poses = est.poses.size();
  const Timestamp start = gt.poses.front().t;
  score.gt_duration_s = seconds_between(start, gt.poses.back().t);
  const PoseMatches pairs(gt, est, associate_interpolated(gt, est, options.max_gap_s));
  const MatchView matches = pairs;
  score.matches = matches.size();
  if (matches.empty()) return score;

  const AteErrors errors = ate_errors(matches, S_w_v);
  const std::vector<bool> correct = correct_mask(errors, options.correct);
  score.correct = static_cast<std::size_t>(std::count(correct.begin(), correct.end(), true));
  score.ate_rmse_m = rmse(errors.translation_m);
  score.aoe_rmse_deg = rmse(errors.rotation_deg);
  score.correct_ate_rmse_m = rmse(select(errors.translation_m, correct));
  score.correct_aoe_rmse_deg = rmse(select(errors.rotation_deg, correct));

  const Timestamp end = std::max(gt.poses.back().t, matches.back().t);
  score.tracked_spans = spans_of(matches, correct, gt, options.correct.max_hold_s);
  score.correct_time_s = correct_seconds(matches, errors, end, options.correct);
  score.tracked_time_s = seconds_between(matches.front().t, end);
  score.correct_rate = score.correct_time_s / seconds_between(start, end);
  if (score.tracked_time_s > 0.0) score.tracked_rate = score.correct_time_s / score.tracked_time_s;
  score.relocalization_time_s = std::max(0.0, seconds_between(start, matches.front().t));
  if (correct.front()) {
    score.relocalization_score = std::exp(-*score.relocalization_time_s / kRelocalizationScale);
  }
  return score;
}

Similarity align_openloris(const std::map<int, Trajectory>& gt, const std::map<int, Trajectory>& est,
                           const OpenlorisOptions& options) {
  for (const auto& [number, trajectory] : est) {
    const auto truth = gt.find(number);
    if (truth == gt.end()) continue;
    const PoseMatches matches(truth->second, trajectory,
                              associate_interpolated(truth->second, trajectory, options.max_gap_s));
    if (matches.size() > 0) return align(matches, options.scale ? Alignment::kSim3 : Alignment::kSe3).S_w_v;
  }
  return {};
}

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

namespace {

struct SensorFrame {
  std::string_view name;
  std::array<double, 7> pose;  ///< tx ty tz [m], qx qy qz qw, of the sensor in base_link
};

using RobotFrames = std::array<SensorFrame, 6>;

constexpr RobotFrames kOfficeRobot{{
    {"d400_color",
     {0.2264836849091656, -0.05114194035652147, 0.916, -0.49676229968284136, 0.4998795887129771,
      -0.49510681269354095, 0.5081504289345848}},
    {"d400_depth",
     {0.22722047136786871, -0.06601512576001335, 0.9157872415132173, -0.49538006860636935,
      0.49954735142309487, -0.49840674562280746, 0.5065982108450463}},
    {"d400_imu",
     {0.21545245195759705, -0.07164430142403165, 0.9206998887739904, -0.49538006860636935,
      0.49954735142309487, -0.49840674562280746, 0.5065982108450463}},
    {"t265_fisheye1",
     {0.23757012582874237, -0.038724749600647444, 0.8950755692783204, -0.49597362846259985,
      0.49833071591566835, -0.4958921122758979, 0.5096740825539088}},
    {"t265_fisheye2",
     {0.2379100555955274, -0.10269086731607438, 0.8938944689217037, -0.4925125657739745, 0.4999316027612397,
      -0.4977612079783229, 0.5096406037074316}},
    {"t265_imu",
     {0.23769333650938815, -0.04942265635384921, 0.894903580913328, 0.5030437335657985, 0.49268060367606764,
      0.5074439466966938, 0.4967025929491916}},
}};

constexpr RobotFrames kMarketRobot{{
    {"d400_color",
     {0.398363566676407, 0.029117046016620643, 1.198511534258444, 0.5508509426177262, -0.5167305893488635,
      0.44976770953124534, -0.47671977566632984}},
    {"d400_depth",
     {0.399546294466062, 0.014453458565135675, 1.1984746547500458, 0.5499697614834611, -0.5171593202226934,
      0.4537274051736184, -0.47350917705472384}},
    {"d400_imu",
     {0.38894162200484866, 0.00842158791024528, 1.2052174620767606, 0.5504510403790713, -0.5176133892954977,
      0.4532057328200385, -0.47295305803713444}},
    {"t265_fisheye1",
     {0.873, 0.026, 0.68, -0.3949830160954541, 0.40598254312596027, -0.5999742016639807, 0.5649757065669153}},
    {"t265_fisheye2",
     {0.8696611328664977, -0.03799129213961659, 0.6804951110039751, -0.3919558964011141, 0.40672335425280526,
      -0.6018891254946375, 0.5645140999063238}},
    {"t265_imu",
     {0.8724694754706082, 0.015314402373202411, 0.6801628399570413, 0.4108974443723151, 0.39141685497790646,
      0.5636503288904802, 0.600211998038325}},
}};

const RobotFrames& frames_of(std::string_view scene) {
  for (const std::string_view known : {"office", "corridor", "home", "cafe"}) {
    if (scene == known) return kOfficeRobot;
  }
  if (scene == "market") return kMarketRobot;
  throw InputError("unknown OpenLORIS scene \"" + std::string(scene) +
                   "\"; expected one of: office, corridor, home, cafe, market");
}

}  // namespace

Pose openloris_frame(std::string_view scene, std::string_view frame) {
  const RobotFrames& frames = frames_of(scene);
  if (frame == "base_link") return Pose{};
  std::string known = "base_link";
  for (const SensorFrame& sensor : frames) {
    const std::array<double, 7>& v = sensor.pose;
    if (sensor.name == frame) {
      return Pose{Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized(), {v[0], v[1], v[2]}};
    }
    known += ", " + std::string(sensor.name);
  }
  throw InputError("unknown frame \"" + std::string(frame) + "\"; expected one of: " + known);
}

namespace {

constexpr std::array<const char*, 5> kScenes{"home", "cafe", "corridor", "office", "market"};

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    entries.push_back(entry.path());
  if (error) throw InputError(folder.string(), "cannot list the folder");
  for (const fs::path& entry : entries) require_utf8("file name", entry.filename().string());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Thresholds of the lifelong SLAM challenge (OpenLORIS-Scene tools).
CorrectRateOptions lifelong_thresholds(const std::string& scene, CorrectRateOptions limits) {
  limits.max_translation_m = scene == "office" ? 1.0 : scene == "home" || scene == "cafe" ? 3.0 : 5.0;
  limits.max_rotation_deg = 30.0;
  return limits;
}

/// Accumulates the scores of result files.
class Evaluator {
 public:
  Evaluator(const fs::path& ground_truth, const OpenlorisBenchmarkOptions& options) : options_(options) {
    for (const char* const scene : kScenes) {
      const fs::path file = ground_truth / ("gt_" + std::string(scene) + "_1.txt");
      if (!fs::exists(file)) continue;
      OpenlorisFile truth = read_openloris(file);
      report_repairs(file, truth.repairs);
      std::map<int, double>& durations = evaluation_.benchmark.gt_durations_s[scene];
      for (const auto& [number, path] : truth.sequences) {
        if (path.poses.empty()) throw InputError(file.string(), "ground truth of a sequence has no poses");
        durations[number] = seconds_between(path.poses.front().t, path.poses.back().t);
      }
      truths_.emplace(scene, std::move(truth));
    }
    if (truths_.empty()) throw InputError(ground_truth.string(), "no gt_<scene>_1.txt found");
  }

  void add(const std::string& system, const fs::path& file) {
    const OpenlorisFile result =
        read_openloris(file, options_.keep_repeated_poses ? RepeatedPoses::kKeep : RepeatedPoses::kDrop);
    report_repairs(file, result.repairs);
    const auto truth = truths_.find(result.scene);
    if (truth == truths_.end()) {
      scenes_without_truth_.insert(result.scene);
      return;
    }
    const std::map<int, Trajectory> gt = truth_in_result_frame(truth->second, result);
    const OpenlorisOptions metric = options_for(system, result.scene);
    const Similarity S_w_v = align_openloris(gt, result.sequences, metric);
    std::map<int, OpenlorisRun>& runs = evaluation_.benchmark.systems[system][result.scene].runs;
    for (const auto& [number, est] : result.sequences) {
      const auto path = gt.find(number);
      if (path == gt.end()) {
        throw InputError(file.string(), "sequence " + std::to_string(number) + " is not in the ground truth");
      }
      if (!runs.emplace(number, score_openloris_run(path->second, est, S_w_v, metric)).second) {
        throw InputError(file.string(), "duplicate result for sequence " + std::to_string(number) + " of " +
                                            result.scene + "; expected one file per sequence");
      }
    }
  }

  [[nodiscard]] OpenlorisEvaluation finish() {
    for (auto& [system, scenes] : evaluation_.benchmark.systems) {
      for (const auto& [name, durations] : evaluation_.benchmark.gt_durations_s) {
        OpenlorisScene& scene = scenes[name];
        scene.score = score_openloris_scene(scene.runs, durations);
      }
    }
    for (const std::string& scene : scenes_without_truth_) {
      evaluation_.skipped.push_back("scene \"" + scene + "\": no ground truth, results skipped");
    }
    return std::move(evaluation_);
  }

 private:
  void report_repairs(const fs::path& file, const RowRepairs& repairs) {
    for (const std::string& text : repair_texts(repairs))
      evaluation_.skipped.push_back(file.string() + ": " + text);
  }

  [[nodiscard]] static std::map<int, Trajectory> truth_in_result_frame(const OpenlorisFile& truth,
                                                                       const OpenlorisFile& result) {
    const Pose T_base_gt = openloris_frame(result.scene, truth.frame);
    const Pose T_base_sensor = openloris_frame(result.scene, result.frame);
    std::map<int, Trajectory> moved;
    for (const auto& [number, path] : truth.sequences) {
      if (!result.sequences.contains(number)) continue;
      moved[number] = move_to_frame(path, T_base_gt.inverse() * T_base_sensor, result.frame);
    }
    return moved;
  }

  [[nodiscard]] OpenlorisOptions options_for(const std::string& system, const std::string& scene) const {
    OpenlorisOptions metric = options_.metric;
    const std::vector<std::string>& scaled = options_.scaled_systems;
    if (std::find(scaled.begin(), scaled.end(), system) != scaled.end()) metric.scale = true;
    if (options_.lifelong_thresholds) metric.correct = lifelong_thresholds(scene, metric.correct);
    return metric;
  }

  const OpenlorisBenchmarkOptions& options_;
  std::map<std::string, OpenlorisFile> truths_;
  OpenlorisEvaluation evaluation_;
  std::set<std::string> scenes_without_truth_;
};

}  // namespace

OpenlorisEvaluation evaluate_openloris(const fs::path& results, const fs::path& ground_truth,
                                       const OpenlorisBenchmarkOptions& options) {
  Evaluator evaluator(ground_truth, options);
  bool found = false;
  for (const fs::path& folder : sorted_entries(results)) {
    if (!fs::is_directory(folder)) continue;
    for (const fs::path& file : sorted_entries(folder)) {
      if (file.extension() != ".txt") continue;
      evaluator.add(folder.filename().string(), file);
      found = true;
    }
  }
  if (!found) {
    throw InputError(results.string(),
                     "no results found; expected one subfolder per system with *.txt files");
  }
  return evaluator.finish();
}

}  // namespace stillpoint::eval
