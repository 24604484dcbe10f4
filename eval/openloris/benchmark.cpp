// SPDX-License-Identifier: BSD-3-Clause
#include "eval/openloris/benchmark.h"

#include <algorithm>
#include <array>
#include <set>

#include "core/base/error.h"
#include "eval/io/openloris_file.h"
#include "eval/openloris/robot_frames.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

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
