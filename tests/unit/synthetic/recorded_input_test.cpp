// SPDX-License-Identifier: BSD-3-Clause
// Sequences rendered along recorded trajectories and at recorded frame times.
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace stillpoint::synth {
namespace {

SynthRequest tiny_request(const std::string& preset) {
  SynthRequest request = preset_request(preset);
  request.width = 80;
  request.height = 60;
  request.focal_px = 67.0;
  request.seconds = 0.2;
  return request;
}

/// Sequence 2 of a market: 0.5 m/s along x for 5 s, at 40 Hz, from time 100 s on.
std::filesystem::path write_track(const TemporaryFolder& folder) {
  std::string text = "scene: market\nframe: base_link\n\nseq: 2\n";
  for (int i = 0; i <= 200; ++i) text += fmt::format("{} {} 0 0 0 0 0 1\n", 100.0 + 0.025 * i, 0.0125 * i);
  return folder.write("gt_market_1.txt", text);
}

TEST(RecordedTimes, AreThoseOfTheImages) {
  const TemporaryFolder folder;
  SynthRequest request = tiny_request("walking_static_empty");
  request.layout = SequenceLayout::kTum;
  // The second interval contains a lost frame; the last line is after the end of the sequence.
  request.times_file = folder.write("times.txt",
                                    "# color depth\n"
                                    "1341846313.592026 rgb/1.png 1341846313.592088 depth/1.png\n"
                                    "1341846313.622026 rgb/2.png 1341846313.622100 depth/2.png\n"
                                    "1341846313.689000 rgb/3.png 1341846313.689000 depth/3.png\n"
                                    "1341846313.793000 rgb/4.png 1341846313.793000 depth/4.png\n");
  ASSERT_TRUE(render_sequence(request, folder.path() / "sequence"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "sequence/rgb/1341846313.592026.png"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "sequence/depth/1341846313.592088.png"));
  const auto stream = datasets::open_sequence(folder.path() / "sequence");
  EXPECT_EQ(stream->info().frame_times,
            (std::vector<Timestamp>{{1341846313592026000}, {1341846313622026000}, {1341846313689000000}}));
}

TEST(RecordedTimes, AreRejectedWithTheirLine) {
  const TemporaryFolder folder;
  const auto load = [](const std::filesystem::path& file) {
    static_cast<void>(load_recorded_times(file, 1.0));
  };
  expect_input_error([&] { load(folder.write("a", "1.0\nsoon\n")); }, {"a:2", "soon"});
  expect_input_error([&] { load(folder.write("b", "1.5\n1.5\n")); }, {"b:2", "does not increase"});
  expect_input_error([&] { load(folder.write("c", "# nothing\n")); }, {"contains no time"});
  expect_input_error([&] { load(folder.path() / "missing"); }, {"cannot be read"});
}

TEST(RecordedTrack, TheCameraFollowsTheRobot) {
  const TemporaryFolder folder;
  SynthRequest request = tiny_request("track");
  request.trajectory_file = write_track(folder);
  request.track_sequence = 2;
  request.seconds = 2.0;
  request.start_s = 1.0;
  const SceneSetup setup = make_scene_setup(request);
  EXPECT_EQ(setup.epoch, (Timestamp{101'000'000'000}));
  const auto camera_at = [&](double t_s) { return (setup.body_path.pose_at(t_s) * setup.rig.T_b_c).p; };
  // 1 s at 0.5 m/s; the vibration of the robot is below 5 mm.
  EXPECT_NEAR((camera_at(1.5) - camera_at(0.5)).x(), 0.5, 0.01);
  // The base is at 0.5 m/s * (1 s + 0.5 s) = 0.75 m, the camera of the robot of market 0.4 m in front of it.
  EXPECT_NEAR(camera_at(0.5).x(), 1.15, 0.02);
  EXPECT_NEAR(camera_at(0.5).z(), 1.2, 0.02);
}

TEST(RecordedTrack, MissingInputIsNamed) {
  const TemporaryFolder folder;
  SynthRequest request = tiny_request("track");
  expect_input_error([&] { check_request(request); }, {"track", "--trajectory", "--track-sequence"});
  request.trajectory_file = write_track(folder);
  request.track_sequence = 1;
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); }, {"sequence 1", "is missing"});
  request.track_sequence = 2;
  request.seconds = 4.5;
  request.start_s = 1.0;
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); },
                     {"5.0 s", "--seconds or --start"});
}

/// A camera that looks along +x of the motion capture system, 0.4 m/s along y, at 100 Hz from time 50 s on, 6
/// s.
std::filesystem::path write_hand_recording(const TemporaryFolder& folder) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i <= 600; ++i)
    text += fmt::format("{:.4f} 7 {:.4f} 1.4 -0.5 0.5 -0.5 0.5\n", 50.0 + 0.01 * i, 0.004 * i);
  return folder.write("groundtruth.txt", text);
}

TEST(HandRecording, TheCameraMovesAsRecordedAtTheRecordedTimes) {
  const TemporaryFolder folder;
  SynthRequest request = tiny_request("fr3");
  request.trajectory_file = write_hand_recording(folder);
  request.times_file = folder.write("times.txt", "49.9\n50.4\n50.52\n50.56\n52.5\n");
  request.seconds = 2.0;
  check_request(request);
  const SceneSetup setup = make_scene_setup(request);
  // The first frame is the first one at least 0.5 s after the first pose.
  const FrameTimes times = frame_times(request, setup);
  EXPECT_EQ(times.color, (std::vector<Timestamp>{{50'520'000'000}, {50'560'000'000}, {52'500'000'000}}));
  const auto camera_at = [&](Timestamp t) {
    return setup.body_path.pose_at(seconds_between(setup.epoch, t)) * setup.rig.T_b_c;
  };
  const Pose first = camera_at(times.color.front()), last = camera_at(times.color.back());
  // 0.4 m/s for 1.98 s to the left of a camera that looks ahead; the attitude is constant.
  const Eigen::Vector3d moved = first.q.conjugate() * (last.p - first.p);
  EXPECT_NEAR((moved - Eigen::Vector3d(-0.792, 0.0, 0.0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR(first.q.angularDistance(last.q), 0.0, 1e-3);
  // The camera looks from the mean position of the office towards its desks.
  const Viewpoint& view = setup.scene.viewpoint;
  EXPECT_NEAR(first.p.z(), view.eye_w.z(), 1e-3);
  const Eigen::Vector3d axis = first.q * Eigen::Vector3d::UnitZ();
  EXPECT_GT(axis.head<2>().dot((view.target_w - view.eye_w).head<2>().normalized()), 0.999);
}

TEST(HandRecording, MissingInputIsNamed) {
  const TemporaryFolder folder;
  SynthRequest request = tiny_request("fr3");
  expect_input_error([&] { check_request(request); }, {"fr3", "--trajectory"});
  request = tiny_request("fr3_walking_xyz");
  request.trajectory_file = "/none/groundtruth.txt";
  expect_input_error([&] { check_request(request); },
                     {"fr3_walking_xyz", "/none/groundtruth.txt", "STILLPOINT_DATA"});
  request.trajectory_file = write_hand_recording(folder);
  request.times_file.clear();
  request.seconds = 6.0;
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); },
                     {"poses of 6.0 s, but 6.0 s from 0.5 s on", "--seconds or --start"});
}

TEST(HandRecording, TheSequencesOfTumAreSmoothedWithinTheNoiseOfMotionCapture) {
  for (const std::string name : {"fr3_walking_xyz", "fr3_walking_static", "fr3_walking_rpy",
                                 "fr3_walking_halfsphere", "fr3_sitting_static"}) {
    const std::string trajectory = "tum_fr3_groundtruth/" + name + "_groundtruth.txt";
    const std::string times = "tum_fr3_times/" + name + ".txt";
    if (!find_test_data(trajectory) || !find_test_data(times)) GTEST_SKIP() << missing_test_data(trajectory);
    SynthRequest request = preset_request(name);
    request.trajectory_file = *find_test_data(trajectory);
    request.times_file = *find_test_data(times);
    request.seconds = 20.0;
    const SceneSetup setup = make_scene_setup(request);
    FaultLog faults;
    const Trajectory truth =
        eval::read_tum_ground_truth(request.trajectory_file, "camera", faults).trajectory;
    // World of the office to that of motion capture, by the first pose.
    std::optional<Pose> T_w_m;
    double squared = 0.0, acceleration = 0.0;
    int count = 0;
    for (const StampedPose& pose : truth.poses) {
      const double t_s = seconds_between(setup.epoch, pose.t);
      if (t_s < 0.0 || t_s > 20.0) continue;
      const Pose camera = setup.body_path.pose_at(t_s) * setup.rig.T_b_c;
      if (!T_w_m) T_w_m = camera * pose.T_w_f.inverse();
      squared += (camera.p - (*T_w_m * pose.T_w_f).p).squaredNorm();
      acceleration += setup.body_path.at(t_s).acceleration_w.squaredNorm();
      ++count;
    }
    EXPECT_LT(std::sqrt(squared / count), 0.003)
        << name;  // measured: 0.0001 to 0.0011, with that of the first pose
    EXPECT_LT(std::sqrt(acceleration / count), 2.0) << name;  // measured: 0.4 to 0.9 m/s^2
  }
}

TEST(RecordedInput, ChangesTheKeyOfASequenceOnlyIfItIsSet) {
  const SynthRequest plain = preset_request("walking_xyz");
  EXPECT_EQ(request_text(plain).find("times_file"), std::string::npos);
  EXPECT_EQ(request_text(plain).find("track_sequence"), std::string::npos);
  const TemporaryFolder folder;
  SynthRequest timed = plain;
  timed.times_file = folder.write("times.txt", "1.0\n");
  EXPECT_NE(request_key(timed), request_key(plain));
}

}  // namespace
}  // namespace stillpoint::synth
