// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/download/archive_extraction.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_archive.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream input(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

TEST(ArchiveExtraction, ReadsEveryKind) {
  for (const std::string name : {"a.tgz", "a.tar", "a.tar.xz", "a.tar.bz2", "a.zip", "a.7z"}) {
    const TemporaryFolder folder;
    write_archive(folder.path() / name, {{"top/rgb/1.png", "image"}, {"top/rgb.txt", "1 rgb/1.png"}});
    const ExtractionTotals totals = extract_archive(folder.path() / name, folder.path() / "out", {}, {});
    EXPECT_EQ(text_of(folder.path() / "out/top/rgb/1.png"), "image") << name;
    EXPECT_EQ(text_of(folder.path() / "out/top/rgb.txt"), "1 rgb/1.png") << name;
    EXPECT_EQ(totals.bytes, 16U) << name;
  }
}

TEST(ArchiveExtraction, ExtractsNestedArchivesIntoFoldersOfTheirNames) {
  const TemporaryFolder folder;
  write_archive(folder.path() / "with_top.7z", {{"with_top/color.txt", "a"}});
  write_archive(folder.path() / "without_top.zip", {{"mav0/imu0/data.csv", "b"}});
  write_archive(folder.path() / "scene.tar",
                {{"with_top.7z", text_of(folder.path() / "with_top.7z")},
                 {"room/without_top.zip", text_of(folder.path() / "without_top.zip")}});
  static_cast<void>(extract_archive(folder.path() / "scene.tar", folder.path() / "out", {}, {}));
  EXPECT_EQ(text_of(folder.path() / "out/with_top/color.txt"), "a");
  EXPECT_EQ(text_of(folder.path() / "out/room/without_top/mav0/imu0/data.csv"), "b");
  EXPECT_FALSE(fs::exists(folder.path() / "out/with_top.7z"));
}

TEST(ArchiveExtraction, RefusesEntriesOutsideOfTheFolder) {
  const std::vector<TestEntry> outside{{"../escaped", "x"},
                                       {"a/../../escaped", "x"},
                                       {"/tmp/escaped", "x"},
                                       {"link", "", "/etc/passwd"},
                                       {"link", "", "inside"}};
  for (const TestEntry& entry : outside) {
    const TemporaryFolder folder;
    write_archive(folder.path() / "a.tar", {{"first", "1"}, entry});
    expect_input_error(
        [&] {
          static_cast<void>(extract_archive(folder.path() / "a.tar", folder.path() / "deep/out", {}, {}));
        },
        {entry.path, entry.link_target.empty() ? "outside" : "is a link"});
    EXPECT_FALSE(fs::exists(folder.path() / "deep/escaped"));
    EXPECT_FALSE(fs::exists(folder.path() / "escaped"));
  }
}

TEST(ArchiveExtraction, LimitsTheRatioTheSizeAndTheEntries) {
  const TemporaryFolder folder;
  const fs::path bomb = folder.path() / "bomb.tgz";
  write_archive(bomb, {{"zeros", std::string(120'000'000, '\0')}});
  const fs::path out = folder.path() / "out";
  expect_input_error([&] { static_cast<void>(extract_archive(bomb, out, {.max_ratio = 100.0}, {})); },
                     {"100 times its size"});
  expect_input_error([&] { static_cast<void>(extract_archive(bomb, out, {.max_bytes = 1000}, {})); },
                     {"more than 1000 bytes"});
  write_archive(folder.path() / "many.tar", {{"a", ""}, {"b", ""}, {"c", ""}});
  expect_input_error(
      [&] { static_cast<void>(extract_archive(folder.path() / "many.tar", out, {.max_entries = 2}, {})); },
      {"more than 2 entries"});
}

TEST(ArchiveExtraction, LimitsTheDepthOfArchivesInArchives) {
  const TemporaryFolder folder;
  write_archive(folder.path() / "0.zip", {{"a", "1"}});
  for (int depth = 1; depth <= 3; ++depth) {
    const std::string inner = std::to_string(depth - 1) + ".zip";
    write_archive(folder.path() / (std::to_string(depth) + ".zip"),
                  {{inner, text_of(folder.path() / inner)}});
  }
  expect_input_error(
      [&] { static_cast<void>(extract_archive(folder.path() / "3.zip", folder.path() / "out", {}, {})); },
      {"more than 2 archives"});
}

TEST(ArchiveExtraction, RejectsDamagedArchives) {
  const TemporaryFolder folder;
  std::string noise(200'000, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<char>(i * i * 7 + i / 3);
  for (const std::string name : {"a.tgz", "a.zip", "a.7z"}) {
    write_archive(folder.path() / name, {{"a", noise}, {"b", noise}});
    fs::resize_file(folder.path() / name, fs::file_size(folder.path() / name) / 2);
    expect_input_error(
        [&] { static_cast<void>(extract_archive(folder.path() / name, folder.path() / "out", {}, {})); },
        {name, "download it again"});
  }
  const fs::path text = folder.write("text.zip", "no archive at all");
  expect_input_error([&] { static_cast<void>(extract_archive(text, folder.path() / "out", {}, {})); },
                     {"text.zip"});
}

TEST(ArchiveExtraction, VerifiesTheChecksumOfGzip) {
  const TemporaryFolder folder;
  std::string noise(20'000, '\0');
  std::uint32_t state = 1;
  for (char& byte : noise) byte = static_cast<char>((state = state * 1'664'525U + 1'013'904'223U) >> 24U);
  const fs::path file = folder.path() / "a.tgz";
  write_archive(file, {{"a", noise}, {"b", noise}});
  const std::string intact = text_of(file);
  // Also of several members, and with bytes behind the last one.
  for (const std::string& text : {intact, intact + intact, intact + "no member"}) {
    std::ofstream(file, std::ios::binary) << text;
    static_cast<void>(extract_archive(file, folder.path() / "out", {}, {}));
    EXPECT_EQ(text_of(folder.path() / "out/a"), noise);
  }
  // Stored bytes: of the noise, whose values tell nothing about it.
  std::string damaged = intact;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  std::ofstream(file, std::ios::binary) << damaged;
  expect_input_error([&] { static_cast<void>(extract_archive(file, folder.path() / "out", {}, {})); },
                     {"a.tgz", "damaged", "download it again"});
}

TEST(ArchiveExtraction, CanBeStopped) {
  const TemporaryFolder folder;
  write_archive(folder.path() / "a.tar", {{"a", std::string(3'000'000, 'a')}, {"b", "b"}});
  const TransferControl control{.progress = {}, .stop = [] { return true; }, .report = {}};
  EXPECT_TRUE(extract_archive(folder.path() / "a.tar", folder.path() / "out", {}, control).stopped);
  EXPECT_FALSE(fs::exists(folder.path() / "out/b"));
}

}  // namespace
}  // namespace stillpoint::datasets
