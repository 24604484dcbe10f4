// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/request_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "datasets/io/image_io.h"
#include "datasets/open_sequence.h"
#include "tests/support/folder_contents.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

SynthRequest small_request(const std::string& preset) {
  SynthRequest request = preset_request(preset);
  request.width = 160;
  request.height = 120;
  request.focal_px = 134.0;
  request.seconds = 0.2;  // 6 frames
  return request;
}

fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(STILLPOINT_BINARY_DIR) / "tests" / "synthetic" / name;
  fs::remove_all(folder);
  fs::create_directories(folder.parent_path());
  return folder;
}

TEST(RenderSequence, OutputIsIdenticalOnOneAndTwoThreads) {
  const fs::path one = fresh_folder("one_thread"), two = fresh_folder("two_threads");
  ASSERT_TRUE(render_sequence(small_request("walking_rpy"), one, {.threads = 1}));
  ASSERT_TRUE(render_sequence(small_request("walking_rpy"), two, {.threads = 2}));
  EXPECT_EQ(folder_contents(one), folder_contents(two));
}

TEST(RenderSequence, DifferentSeedsGiveDifferentImages) {
  const fs::path one = fresh_folder("seed_one"), two = fresh_folder("seed_two");
  SynthRequest request = small_request("walking_xyz");
  ASSERT_TRUE(render_sequence(request, one));
  request.seed = 2;
  ASSERT_TRUE(render_sequence(request, two));
  const std::string first = "color/1700000000.050000.png";
  EXPECT_NE(folder_contents(one).at(first), folder_contents(two).at(first));
}

TEST(RenderSequence, OpenLorisFoldersCanBeOpened) {
  const fs::path folder = fresh_folder("openloris");
  const SynthRequest request = small_request("walking_xyz_empty");
  ASSERT_TRUE(render_sequence(request, folder));
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(folder);
  const datasets::SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "openloris");
  ASSERT_EQ(info.frame_times.size(), 6U);
  EXPECT_EQ(info.frame_times[1].ns - info.frame_times[0].ns, 33333000);  // whole microseconds
  EXPECT_DOUBLE_EQ(info.rig.camera.fx, 134.0);
  EXPECT_TRUE(info.rig.has_imu);
  EXPECT_LT((info.rig.T_b_c.matrix() - realsense_T_b_c().matrix()).norm(), 1e-6);
  EXPECT_NEAR(info.rig.imu_noise.gyro_noise, 1.8e-4, 1e-9);
  EXPECT_GT(info.imu.size(), 90U);  // 0.3 s at 400 Hz, minus samples outside the accelerometer's interval
  EXPECT_GE(info.ground_truth.trajectory.poses.size(), 60U);
  const Frame frame = stream->load_frame(3);
  EXPECT_EQ(frame.color.size(), cv::Size(160, 120));
  EXPECT_GT(cv::countNonZero(frame.depth), 160 * 120 * 3 / 4);
}

TEST(RenderSequence, GroundTruthContainsAPoseAtTheTimeOfEachFrame) {
  const fs::path folder = fresh_folder("truth_times");
  ASSERT_TRUE(render_sequence(small_request("walking_rpy_empty"), folder));
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(folder);
  const std::vector<StampedPose>& truth = stream->info().ground_truth.trajectory.poses;
  const std::vector<Timestamp>& frames = stream->info().frame_times;
  ASSERT_EQ(frames.size(), 6U);
  for (const Timestamp t : frames) {
    EXPECT_EQ(std::count_if(truth.begin(), truth.end(), [t](const StampedPose& pose) { return pose.t == t; }),
              1)
        << t.ns;
  }
  EXPECT_TRUE(std::is_sorted(truth.begin(), truth.end(),
                             [](const StampedPose& a, const StampedPose& b) { return a.t < b.t; }));
  // 200 Hz over 0.05 + 0.2 + 0.05 s are 61 poses; frames 0 and 3, at 0.05 and 0.15 s, are two of them.
  EXPECT_EQ(truth.size(), 61U + 4U);
}

TEST(RenderSequence, TumFoldersCanBeOpened) {
  const fs::path folder = fresh_folder("tum");
  SynthRequest request = small_request("walking_static_empty");
  request.layout = SequenceLayout::kTum;
  ASSERT_TRUE(render_sequence(request, folder));
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(folder);
  EXPECT_EQ(stream->info().format, "tum");
  EXPECT_EQ(stream->info().frame_times.size(), 6U);
  EXPECT_DOUBLE_EQ(stream->info().rig.camera.fy, 134.0);
  EXPECT_EQ(stream->load_frame(0).depth_units_per_m, 1000.0);
}

/// Every edge of a true box touches labeled pixels.
TEST(RenderSequence, TrueBoxesEncloseTheLabels) {
  const fs::path folder = fresh_folder("labels");
  SynthRequest request = small_request("walking_xyz");
  request.labels = true;
  ASSERT_TRUE(render_sequence(request, folder));
  std::ifstream boxes(folder / "true_boxes.txt");
  int checked = 0;
  for (std::string line; std::getline(boxes, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    std::string stamp, name;
    double score = 0.0, x_min = 0.0, y_min = 0.0, x_max = 0.0, y_max = 0.0;
    if (!(fields >> stamp >> name >> score >> x_min >> y_min >> x_max >> y_max))
      continue;  // no visible object
    const std::string image_name =
        stamp.substr(0, stamp.size() - 3) + ".png";  // file names are in microseconds
    const cv::Mat labels = datasets::read_image(folder / "labels" / image_name);
    const cv::Mat motion = datasets::read_image(folder / "motion" / image_name);
    EXPECT_EQ(cv::countNonZero(motion & (labels == 0)), 0) << line;  // static pixels have zero speed
    const cv::Rect box(cv::Point(cvRound(x_min + 0.5), cvRound(y_min + 0.5)),
                       cv::Point(cvRound(x_max + 0.5), cvRound(y_max + 0.5)));
    const cv::Mat inside = labels(box);
    EXPECT_GT(cv::countNonZero(inside.row(0)), 0) << line;
    EXPECT_GT(cv::countNonZero(inside.row(inside.rows - 1)), 0) << line;
    EXPECT_GT(cv::countNonZero(inside.col(0)), 0) << line;
    EXPECT_GT(cv::countNonZero(inside.col(inside.cols - 1)), 0) << line;
    ++checked;
  }
  EXPECT_GE(checked, 6);
  EXPECT_TRUE(fs::exists(folder / "detections.txt"));
}

TEST(RenderSequence, AStaticSceneHasASetWithoutBoxesForEachFrame) {
  const fs::path folder = fresh_folder("static_boxes");
  SynthRequest request = small_request("walking_xyz_empty");
  request.detector.false_positive_rate = 1.0;
  ASSERT_TRUE(render_sequence(request, folder));
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(folder);
  for (const auto* sets : {&stream->info().detections, &stream->info().true_boxes}) {
    ASSERT_EQ(sets->size(), 6U);
    for (const DetectionSet& set : *sets) EXPECT_TRUE(set.detections.empty());
  }
}

TEST(RenderSequence, DroppedFramesAreMissingFromListsAndFolders) {
  const fs::path folder = fresh_folder("dropped");
  SynthRequest request = small_request("walking_static_empty");
  request.seconds = 2.0;
  request.dropped_fraction = 0.3;
  ASSERT_TRUE(render_sequence(request, folder));
  const std::size_t frames = datasets::open_sequence(folder)->info().frame_times.size();
  EXPECT_LT(frames, 56U);
  EXPECT_GT(frames, 25U);
}

TEST(RenderSequence, RollingShutterSkewsImagesOfARotatingCamera) {
  SynthRequest request = small_request("walking_rpy_empty");
  const fs::path global = fresh_folder("global"), rolling = fresh_folder("rolling");
  ASSERT_TRUE(render_sequence(request, global));
  request.rolling_shutter_s = 0.03;
  ASSERT_TRUE(render_sequence(request, rolling));
  const cv::Mat a = datasets::open_sequence(global)->load_frame(5).gray,
                b = datasets::open_sequence(rolling)->load_frame(5).gray;
  const auto difference = [&](int row) { return cv::norm(a.row(row), b.row(row), cv::NORM_L1) / a.cols; };
  // The timestamp refers to the middle row, where both images agree (the sensor noise is identical).
  EXPECT_LT(difference(60), 1.0);
  EXPECT_GT(difference(2), 2.0 * difference(60));
}

TEST(RenderSequence, MarketAndCorridorCanBeRendered) {
  for (const std::string preset : {"market", "corridor"}) {
    const fs::path folder = fresh_folder(preset);
    ASSERT_TRUE(render_sequence(small_request(preset), folder));
    EXPECT_EQ(datasets::open_sequence(folder)->info().frame_times.size(), 6U);
  }
}

TEST(RenderSequence, LeavesNoFilesWhenStopped) {
  const fs::path folder = fresh_folder("stopped");
  int frames = 0;
  RenderControl control{.progress = [&](int done, int) { frames = done; },
                        .stop_requested = [&] { return frames >= 2; },
                        .threads = 1};
  EXPECT_FALSE(render_sequence(small_request("walking_xyz_empty"), folder, control));
  EXPECT_EQ(frames, 2);
  for (const auto& entry : fs::directory_iterator(folder.parent_path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("stopped")) << entry.path();
  }
}

TEST(RenderSequence, NeverOverwritesAnExistingFolder) {
  const fs::path folder = fresh_folder("taken");
  fs::create_directories(folder);
  EXPECT_THROW(render_sequence(small_request("walking_xyz_empty"), folder), InputError);
}

TEST(RenderSequence, RejectsInvalidRequests) {
  SynthRequest request = small_request("walking_xyz_empty");
  request.color.exposure_s = 0.05;  // longer than a frame at 30 Hz
  EXPECT_THROW(render_sequence(request, fresh_folder("rejected")), InputError);
  EXPECT_THROW(preset_request("walking"), InputError);
  EXPECT_THROW(render_sequence(small_request("flight"), fresh_folder("rejected")), InputError);
}

}  // namespace
}  // namespace stillpoint::synth
