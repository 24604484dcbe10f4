// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_cache.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/cached_sequence.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOtherRig = "[camera]\nwidth = 64\nheight = 48\nfx = 61\nfy = 60\ncx = 32\ncy = 24\n";

class FrameCacheTest : public ::testing::Test {
 protected:
  [[nodiscard]] FrameCacheOptions options() const {
    return {.folder = cache(), .max_bytes = 10'000'000, .disk_reserve_bytes = 0};
  }
  [[nodiscard]] fs::path cache() const { return folder_.path() / "cache"; }
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_.path() / name; }

  /// Writes a sequence and its cache file.
  fs::path cached(const std::string& name, std::uint64_t seed = 1) const {
    const fs::path folder = noise_sequence(path(name), seed);
    EXPECT_TRUE(CachedSequence(folder, options()).loads_all());
    return folder;
  }

  TemporaryFolder folder_;
};

void overwrite(const fs::path& file, std::uint64_t offset, const std::string& bytes) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(offset));
  stream << bytes;
}

TEST_F(FrameCacheTest, TheSecondRunDecodesNothingAndGetsTheSameBits) {
  const fs::path folder = noise_sequence(path("a"));
  CachedSequence first(folder, options());
  EXPECT_TRUE(first.loads_all());
  EXPECT_EQ(first.decoded, kCachedFrames);
  CachedSequence second(folder, options());
  EXPECT_TRUE(second.cache.complete());
  EXPECT_TRUE(second.loads_all());
  EXPECT_EQ(second.decoded, 0);
  EXPECT_TRUE(second.warnings.empty());
}

TEST_F(FrameCacheTest, ASecondPassOfTheFirstRunDecodesNothing) {
  CachedSequence sequence(noise_sequence(path("a")), options());
  EXPECT_TRUE(sequence.loads_all());
  EXPECT_TRUE(sequence.loads_all());
  EXPECT_EQ(sequence.decoded, kCachedFrames);
}

TEST_F(FrameCacheTest, ColorIsDecodedOnDemand) {
  const fs::path folder = cached("a");
  CachedSequence second(folder, options());
  const Frame frame = second.cache.load(2);
  EXPECT_TRUE(frame.color.empty());
  EXPECT_EQ(color_image(frame).type(), CV_8UC3);
}

TEST_F(FrameCacheTest, AChangedImageIsDecodedAgain) {
  const fs::path folder = cached("a");
  write_noise_frame(folder, 3, 999);
  CachedSequence changed(folder, options());
  EXPECT_TRUE(changed.loads_all());
  EXPECT_EQ(changed.decoded, kCachedFrames);
  EXPECT_EQ(cache_files(cache()).size(), 2U);
}

TEST_F(FrameCacheTest, ATouchedImageWithTheSameContentLeadsToTheSameFile) {
  const fs::path folder = cached("a");
  fs::last_write_time(folder / "depth" / "00002.png",
                      fs::file_time_type::clock::now() - std::chrono::hours(2));
  EXPECT_TRUE(CachedSequence(folder, options()).loads_all());
  EXPECT_EQ(cache_files(cache()).size(), 1U);
}

TEST_F(FrameCacheTest, CopiesOfASequenceShareOneFile) {
  cached("a", 7);
  cached("copy", 7);
  EXPECT_EQ(cache_files(cache()).size(), 1U);
}

TEST_F(FrameCacheTest, AnotherCalibrationHasAnotherFile) {
  const fs::path folder = cached("a");
  const fs::path rig = folder_.write("other.toml", kOtherRig);
  CachedSequence other(folder, options(), {.rig_file = rig});
  EXPECT_TRUE(other.loads_all());
  EXPECT_EQ(other.decoded, kCachedFrames);
  EXPECT_EQ(cache_files(cache()).size(), 2U);
}

TEST_F(FrameCacheTest, ARunOfTheFirstFramesKeepsThoseAndUsesALongerFile) {
  const fs::path folder = noise_sequence(path("a"));
  FrameCacheOptions two = options();
  two.max_frames = 2;
  for (const int decoded : {2, 0}) {
    CachedSequence sequence(folder, two);
    EXPECT_TRUE(sequence.loads_same(0) && sequence.loads_same(1));
    EXPECT_EQ(sequence.decoded, decoded);
  }
  EXPECT_TRUE(CachedSequence(folder, options()).loads_all());
  prune_cache(cache(), 60'000);  // removes the file of two frames
  CachedSequence sequence(folder, two);
  EXPECT_TRUE(sequence.cache.complete());
}

TEST_F(FrameCacheTest, AnUnreadableFrameFailsInEveryRun) {
  const fs::path folder = noise_sequence(path("a"));
  fs::resize_file(folder / "color" / "00001.png", 40);
  make_older(folder / "color" / "00001.png");
  for (int run = 0; run < 2; ++run) {
    CachedSequence sequence(folder, options());
    for (std::size_t i = 0; i < kCachedFrames; ++i) {
      if (i == 1) {
        expect_input_error([&] { static_cast<void>(sequence.cache.load(1)); }, {"00001.png"});
      } else {
        EXPECT_TRUE(sequence.loads_same(i));
      }
    }
    EXPECT_EQ(sequence.decoded, run == 0 ? kCachedFrames : 1);
  }
}

TEST_F(FrameCacheTest, DamagedBlocksAreReportedDecodedAndReplaced) {
  const fs::path folder = cached("a");
  const fs::path file = cache_files(cache()).front();
  overwrite(file, fs::file_size(file) / 2 + 1000, "damage");
  CachedSequence damaged(folder, options());
  EXPECT_TRUE(damaged.loads_all());
  EXPECT_EQ(damaged.decoded, 1);
  ASSERT_EQ(damaged.warnings.size(), 1U);
  EXPECT_EQ(damaged.warnings[0], file.string() +
                                     ": 1 of 6 cached frames are damaged; they are decoded again, and the "
                                     "file is replaced");
  CachedSequence repaired(folder, options());
  EXPECT_TRUE(repaired.loads_all());
  EXPECT_EQ(repaired.decoded, 0);
  EXPECT_TRUE(repaired.warnings.empty());
}

TEST_F(FrameCacheTest, ATruncatedFileIsReportedAndReplaced) {
  const fs::path folder = cached("a");
  const fs::path file = cache_files(cache()).front();
  fs::resize_file(file, fs::file_size(file) - 100);
  CachedSequence truncated(folder, options());
  EXPECT_TRUE(truncated.loads_all());
  ASSERT_EQ(truncated.warnings.size(), 1U);
  EXPECT_NE(truncated.warnings[0].find("is truncated or damaged"), std::string::npos);
  EXPECT_TRUE(CachedSequence(folder, options()).cache.complete());
}

TEST_F(FrameCacheTest, AFileThatIsTruncatedDuringTheRunIsAnErrorOfTheRead) {
  const fs::path folder = cached("a");
  CachedSequence sequence(folder, options());
  EXPECT_TRUE(sequence.loads_same(0));
  fs::resize_file(cache_files(cache()).front(), 20'000);
  EXPECT_TRUE(sequence.loads_all());
  EXPECT_GT(sequence.decoded, 2);
  EXPECT_EQ(sequence.warnings.size(), 1U);
  EXPECT_TRUE(CachedSequence(folder, options()).cache.complete());
}

TEST_F(FrameCacheTest, TheLeastRecentlyUsedFileIsRemovedAtTheLimit) {
  const fs::path a = cached("a", 1);
  const fs::path b = cached("b", 2);
  for (const CacheEntry& entry : list_cache(cache())) make_older(entry.file);
  EXPECT_TRUE(CachedSequence(a, options()).loads_all());  // b is now the least recently used
  FrameCacheOptions limited = options();
  limited.max_bytes = 140'000;  // two files of 55 kB, and the digests
  EXPECT_TRUE(CachedSequence(noise_sequence(path("c"), 3), limited).loads_all());
  EXPECT_LE(cache_bytes(cache()), limited.max_bytes);
  EXPECT_TRUE(CachedSequence(a, options()).cache.complete());
  EXPECT_FALSE(CachedSequence(b, options()).cache.complete());
  EXPECT_TRUE(CachedSequence(path("c"), options()).cache.complete());
}

TEST_F(FrameCacheTest, ASequenceLargerThanTheLimitIsNotKeptAndRemovesNothing) {
  const fs::path a = noise_sequence(path("a"), 1);
  FrameCacheOptions one_frame = options();
  one_frame.max_frames = 1;
  EXPECT_TRUE(CachedSequence(a, one_frame).loads_all());
  FrameCacheOptions limited = options();
  limited.max_bytes = 20'000;  // one frame has 9 kB
  CachedSequence large(noise_sequence(path("b"), 2), limited);
  EXPECT_TRUE(large.loads_all());
  ASSERT_EQ(large.warnings.size(), 1U);
  EXPECT_NE(large.warnings[0].find("STILLPOINT_CACHE_SIZE"), std::string::npos);
  EXPECT_TRUE(CachedSequence(a, one_frame).cache.complete());
  EXPECT_TRUE(cache_files(cache(), ".partial").empty());
}

TEST_F(FrameCacheTest, TheReserveOfTheDiskIsNotUsed) {
  FrameCacheOptions full = options();
  full.disk_reserve_bytes = 1'000'000'000'000'000;
  CachedSequence sequence(noise_sequence(path("a")), full);
  EXPECT_TRUE(sequence.loads_all());
  ASSERT_EQ(sequence.warnings.size(), 1U);
  EXPECT_NE(sequence.warnings[0].find("reserve"), std::string::npos);
  EXPECT_TRUE(cache_files(cache()).empty());
}

TEST_F(FrameCacheTest, AFolderThatCannotBeCreatedIsReported) {
  FrameCacheOptions impossible = options();
  impossible.folder = folder_.write("file", "") / "cache";
  CachedSequence sequence(noise_sequence(path("a")), impossible);
  EXPECT_TRUE(sequence.loads_all());
  EXPECT_EQ(sequence.warnings.size(), 1U);
}

TEST_F(FrameCacheTest, PruningRemovesFilesOfKilledWritersAndDigestsOfRemovedSequences) {
  const fs::path folder = cached("a");
  std::ofstream(cache() / "0123-6.partial") << "unfinished";
  fs::remove_all(folder);
  EXPECT_GT(prune_cache(cache(), 0), 55'000U);
  EXPECT_TRUE(fs::is_empty(cache()));
}

TEST_F(FrameCacheTest, PruningKeepsAFileThatIsBeingWritten) {
  fs::create_directories(cache());
  const auto writer = FrameFileWriter::create(cache() / "0123-6.partial", {"name", 64, 48}, {});
  ASSERT_NE(writer, nullptr);
  prune_cache(cache(), 0);
  EXPECT_TRUE(fs::exists(cache() / "0123-6.partial"));
}

TEST_F(FrameCacheTest, ARenderedSequenceIsWrittenWithoutDecoding) {
  FrameCacheFill fill(options(), "a");
  for (int i = kCachedFrames - 1; i >= 0; --i) {
    const auto seed = 100 + static_cast<std::uint64_t>(i);
    fill.add(static_cast<std::size_t>(i), noise_image<std::uint8_t>(CV_8UC3, seed),
             noise_image<std::uint16_t>(CV_16UC1, seed));
  }
  FaultLog strict;
  fill.finish(read_sequence(noise_sequence(path("a"), 1), {}, strict));
  CachedSequence sequence(path("a"), options());
  EXPECT_TRUE(sequence.loads_all());
  EXPECT_EQ(sequence.decoded, 0);
}

TEST_F(FrameCacheTest, AnIncompleteRenderingLeavesNoFile) {
  {
    FrameCacheFill fill(options(), "a");
    fill.add(0, noise_image<std::uint8_t>(CV_8UC3, 1), noise_image<std::uint16_t>(CV_16UC1, 1));
  }
  EXPECT_TRUE(fs::is_empty(cache()));
}

TEST_F(FrameCacheTest, AFewFilesWithoutDigestsAreReadAtOpening) {
  const fs::path folder = cached("a");
  fs::remove(cache_files(cache(), ".digests").front());
  CachedSequence sequence(folder, options());
  EXPECT_TRUE(sequence.cache.complete());
}

TEST(CacheSize, IsReadInDecimalUnits) {
  EXPECT_EQ(size_from_text("--size", "0"), 0U);
  EXPECT_EQ(size_from_text("--size", "1500"), 1500U);
  EXPECT_EQ(size_from_text("--size", "20G"), 20'000'000'000U);
  EXPECT_EQ(size_from_text("--size", "1.5 GB"), 1'500'000'000U);
  EXPECT_EQ(size_from_text("--size", "500m"), 500'000'000U);
  for (const char* text : {"", "G", "-1", "1X", "20 GiB", "nan", "1e30"}) {
    expect_input_error([&] { static_cast<void>(size_from_text("--size", text)); }, {"is not a size"});
  }
}

}  // namespace
}  // namespace stillpoint::datasets
