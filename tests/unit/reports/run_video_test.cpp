// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/annotated_frames.h"

#include <gtest/gtest.h>

#include <opencv2/videoio.hpp>

#include "datasets/io/image_io.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/fake_frame_report.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

int frames_in(cv::VideoCapture& video) {
  int frames = 0;
  for (cv::Mat image; video.read(image);) ++frames;
  return frames;
}

TEST(RunVideo, WritesEachFrameAndAVideo) {
  const TemporaryFolder folder;
  RunVideo video(folder.path() / "out", {}, 25.0);
  for (int i = 0; i < 12; ++i) video.add(FakeFrameReport(i).report());
  video.finish();
  EXPECT_EQ(datasets::read_image(folder.path() / "out" / "frames" / "000011.jpg").size(), cv::Size(160, 120));
  cv::VideoCapture written((folder.path() / "out" / "video.mp4").string());
  ASSERT_TRUE(written.isOpened());
  EXPECT_NEAR(written.get(cv::CAP_PROP_FPS), 25.0, 0.01);
  EXPECT_EQ(frames_in(written), 12);
}

TEST(RunVideo, CropsTheLastColumnOfOddWidths) {
  const TemporaryFolder folder;
  RunVideo video(folder.path(), {}, 30.0);
  for (int i = 0; i < 3; ++i) video.add(FakeFrameReport(i, {161, 120}).report());
  video.finish();
  cv::VideoCapture written((folder.path() / "video.mp4").string());
  EXPECT_EQ(written.get(cv::CAP_PROP_FRAME_WIDTH), 160.0);
}

TEST(RunVideo, RejectsAFolderThatIsAFile) {
  const TemporaryFolder folder;
  folder.write("out", "not a folder");
  EXPECT_THROW(RunVideo(folder.path() / "out", {}, 30.0), InputError);
}

TEST(RunVideo, WritesNoVideoWithoutFrames) {
  const TemporaryFolder folder;
  RunVideo(folder.path(), {}, 30.0).finish();
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "video.mp4"));
}

TEST(RunVideo, MeanRateIsComputedFromTheIntervals) {
  // Two intervals in 0.08 s.
  EXPECT_NEAR(mean_rate_hz({from_seconds(1.0), from_seconds(1.03), from_seconds(1.08)}), 25.0, 1e-6);
  EXPECT_EQ(mean_rate_hz({from_seconds(1.0)}), 30.0);
}

}  // namespace
}  // namespace stillpoint::report
