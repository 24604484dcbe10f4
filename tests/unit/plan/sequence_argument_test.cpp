// SPDX-License-Identifier: BSD-3-Clause
// Folders and registered names as sequences of plans and commands.
#include "bench/plan/plan_sequences.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "bench/plan/sequence_registry.h"
#include "bench/record/sequence_checksum.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// A registry with the sequence "desk".
class SequenceNames : public testing::Test {
 protected:
  SequenceNames() {
    folder.write("desk/rgb.txt", "1 rgb/1.png\n");
    setenv("STILLPOINT_REGISTRY", (folder.path() / "sequences.json").c_str(), 1);
    add("desk", desk, Registration::kNew);
  }
  ~SequenceNames() override { unsetenv("STILLPOINT_REGISTRY"); }

  static void add(const std::string& name, const fs::path& sequence, Registration registration) {
    register_sequence(
        registry_file(),
        {.name = name, .folder = sequence, .checksum = sequence_checksum(sequence), .format = "tum"},
        registration);
  }

  TemporaryFolder folder;
  fs::path desk = fs::canonical(folder.path()) / "desk";
};

TEST_F(SequenceNames, ARegisteredNameStandsForItsFolder) {
  EXPECT_EQ(resolve_sequence("desk"), desk.string());
  EXPECT_EQ(resolve_sequence(desk.string()), desk.string());
  EXPECT_EQ(resolve_sequence("walking_xyz"), "walking_xyz");
}

TEST_F(SequenceNames, AreNotRegisteredInTheCurrentFolderWithoutHome) {
  const char* const value = std::getenv("HOME");
  const std::string home = value == nullptr ? "" : value;
  for (const char* name : {"STILLPOINT_REGISTRY", "XDG_CONFIG_HOME", "HOME"}) setenv(name, "", 1);
  EXPECT_EQ(registry_file(), "");
  EXPECT_TRUE(read_registry(registry_file()).empty());
  expect_input_error([&] { add("chair", desk, Registration::kNew); },
                     {"STILLPOINT_REGISTRY: is not set, and neither is HOME"});
  unsetenv("XDG_CONFIG_HOME");
  setenv("HOME", home.c_str(), 1);
}

TEST_F(SequenceNames, ABagStandsForItself) {
  const std::string bag = folder.write("a.bag", "").string();
  EXPECT_EQ(resolve_sequence(bag), bag);
}

TEST_F(SequenceNames, RejectsUnknownAndAmbiguousNames) {
  expect_input_error([] { static_cast<void>(resolve_sequence("dsk")); }, {"\"dsk\"", "\"desk\"?"});
  expect_input_error([] { static_cast<void>(resolve_sequence("/none")); },
                     {"\"/none\": is neither a folder nor a preset"});
  add("market", desk, Registration::kNew);
  expect_input_error([] { static_cast<void>(resolve_sequence("market")); }, {"a preset and a registered"});
}

TEST_F(SequenceNames, RejectsARegisteredSequenceWhoseFilesHaveChanged) {
  folder.write("desk/rgb.txt", "2 rgb/2.png\n");
  expect_input_error([] { static_cast<void>(resolve_sequence("desk")); }, {"\"desk\"", "checksum"});
}

TEST_F(SequenceNames, AnotherFolderReplacesARegistrationOnlyOnRequest) {
  folder.write("other/rgb.txt", "1 rgb/1.png\n");
  const fs::path other = folder.path() / "other";
  expect_input_error([&] { add("desk", other, Registration::kNew); }, {"is registered for", "--force"});
  add("desk", desk, Registration::kNew);  // the same folder: updated
  add("desk", other, Registration::kReplace);
  EXPECT_EQ(resolve_sequence("desk"), other.string());
}

TEST_F(SequenceNames, PlansAcceptPathsOfFolders) {
  const std::vector<PlanSequence> found = recorded_sequences({.sequences = {desk.string(), "desk"}});
  ASSERT_EQ(found.size(), 1u);  // both are the same sequence
  EXPECT_EQ(found.front().name, "desk");
  EXPECT_EQ(found.front().folder, desk);
}

TEST_F(SequenceNames, PlansRejectMissingFoldersAndTwoFoldersOfOneName) {
  expect_input_error([] { static_cast<void>(recorded_sequences({.sequences = {"/none/desk"}})); },
                     {"\"/none/desk\"", "is neither a folder nor a bag"});
  folder.write("b/desk/rgb.txt", "1 rgb/1.png\n");
  const std::string other = (folder.path() / "b" / "desk").string();
  expect_input_error(
      [&] {
        static_cast<void>(recorded_sequences({.sequences = {"desk", other}}));
      },
      {"\"desk\"", "two folders"});
}

}  // namespace
}  // namespace stillpoint::bench
