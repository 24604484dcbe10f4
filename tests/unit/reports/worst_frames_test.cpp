// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/annotated_frames.h"

#include <set>

#include <gtest/gtest.h>

#include "datasets/io/image_io.h"
#include "tests/support/fake_frame_report.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

/// Five frames at 10 Hz of a camera at rest.
datasets::SequenceInfo sequence_at_rest() {
  datasets::SequenceInfo info;
  for (int i = 0; i < 5; ++i) {
    info.frame_times.push_back(from_seconds(0.1 * i));
    info.ground_truth.trajectory.poses.push_back({info.frame_times.back(), {}});
  }
  return info;
}

void add(WorstFrames& worst, int frame, double x) {
  FakeFrameReport fake(frame, {640, 480});
  fake.update.status = OdometryStatus::kTracking;
  fake.update.T_w_c.p.x() = x;
  worst.add(fake.report());
}

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(WorstFrames, KeepsTheFramesWithTheLargestError) {
  const TemporaryFolder folder;
  WorstFrames worst(folder.path() / "p", 2, {}, sequence_at_rest());
  // Frame-to-frame errors of 0, 1, 0.5 and 2 m: frame 4 replaces frame 3.
  const double x[] = {0.0, 0.0, 1.0, 1.5, 3.5};
  for (int frame = 0; frame < 5; ++frame) add(worst, frame, x[frame]);
  worst.finish();
  EXPECT_EQ(names_in(folder.path() / "p"), (std::set<std::string>{"000002.jpg", "000004.jpg"}));
  EXPECT_EQ(datasets::read_image(folder.path() / "p" / "000004.jpg").size(), cv::Size(400, 300));
}

TEST(WorstFrames, DeletesOnlyTheImagesOfAnEarlierRun) {
  const TemporaryFolder folder;
  folder.write("p/000001.jpg", "old");
  folder.write("p/notes.txt", "mine");
  folder.write("p.new/notes.txt", "mine");
  {
    WorstFrames worst(folder.path() / "p", 2, {}, sequence_at_rest());
    add(worst, 0, 0.0);
    add(worst, 1, 1.0);
  }  // interrupted
  EXPECT_EQ(names_in(folder.path() / "p"), (std::set<std::string>{"000001.jpg", "notes.txt"}));
  EXPECT_EQ(names_in(folder.path() / "p.new"), (std::set<std::string>{"notes.txt"}));
  WorstFrames(folder.path() / "p", 2, {}, sequence_at_rest()).finish();
  EXPECT_EQ(names_in(folder.path() / "p"), (std::set<std::string>{"notes.txt"}));
  EXPECT_EQ(names_in(folder.path() / "p.new"), (std::set<std::string>{"notes.txt"}));
}

}  // namespace
}  // namespace stillpoint::report
