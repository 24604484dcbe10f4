// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "datasets/cache/cache_space.h"
#include "datasets/open_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

class RenderedSequence : public ::testing::Test {
 protected:
  RenderedSequence() { setenv("STILLPOINT_CACHE", folder_.path().c_str(), 1); }
  ~RenderedSequence() override { unsetenv("STILLPOINT_CACHE"); }

  [[nodiscard]] datasets::FrameCacheOptions options() const {
    return {.folder = folder_.path() / "frames", .max_bytes = 10'000'000, .disk_reserve_bytes = 0};
  }
  static synth::SynthRequest small_request() {
    synth::SynthRequest request = synth::preset_request("walking_xyz_empty");
    request.width = 64;
    request.height = 48;
    request.focal_px = 53.5;
    request.seconds = 0.1;
    return request;
  }
  TemporaryFolder folder_;
};

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
}

TEST_F(RenderedSequence, ItsFirstRunReadsTheBitsOfThePngFilesFromTheCache) {
  const fs::path folder = rendered_sequence(small_request(), {}, options());
  const auto cached = datasets::open_sequence(folder, {.frame_cache = options()});
  const auto decoded = datasets::open_sequence(folder);
  ASSERT_TRUE(cached->frames_are_cached());
  ASSERT_EQ(cached->info().frame_times.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Frame a = cached->load_frame(i);
    const Frame b = decoded->load_frame(i);
    EXPECT_TRUE(equal(a.gray, b.gray) && equal(a.depth, b.depth) && equal(color_image(a), b.color));
    EXPECT_TRUE(a.color.empty());
  }
}

TEST_F(RenderedSequence, ASequenceThatIsThereIsNotWrittenAgain) {
  const fs::path folder = rendered_sequence(small_request(), {}, std::nullopt);
  EXPECT_EQ(rendered_sequence(small_request(), {}, options()), folder);
  EXPECT_TRUE(datasets::list_cache(options().folder).empty());
}

TEST_F(RenderedSequence, ARenderingThatIsContinuedIsDecodedByItsFirstRun) {
  int rendered = 0;
  const synth::RenderControl one{.progress = [&](int, int) { ++rendered; },
                                 .stop_requested = [&] { return rendered == 1; },
                                 .threads = 1};
  EXPECT_TRUE(rendered_sequence(small_request(), one, options()).empty());
  const fs::path folder = rendered_sequence(small_request(), {}, options());
  EXPECT_FALSE(datasets::open_sequence(folder, {.frame_cache = options()})->frames_are_cached());
}

TEST_F(RenderedSequence, AStoppedRenderingLeavesNoFrameCache) {
  EXPECT_TRUE(rendered_sequence(small_request(), {.stop_requested = [] { return true; }}, options()).empty());
  EXPECT_EQ(datasets::cache_bytes(options().folder), 0U);
}

// The run skipped all frames, and the odometry was scored as lost.
TEST_F(RenderedSequence, AFrameThatCannotBeWrittenIsNoDamagedFrame) {
  const auto stream = find_sequence("walking_xyz_empty", {}, {}, {.when_loaded = true});
  const fs::path folder = synth::sequence_cache_folder(synth::preset_request("walking_xyz_empty"));
  fs::remove_all(folder / "color");
  std::ofstream(folder / "color") << "no folder";
  EXPECT_THROW(static_cast<void>(stream->load_frame(0)), RenderingError);
}

}  // namespace
}  // namespace stillpoint::bench
