// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/thrown_message.h"

namespace stillpoint::bench {
namespace {

/// The error message for a config file with this text, without the folder.
std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = folder.write("mine.toml", text).string();
  const std::string message =
      thrown_message([&] { static_cast<void>(load_config({.base = file, .variant = "", .settings = {}})); });
  return message.starts_with(file) ? "mine.toml" + message.substr(file.size()) : message;
}

TEST(ConfigFile, UnknownKeyErrorNamesTheLineAndTheNearestKey) {
  EXPECT_EQ(error_of("seed = 1\n[frontend]\ncirculr_mask = true\n"),
            "mine.toml:3: unknown key \"frontend.circulr_mask\"; did you mean \"frontend.circular_mask\"?");
}

TEST(ConfigFile, RejectsAWrongType) {
  EXPECT_EQ(error_of("frontend.circular_mask = 1"),
            "mine.toml:1: \"frontend.circular_mask\" has the wrong type; it must be true or false");
  EXPECT_EQ(error_of("frontend.grid.rows = 7.5"),
            "mine.toml:1: \"frontend.grid.rows\" has the wrong type; it must be an integer");
}

TEST(ConfigFile, RejectsAValueOutOfRange) {
  EXPECT_EQ(error_of("\nfrontend.grid.rows = 65"),
            "mine.toml:2: \"frontend.grid.rows\" is 65, out of range; it must be between 1 and 64");
  EXPECT_EQ(error_of("imu.gravity = nan"),
            "mine.toml:1: \"imu.gravity\" is nan, out of range; it must be between 9 and 10");
}

TEST(ConfigFile, ListsTheChoicesOfAnEnum) {
  EXPECT_EQ(
      error_of("backend.depth.usage = \"some\""),
      "mine.toml:1: \"backend.depth.usage\" is \"some\"; expected one of: \"off\", \"fixed\", \"weighted\"");
}

TEST(ConfigFile, RejectsAValueForASection) {
  EXPECT_EQ(error_of("frontend = 3"),
            "mine.toml:1: \"frontend\" is a section, not a key; write [frontend] followed by its keys");
}

TEST(ConfigFile, RejectsInvalidToml) {
  EXPECT_TRUE(error_of("seed = 1\nseed = ").starts_with("mine.toml:2: invalid TOML: "));
}

TEST(ConfigFile, SkipsAByteOrderMarkAndNamesUtf16) {
  const TemporaryFolder folder;
  const std::string file = folder.write("mine.toml", "\xEF\xBB\xBFseed = 7").string();
  EXPECT_EQ(load_config({.base = file, .variant = "", .settings = {}}).seed, 7);
  EXPECT_TRUE(error_of(std::string("\xFF\xFEs\0", 4)).starts_with("mine.toml: is UTF-16 text; convert it"));
}

TEST(ConfigFile, RejectsAnUnsupportedType) {
  EXPECT_TRUE(
      error_of("seed = 2020-01-01").starts_with("mine.toml:1: \"seed\" has the unsupported type date"));
}

TEST(ConfigFile, RejectsCircularInheritance) {
  const TemporaryFolder folder;
  folder.write("b.toml", "\ninherits = \"a.toml\"");
  const std::string a = folder.write("a.toml", "inherits = \"b.toml\"").string();
  const std::string message =
      thrown_message([&] { static_cast<void>(load_config({.base = a, .variant = "", .settings = {}})); });
  EXPECT_EQ(message, (folder.path() / "b.toml").string() + ":2: circular inheritance through \"" + a +
                         "\"; remove one \"inherits\"");
}

TEST(ConfigFile, ChangesOnlyTheGivenKeysAndInheritsTheOthers) {
  const TemporaryFolder folder;
  const std::string file = folder.write("mine.toml", "inherits = \"stillpoint\"\nseed = 7").string();
  const OdometryConfig mine = load_config({.base = file, .variant = "", .settings = {}});
  const std::vector<ConfigEntry> expected = {{"seed", "7"}};
  EXPECT_EQ(config_difference(load_config({}), mine), expected);
}

TEST(ConfigFile, AppliesOverlaysInOrderAndSettingsLast) {
  const TemporaryFolder folder;
  const std::string first = folder.write("first.toml", "seed = 2\nfrontend.grid.rows = 2").string();
  const std::string second = folder.write("second.toml", "seed = 3\nfrontend.grid.cols = 3").string();
  const OdometryConfig config = load_config(
      {.base = "stillpoint", .variant = first + "+" + second, .settings = {"frontend.grid.cols=4"}});
  EXPECT_EQ(config.seed, 3);
  EXPECT_EQ(config.frontend.grid.rows, 2);
  EXPECT_EQ(config.frontend.grid.cols, 4);
}

TEST(ConfigFile, ReadsAnUnquotedWordAsAString) {
  const OdometryConfig config =
      load_config({.base = "dynamic_vins", .variant = "", .settings = {"backend.depth.usage=off"}});
  EXPECT_EQ(config.backend.depth.usage, DepthUsage::kOff);
}

TEST(ConfigFile, ABaseConfigInTheVariantReplacesTheBase) {
  const OdometryConfig by_variant =
      load_config({.base = "stillpoint", .variant = "vo+dynamic_vins", .settings = {}});
  const OdometryConfig by_base = load_config({.base = "dynamic_vins", .variant = "vo", .settings = {}});
  EXPECT_EQ(config_entries(by_variant), config_entries(by_base));
}

TEST(ConfigFile, RejectsTwoBases) {
  const std::string message = thrown_message([] {
    static_cast<void>(
        load_config({.base = "stillpoint", .variant = "stillpoint+dynamic_vins", .settings = {}}));
  });
  EXPECT_EQ(message,
            "variant \"stillpoint+dynamic_vins\": contains two base configs; combine one base with overlays");
}

TEST(ConfigFile, SuggestsTheNearestVariant) {
  const std::string message = thrown_message([] {
    static_cast<void>(load_config({.base = "stillpoint", .variant = "wo_circle_mask", .settings = {}}));
  });
  EXPECT_EQ(message, "unknown config \"wo_circle_mask\"; did you mean \"ablations/wo_circular_mask\"?");
}

TEST(ConfigFile, MissingFileErrorNamesTheFile) {
  const std::string message = thrown_message(
      [] { static_cast<void>(load_config({.base = "/nowhere/mine.toml", .variant = "", .settings = {}})); });
  EXPECT_EQ(message, "/nowhere/mine.toml: cannot be read; specify the path of an existing TOML file");
}

TEST(ConfigFile, RejectsAnAssignmentWithoutEqualsSign) {
  const std::string message = thrown_message(
      [] { static_cast<void>(load_config({.base = "stillpoint", .variant = "", .settings = {"seed"}})); });
  EXPECT_EQ(message, "--set: \"seed\" is not an assignment; write key=value");
}

TEST(ConfigFile, InvalidAssignmentErrorNamesTheOption) {
  const std::string message = thrown_message(
      [] { static_cast<void>(load_config({.base = "stillpoint", .variant = "", .settings = {"sed=1"}})); });
  EXPECT_EQ(message, "--set: unknown key \"sed\"; did you mean \"seed\"?");
}

}  // namespace
}  // namespace stillpoint::bench
