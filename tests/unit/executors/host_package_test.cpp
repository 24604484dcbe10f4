// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/hosts.h"

#include <gtest/gtest.h>

#include "eval/io/text_reader.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// A Debian package with one file.
fs::path write_package(const TemporaryFolder& work, const std::string& file, const std::string& text) {
  const fs::path package = work.path() / (text + ".deb");
  work.write(text + "/" + file, text);
  work.write(text + "/DEBIAN/control",
             "Package: x\nVersion: 0\nArchitecture: all\nMaintainer: x <x@example.org>\nDescription: x\n");
  require_tool({.program = "dpkg-deb", .arguments = {"--build", "-Znone", work.path() / text, package}});
  return package;
}

HostPackage extract(const fs::path& file, const TemporaryFolder& work) {
  return extract_package(file, work.path() / "packages", {});
}

TEST(HostPackage, IsExtractedOncePerContent) {
  const TemporaryFolder work;
  const HostPackage one = extract(write_package(work, "usr/bin/stillpoint", "one"), work);
  EXPECT_EQ(eval::read_text_file(one.tree / one.program), "one");
  fs::remove(one.tree / one.program);
  EXPECT_FALSE(fs::exists(extract(work.path() / "one.deb", work).tree / one.program));
  EXPECT_NE(extract(write_package(work, "usr/bin/stillpoint", "two"), work).name, one.name);
}

TEST(HostPackage, OtherFilesAreErrors) {
  const TemporaryFolder work;
  expect_input_error([&] { static_cast<void>(extract(work.write("x.zip", ""), work)); },
                     {"x.zip", "neither"});
  expect_input_error([&] { static_cast<void>(extract(work.path() / "none.deb", work)); }, {"cannot be read"});
  expect_input_error([&] { static_cast<void>(extract(work.write("bad.deb", "no archive"), work)); },
                     {"bad.deb", "cannot be extracted"});
  const fs::path other = write_package(work, "usr/bin/other", "other");
  for (int repetition = 0; repetition < 2; ++repetition)
    expect_input_error([&] { static_cast<void>(extract(other, work)); }, {"other.deb", "lacks /usr/bin"});
}

}  // namespace
}  // namespace stillpoint::bench
