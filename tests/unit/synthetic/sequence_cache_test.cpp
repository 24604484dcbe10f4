// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/presets.h"
#include "tests/support/folder_contents.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

class SequenceCache : public testing::Test {
 protected:
  SequenceCache() { setenv("STILLPOINT_CACHE", folder_.path().c_str(), 1); }
  ~SequenceCache() override { unsetenv("STILLPOINT_CACHE"); }

  static SynthRequest small_request() {
    SynthRequest request = preset_request("walking_xyz_empty");
    request.width = 64;
    request.height = 48;
    request.focal_px = 53.5;
    request.seconds = 0.1;
    return request;
  }
  TemporaryFolder folder_;
};

TEST_F(SequenceCache, RendersEachRequestOnce) {
  int rendered = 0;
  const RenderControl control{.progress = [&](int, int) { ++rendered; }};
  const fs::path first = cached_sequence(small_request(), control);
  EXPECT_EQ(rendered, 3);
  EXPECT_EQ(cached_sequence(small_request(), control), first);
  EXPECT_EQ(rendered, 3);
  EXPECT_EQ(first.filename(), "walking_xyz_empty_1");
}

TEST_F(SequenceCache, RendersASequenceWithoutBoxesAgain) {
  const fs::path folder = cached_sequence(small_request());
  fs::remove(folder / "detections.txt");
  EXPECT_TRUE(fs::exists(cached_sequence(small_request()) / "detections.txt"));
}

/// With a person and errors of the detector.
SynthRequest populated(SynthRequest request) {
  request.preset = "walking_xyz";
  request.walkers = 2;
  request.detector.false_positive_rate = 0.5;
  request.detector.min_height_px = 1;
  return request;
}

TEST_F(SequenceCache, AnInterruptedRenderingIsContinuedWithTheSameFiles) {
  const SynthRequest request = populated(small_request());
  int rendered = 0;
  const RenderControl two{.progress = [&](int, int) { ++rendered; },
                          .stop_requested = [&] { return rendered == 2; },
                          .threads = 1};
  EXPECT_TRUE(cached_sequence(request, two).empty());
  EXPECT_FALSE(is_complete_sequence(sequence_cache_folder(request)));
  // A row that was cut off by the end of a process.
  std::ofstream(sequence_cache_folder(request) / "rendering.txt", std::ios::app) << "frame 2 17000000";
  const fs::path continued = cached_sequence(request, {.progress = [&](int, int) { ++rendered; }});
  EXPECT_EQ(rendered, 3);
  const fs::path whole = folder_.path() / "whole";
  ASSERT_TRUE(render_sequence(request, whole));
  EXPECT_EQ(folder_contents(continued), folder_contents(whole));
}

TEST_F(SequenceCache, BoxesOfARenderedFrameAreThoseOfTheCompleteFiles) {
  const SynthRequest request = populated(small_request());
  SequenceRendering rendering(request, folder_.path() / "by_frame");
  std::vector<FrameBoxes> boxes;
  for (std::size_t i = 0; i < 3; ++i) {
    rendering.render_until(i);
    boxes.push_back(rendering.boxes(i));
  }
  const auto complete = datasets::open_sequence(folder_.path() / "by_frame");
  const auto equal = [](const DetectionSet& a, const DetectionSet& b) {
    return a.t == b.t && a.state == b.state &&
           std::ranges::equal(a.detections, b.detections, [](const Detection& c, const Detection& d) {
             return c.class_name == d.class_name && c.score == d.score && c.box == d.box;
           });
  };
  ASSERT_EQ(complete->info().detections.size(), 3U);
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(equal(boxes[i].detections, complete->info().detections[i])) << i;
    EXPECT_TRUE(equal(boxes[i].truth, complete->info().true_boxes[i])) << i;
    count += boxes[i].detections.detections.size() + boxes[i].truth.detections.size();
  }
  EXPECT_GT(count, 3U);
}

/// Images, boxes and samples of a sequence are those of a longer one.
TEST_F(SequenceCache, ShortSequencesBeginAsLongOnes) {
  for (const std::string preset : {"walking_xyz", "corridor"}) {
    SynthRequest request = preset_request(preset);
    request.width = 64;
    request.height = 48;
    request.focal_px = 53.5;
    request.dropped_fraction = 0.2;
    const fs::path shorter = folder_.path() / (preset + "_short"),
                   longer = folder_.path() / (preset + "_long");
    request.seconds = 0.2;
    ASSERT_TRUE(render_sequence(request, shorter));
    request.seconds = 0.4;
    ASSERT_TRUE(render_sequence(request, longer));
    const std::map<std::string, std::string> all = folder_contents(longer);
    for (const auto& [name, bytes] : folder_contents(shorter)) {
      if (name == "request.toml") continue;     // the duration
      if (name == "groundtruth.txt") continue;  // poses follow the last frame
      ASSERT_TRUE(all.contains(name)) << name;
      EXPECT_TRUE(all.at(name).starts_with(bytes)) << preset << " " << name;
    }
  }
}

TEST(RequestKey, DependsOnFieldsAndFileContentsButNotOnFilePaths) {
  const TemporaryFolder folder;
  SynthRequest request = preset_request("flight");
  request.trajectory_file = folder.write("a/path.txt", "1 2 3");
  const std::string key = request_key(request);
  request.trajectory_file = folder.write("b/other.txt", "1 2 3");
  EXPECT_EQ(request_key(request), key);
  request.trajectory_file = folder.write("b/other.txt", "1 2 4");
  EXPECT_NE(request_key(request), key);
  SynthRequest noisier = preset_request("flight");
  noisier.imu.noise.gyro_walk *= 2.0;
  EXPECT_NE(request_key(noisier), request_key(preset_request("flight")));
}

}  // namespace
}  // namespace stillpoint::synth
