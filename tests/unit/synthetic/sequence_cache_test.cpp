// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "datasets/synthetic/sequence/presets.h"
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

TEST_F(SequenceCache, InterruptedRenderingIsNotCached) {
  EXPECT_TRUE(cached_sequence(small_request(), {.stop_requested = [] { return true; }}).empty());
  EXPECT_TRUE(fs::is_directory(cached_sequence(small_request())));
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
