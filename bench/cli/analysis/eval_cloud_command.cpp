// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint eval cloud`: compares the point cloud of a run with that of the true surfaces.
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/analysis/pose_files.h"
#include "bench/cli/command_line.h"
#include "core/base/error.h"
#include "eval/io/ply_file.h"
#include "eval/metrics/cloud_distance.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::bench {
namespace {

/// F-score below which two clouds are probably of different worlds.
constexpr double kLeastAgreement = 0.1;

struct EvalCloudArguments {
  std::string estimate, truth;
  std::string trajectory, true_trajectory;
  double threshold_m = 0.05;
  bool json = false;
};

/// The transform from the world of the estimate to that of the truth, by the trajectories.
Pose world_alignment(const EvalCloudArguments& arguments) {
  if (arguments.trajectory.empty() != arguments.true_trajectory.empty())
    throw InputError("--trajectory", "requires --truth-trajectory, and the reverse");
  if (arguments.trajectory.empty()) return {};
  const std::vector<PoseFile> files = with_consistent_orders(
      read_pose_files({.ground_truth = arguments.true_trajectory, .estimates = {arguments.trajectory}}), 0.0);
  const std::vector<eval::MatchedPose> matches =
      eval::strict_matches(files[0].loaded.trajectory, files[1].loaded.trajectory);
  if (matches.empty())
    throw InputError(arguments.trajectory, "has no poses at times of " + arguments.true_trajectory);
  return eval::align_worlds(matches);
}

std::vector<Eigen::Vector3f> points_of(const std::string& file, const Pose& T) {
  std::vector<Eigen::Vector3f> points;
  for (const eval::CloudPoint& point : eval::read_ply(file))
    points.push_back((T * point.p.cast<double>()).cast<float>());
  return points;
}

int evaluate_cloud(const EvalCloudArguments& arguments) {
  const std::vector<Eigen::Vector3f> estimate = points_of(arguments.estimate, world_alignment(arguments));
  const std::vector<Eigen::Vector3f> truth = points_of(arguments.truth, {});
  const eval::CloudScore score = eval::score_cloud(estimate, truth, arguments.threshold_m);
  if (arguments.json) {
    const nlohmann::ordered_json json = {{"schema", 1},
                                         {"threshold_m", arguments.threshold_m},
                                         {"estimate_points", score.estimate_points},
                                         {"truth_points", score.truth_points},
                                         {"accuracy_m", score.accuracy_m},
                                         {"accuracy_median_m", score.accuracy_median_m},
                                         {"precision", score.precision},
                                         {"completeness", score.completeness},
                                         {"f_score", score.f_score}};
    std::cout << json.dump(2) << '\n';
    return kExitOk;
  }
  std::cout << fmt::format(
      "accuracy      {:.4f} m (median {:.4f} m)\nprecision     {:.2f} % within {:g} m\n"
      "completeness  {:.2f} %\nF-score       {:.4f}\npoints        {} of the estimate, {} of the truth\n",
      score.accuracy_m, score.accuracy_median_m, 100.0 * score.precision, arguments.threshold_m,
      100.0 * score.completeness, score.f_score, score.estimate_points, score.truth_points);
  if (arguments.trajectory.empty() && score.f_score < kLeastAgreement)
    spdlog::warn(
        "the clouds hardly agree: if they are of different worlds, as a map and a ground truth are, add "
        "--trajectory and --truth-trajectory");
  return kExitOk;
}

}  // namespace

Command eval_cloud_command() {
  const auto arguments = std::make_shared<EvalCloudArguments>();
  EvalCloudArguments& a = *arguments;
  return {
      .name = "cloud",
      .summary = "Compare two point clouds (.ply): accuracy, precision, completeness, F-score",
      .example =
          "eval cloud map.ply truth.ply --trajectory out/trajectory.tum --truth-trajectory groundtruth.txt",
      .options = {{"EST", "Point cloud of the estimate, as written by `run --map-cloud`", &a.estimate},
                  {"GT", "Point cloud of the true surfaces, as written by `data cloud`", &a.truth},
                  {"--threshold", "Distance of points that agree [0.05 m]", &a.threshold_m, {1e-6, 1e3}},
                  {"--trajectory",
                   "Trajectory of the estimate, to align its world with that of GT [the same world]",
                   &a.trajectory},
                  {"--truth-trajectory", "Ground truth of that trajectory, in the world of GT",
                   &a.true_trajectory},
                  {"--json", "Print JSON with full precision", &a.json}},
      .action = [arguments] { return evaluate_cloud(*arguments); }};
}

}  // namespace stillpoint::bench
