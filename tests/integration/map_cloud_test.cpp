// SPDX-License-Identifier: BSD-3-Clause
// `run --map-cloud`, `data cloud` and `eval cloud`: the map of a room with five walking people against the
// rendered room without them.
#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/open_sequence.h"
#include "datasets/sensor_stream.h"
#include "eval/io/ply_file.h"
#include "eval/io/trajectory_file.h"
#include "eval/metrics/cloud_distance.h"
#include "eval/metrics/rpe.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

void execute(const std::vector<std::string>& arguments) {
  const ProgramResult result = run_program(arguments);
  ASSERT_EQ(result.exit_code, 0) << arguments.front() << " " << arguments[1] << ": " << result.err;
}

void render(const std::string& preset, const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"data",     "synth", preset,      "--width", "320",
                                        "--height", "240",   "--focal",   "210",     "--seconds",
                                        "5",        "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  execute(arguments);
}

/// Points on people: those that are not at a true surface, but where a person was seen in some frame.
std::size_t points_on_people(const fs::path& sequence, const std::vector<Eigen::Vector3f>& cloud,
                             const std::vector<Eigen::Vector3f>& truth) {
  const auto stream = datasets::open_sequence(sequence, {});
  const datasets::SequenceInfo& info = stream->info();
  Trajectory frames;
  for (const Timestamp t : info.frame_times) frames.poses.push_back({t, {}});
  std::vector<Eigen::Vector3f> people;
  for (const eval::MatchedPose& match : eval::strict_matches(info.ground_truth.trajectory, frames)) {
    const auto index = static_cast<std::size_t>(std::ranges::lower_bound(info.frame_times, match.t) -
                                                info.frame_times.begin());
    if (index % 3 != 0) continue;
    const Frame frame = stream->load_frame(index);
    const auto labels = stream->load_labels(index);
    for (int row = 0; row < frame.depth.rows; row += 4) {
      for (int column = 0; column < frame.depth.cols; column += 4) {
        const double depth = frame.depth.at<std::uint16_t>(row, column) / frame.depth_units_per_m;
        if (depth <= 0.0 || labels->object.at<std::uint8_t>(row, column) == 0) continue;
        const Eigen::Vector2d bearing = info.rig.camera.unproject(Eigen::Vector2d(column, row));
        people.push_back((match.gt * Eigen::Vector3d(depth * bearing.homogeneous())).cast<float>());
      }
    }
  }
  EXPECT_GT(people.size(), 10'000U);
  const eval::PointTree surfaces(truth), persons(people);
  return static_cast<std::size_t>(std::ranges::count_if(cloud, [&](const Eigen::Vector3f& point) {
    return surfaces.distance(point) > 0.05 && persons.distance(point) < 0.05;
  }));
}

std::vector<Eigen::Vector3f> points_in_truth(const fs::path& cloud, const Pose& T) {
  std::vector<Eigen::Vector3f> points;
  for (const eval::CloudPoint& point : eval::read_ply(cloud))
    points.push_back((T * point.p.cast<double>()).cast<float>());
  return points;
}

TEST(MapCloud, TheMapOfARoomWithFiveWalkersIsThatOfTheEmptyRoom) {
  const TemporaryFolder folder;
  const fs::path walkers = folder.path() / "walkers", empty = folder.path() / "empty";
  const std::string map = (folder.path() / "map.ply").string(),
                    truth = (folder.path() / "truth.ply").string();
  render("walking_xyz", walkers, {"--people", "5", "--seated", "0", "--unknown", "0", "--labels"});
  render("walking_xyz_empty", empty, {"--depth-noise", "0"});
  execute({"run", walkers.string(), "--out", (folder.path() / "run").string(), "--map-cloud", map});
  execute({"data", "cloud", empty.string(), "--voxel", "0.01", "--min-images", "1", "--out", truth});
  const std::string trajectory = (folder.path() / "run" / "trajectory.tum").string();
  const std::string true_trajectory = (walkers / "groundtruth.txt").string();
  const ProgramResult result = run_program({"eval", "cloud", map, truth, "--trajectory", trajectory,
                                            "--truth-trajectory", true_trajectory, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json score = nlohmann::json::parse(result.out);
  EXPECT_LE(score["accuracy_m"], 0.01) << score.dump(1);
  EXPECT_GE(score["completeness"], 0.90) << score.dump(1);
  const Trajectory gt = eval::read_trajectory({.path = true_trajectory}).trajectory;
  const Trajectory est = eval::read_trajectory({.path = trajectory}).trajectory;
  const Pose T = eval::align_worlds(eval::strict_matches(gt, est));
  const std::vector<Eigen::Vector3f> cloud = points_in_truth(map, T);
  const std::size_t on_people = points_on_people(walkers, cloud, points_in_truth(truth, {}));
  EXPECT_LE(static_cast<double>(on_people), 0.001 * static_cast<double>(cloud.size()))
      << on_people << " of " << cloud.size() << " points";
  EXPECT_EQ(
      run_program({"run", walkers.string(), "--out", (folder.path() / "again").string(), "--map-cloud", map})
          .exit_code,
      2);  // the file exists
}

// A run that starts in the middle of the recording is located in a saved map: its own world is a quarter of
// a meter off, its optimized poses are those of the map.
TEST(MapCloud, WithLoopClosureItIsThatOfTheOptimizedTrajectory) {
  const TemporaryFolder folder;
  const fs::path sequence = folder.path() / "walk";
  render("walking_xyz_empty", sequence, {});
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"run",         sequence.string(),
                                          "--out",       (folder.path() / name).string(),
                                          "--variant",   "vo+ablations/loop_closure",
                                          "--set",       "loop.min_translation_m=0.05",
                                          "--map-cloud", (folder.path() / (name + ".ply")).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    execute(arguments);
    return points_in_truth(folder.path() / (name + ".ply"), {});
  };
  const std::string map = (folder.path() / "room.map").string();
  const std::vector<Eigen::Vector3f> whole = run("whole", {"--save-map", map});
  const std::vector<Eigen::Vector3f> part = run("part", {"--map", map, "--start", "2"});
  const auto first_position = [&](const char* file) {
    const fs::path path = folder.path() / "part" / file;
    return eval::read_trajectory({.path = path}).trajectory.poses.front().T_w_f.p;
  };
  ASSERT_GT((first_position("trajectory_optimized.tum") - first_position("trajectory.tum")).norm(), 0.1);
  ASSERT_GT(part.size(), whole.size() / 2);
  const eval::PointTree tree(whole);
  const auto near =
      std::ranges::count_if(part, [&](const Eigen::Vector3f& point) { return tree.distance(point) < 0.02; });
  EXPECT_GT(static_cast<double>(near), 0.95 * static_cast<double>(part.size()));
}

}  // namespace
}  // namespace stillpoint
