// SPDX-License-Identifier: BSD-3-Clause
// Sequences rendered along recorded trajectories and at recorded frame times.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

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
