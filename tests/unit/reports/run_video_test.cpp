// SPDX-License-Identifier: BSD-3-Clause
#include "reports/run_video.h"

#include <gtest/gtest.h>

#include <opencv2/videoio.hpp>

#include "datasets/image_io.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/picture_of_run.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

int frames_in(cv::VideoCapture& video) {
  int frames = 0;
  for (cv::Mat picture; video.read(picture);) ++frames;
  return frames;
}

TEST(RunVideo, WritesEachPictureAndAVideoOfThemAll) {
  const TemporaryFolder folder;
  RunVideo video(folder.path() / "out", {}, 25.0);
  for (int i = 0; i < 12; ++i) video.add(PictureOfRun(i).report());
  video.finish();
  EXPECT_EQ(read_picture(folder.path() / "out" / "frames" / "000011.jpg").size(), cv::Size(160, 120));
  cv::VideoCapture written((folder.path() / "out" / "video.mp4").string());
  ASSERT_TRUE(written.isOpened());
  EXPECT_NEAR(written.get(cv::CAP_PROP_FPS), 25.0, 0.01);
  EXPECT_EQ(frames_in(written), 12);
}

TEST(RunVideo, LeavesOutTheLastColumnOfAnOddPicture) {
  const TemporaryFolder folder;
  RunVideo video(folder.path(), {}, 30.0);
  for (int i = 0; i < 3; ++i) video.add(PictureOfRun(i, {161, 120}).report());
  video.finish();
  cv::VideoCapture written((folder.path() / "video.mp4").string());
  EXPECT_EQ(written.get(cv::CAP_PROP_FRAME_WIDTH), 160.0);
}

TEST(RunVideo, RefusesAFolderThatIsAFile) {
  const TemporaryFolder folder;
  folder.write("out", "not a folder");
  EXPECT_THROW(RunVideo(folder.path() / "out", {}, 30.0), InputError);
}

TEST(RunVideo, WithoutPicturesThereIsNoVideo) {
  const TemporaryFolder folder;
  RunVideo(folder.path(), {}, 30.0).finish();
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "video.mp4"));
}

TEST(RunVideo, MeanRateIsThatOfTheIntervals) {
  // Two intervals in 0.08 s.
  EXPECT_NEAR(mean_rate_hz({from_seconds(1.0), from_seconds(1.03), from_seconds(1.08)}), 25.0, 1e-6);
  EXPECT_EQ(mean_rate_hz({from_seconds(1.0)}), 30.0);
}

}  // namespace
}  // namespace stillpoint
