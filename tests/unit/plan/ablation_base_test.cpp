// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_plan.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

StoredPlan stored(const std::string& text) {
  return {.name = "p", .title = "", .text = text, .run_keys = {}};
}

TEST(AblationBase, IsReadFromTheStoredText) {
  EXPECT_EQ(ablation_base_of(stored("title = \"t\"\nablation_base = \"vo\"\nvariants = [\"vo\"]\n")), "vo");
}

TEST(AblationBase, IsAbsentInPlansOfOlderVersionsAndInDamagedTexts) {
  for (const char* text : {"", "title = \"t\"\n", "ablation_base = ", "ablation_base = 3\n",
                           "[table]\nablation_base = \"vo\"\n"})
    EXPECT_FALSE(ablation_base_of(stored(text))) << text;
}

TEST(AblationBase, MustBeAVariantOfThePlan) {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& text) {
    return load_plan(folder.write("plan.toml", text).string());
  };
  EXPECT_EQ(load("ablation_base = \"vo\"\nrendered.variants = [\"stillpoint\", \"vo\"]").ablation_base, "vo");
  EXPECT_EQ(load("variants = [\"vo\"]").ablation_base, "");
  expect_input_error(
      [&] { static_cast<void>(load("variants = [\"vo\", \"stillpoint\"]\nablation_base = \"stilpoint\"")); },
      {"plan.toml:2", "\"stilpoint\" is no variant of the plan", "\"stillpoint\"?"});
}

std::vector<std::vector<std::string>> lists_of(const std::vector<AblationGroup>& groups) {
  std::vector<std::vector<std::string>> lists;
  for (const AblationGroup& group : groups) {
    lists.push_back({group.base});
    lists.back().insert(lists.back().end(), group.variants.begin(), group.variants.end());
  }
  return lists;
}
using Lists = std::vector<std::vector<std::string>>;

TEST(AblationGroups, CompareOverlaysWithTheVariantThatTheyExtend) {
  const std::vector<std::string> variants = {"a", "wo_x", "b", "b+wo_x", "b+c", "b+c+wo_x", "d+wo_x"};
  EXPECT_EQ(lists_of(ablation_groups("a", variants)),
            (Lists{{"a", "wo_x", "b", "d+wo_x"}, {"b", "b+wo_x", "b+c"}, {"b+c", "b+c+wo_x"}}));
}

TEST(AblationGroups, RequireTheBaseAndAnotherVariant) {
  EXPECT_TRUE(ablation_groups("a", std::vector<std::string>{"b", "c"}).empty());
  EXPECT_TRUE(ablation_groups("a", std::vector<std::string>{"a"}).empty());
}

}  // namespace
}  // namespace stillpoint::bench
