// SPDX-License-Identifier: BSD-3-Clause
/// Runs the download target on archives of every kind, catalogue files, and random mutations of them, with a
/// fixed random seed.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/support/test_archive.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// libarchive asks for as much memory as a header claims, 2 TiB in one of the mutations, and reports an error
/// if there is none. The address sanitizer would stop there; now it refuses more than 1 GiB.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1:max_allocation_size_mb=1024";
}

namespace stillpoint {
namespace {

std::string archive_seed(const std::string& name, const std::vector<TestEntry>& entries) {
  const TemporaryFolder folder;
  write_archive(folder.path() / name, entries);
  std::ifstream input(folder.path() / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

std::vector<std::string> archives() {
  const std::vector<TestEntry> entries{{"a/rgb.txt", "1 rgb/1.png"}, {"a/rgb/1.png", std::string(300, 'x')}};
  std::vector<std::string> all;
  for (const char* name : {"a.tar", "a.tgz", "a.tar.xz", "a.tar.bz2", "a.zip", "a.7z"})
    all.push_back(archive_seed(name, entries));
  all.push_back(archive_seed("b.zip", {{"a.zip", archive_seed("a.zip", entries)}}));
  return all;
}

std::vector<std::string> headers_and_catalogues() {
  return {"", "HTTP/1.1 206 x\r\nContent-Range: bytes 0-9/10\r\nETag: \"a\"\r\n",
          "name = \"d\"\ntitle = \"t\"\nlicence = \"l\"\nlayout = \"tum\"\n"
          "urls = [\"https://h/{}\"]\n[[sequences]]\nmembers = [\"a\", \"b\"]\n"
          "files = [\"{}.tgz\"]\n[archives.\"a.tgz\"]\nbytes = 1\n"};
}

/// One mutation: a changed byte, or a removed or duplicated substring.
std::string mutated(std::string bytes, std::mt19937& random) {
  if (bytes.empty()) return bytes;
  const std::size_t at = random() % bytes.size();
  const std::size_t length = random() % std::min<std::size_t>(bytes.size() - at, 40);
  switch (random() % 3) {
    case 0:
      bytes[at] = static_cast<char>(random());
      return bytes;
    case 1:
      return bytes.erase(at, length);
    default:
      return bytes.insert(at, bytes.substr(at, length));
  }
}

/// STILLPOINT_FUZZ_SECONDS extends each test, e.g. under the address sanitizer.
void expect_accepted_or_rejected(const std::vector<std::string>& seeds) {
  const char* const seconds = std::getenv("STILLPOINT_FUZZ_SECONDS");
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::seconds(seconds == nullptr ? 0 : std::atoi(seconds));
  std::mt19937 random(1);
  for (int round = 0; round < 100 || std::chrono::steady_clock::now() < end; ++round) {
    for (std::string bytes : seeds) {
      for (int i = 0; i < round % 5; ++i) bytes = mutated(std::move(bytes), random);
      ASSERT_EQ(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
    }
  }
}

TEST(DownloadTarget, MutatedArchivesAreAcceptedOrRejected) { expect_accepted_or_rejected(archives()); }

TEST(DownloadTarget, MutatedHeadersAndCataloguesAreAcceptedOrRejected) {
  expect_accepted_or_rejected(headers_and_catalogues());
}

}  // namespace
}  // namespace stillpoint
