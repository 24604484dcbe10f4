// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/blob_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

TEST(BlobFiles, ReturnTheStoredContent) {
  const TemporaryFolder folder;
  const BlobFiles blobs(folder.path() / "blobs");
  const std::string text(100'000, 'x');
  const std::string name = blobs.put(text);
  EXPECT_EQ(name.size(), 32u);
  EXPECT_EQ(blobs.get(name), text);
  EXPECT_LT(std::filesystem::file_size(blobs.file(name)), 1000u);  // it is compressed
}

TEST(BlobFiles, StoreEqualContentsOnce) {
  const TemporaryFolder folder;
  const BlobFiles blobs(folder.path());
  EXPECT_EQ(blobs.put("same"), blobs.put("same"));
  EXPECT_NE(blobs.put("same"), blobs.put("other"));
  EXPECT_EQ(blobs.names().size(), 2u);
}

TEST(BlobFiles, StoreAnEmptyContent) {
  const TemporaryFolder folder;
  const BlobFiles blobs(folder.path());
  EXPECT_EQ(blobs.get(blobs.put("")), "");
}

TEST(BlobFiles, NameTheDamagedFile) {
  const TemporaryFolder folder;
  const BlobFiles blobs(folder.path());
  const std::string first = blobs.put("first");
  const std::string second = blobs.put("second");
  std::filesystem::copy_file(blobs.file(first), blobs.file(second),
                             std::filesystem::copy_options::overwrite_existing);
  expect_input_error([&] { static_cast<void>(blobs.get(second)); }, {second, "does not match its hash"});
  std::ofstream(blobs.file(first), std::ios::trunc) << "not zstd";
  expect_input_error([&] { static_cast<void>(blobs.get(first)); }, {first, "is not a zstd file"});
  std::filesystem::remove(blobs.file(first));
  expect_input_error([&] { static_cast<void>(blobs.get(first)); }, {first, "is missing"});
}

}  // namespace
}  // namespace stillpoint::bench
