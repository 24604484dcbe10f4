// SPDX-License-Identifier: BSD-3-Clause
#include "reports/worst_pictures.h"

#include <set>

#include <gtest/gtest.h>

#include "datasets/image_io.h"
#include "tests/support/picture_of_run.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// Five pictures, ten a second, of a camera that stands still.
SequenceInfo standing() {
  SequenceInfo info;
  for (int i = 0; i < 5; ++i) {
    info.frame_times.push_back(from_seconds(0.1 * i));
    info.ground_truth.trajectory.poses.push_back({info.frame_times.back(), {}});
  }
  return info;
}

void add(WorstPictures& pictures, int frame, double x) {
  PictureOfRun picture(frame, {640, 480});
  picture.update.status = OdometryStatus::kTracking;
  picture.update.T_w_c.p.x() = x;
  pictures.add(picture.report());
}

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(WorstPictures, KeepsThoseWhereTheErrorGrewMost) {
  const TemporaryFolder folder;
  WorstPictures pictures(folder.path() / "p", 2, {}, standing());
  // Grown by 0, 1, 0.5 and 2 m: frame 3 has to go for frame 4.
  const double x[] = {0.0, 0.0, 1.0, 1.5, 3.5};
  for (int frame = 0; frame < 5; ++frame) add(pictures, frame, x[frame]);
  EXPECT_EQ(names_in(folder.path() / "p"), (std::set<std::string>{"000002.jpg", "000004.jpg"}));
  EXPECT_EQ(read_picture(folder.path() / "p" / "000004.jpg").size(), cv::Size(400, 300));
}

TEST(WorstPictures, RemovesThoseOfAnEarlierRunAndNothingElse) {
  const TemporaryFolder folder;
  folder.write("p/000001.jpg", "old");
  folder.write("p/notes.txt", "mine");
  const WorstPictures pictures(folder.path() / "p", 2, {}, standing());
  EXPECT_EQ(names_in(folder.path() / "p"), (std::set<std::string>{"notes.txt"}));
}

}  // namespace
}  // namespace stillpoint
