// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/spelling.h"

#include <vector>

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

TEST(Spelling, WrongAndAdditionalLettersCostMoreThanOmittedOnes) {
  EXPECT_DOUBLE_EQ(spelling_distance("rows", "rows"), 0.0);
  EXPECT_DOUBLE_EQ(spelling_distance("rowz", "rows"), 1.0);    // one replaced
  EXPECT_DOUBLE_EQ(spelling_distance("rowss", "rows"), 1.0);   // one additional
  EXPECT_NEAR(spelling_distance("rw", "rows"), 0.2, 1e-12);    // two omitted
  EXPECT_NEAR(spelling_distance("rosw", "rows"), 0.2, 1e-12);  // two neighbors swapped
}

TEST(Spelling, PrefersSwappedLettersToALongerName) {
  const std::vector<std::string> names = {"walking_xyz_empty", "walking_xyz"};
  EXPECT_EQ(suggestion("walking_xzy", names), "; did you mean \"walking_xyz\"?");
}

TEST(Spelling, FindsTheFullNameOfAnAbbreviation) {
  const std::vector<std::string> keys = {"dynamic.mask", "dynamic.moving_consistency",
                                         "frontend.max_features"};
  EXPECT_EQ(suggestion("dynamic.mcc", keys), "; did you mean \"dynamic.moving_consistency\"?");
}

TEST(Spelling, SuggestsNothingWithoutNames) { EXPECT_EQ(suggestion("x", {}), ""); }

TEST(Spelling, SuggestsNothingForPathsAndForTextThatResemblesNoName) {
  const std::vector<std::string> names = {"walking_static", "walking_xyz", "market"};
  EXPECT_EQ(suggestion("/nonexist", names), "");
  EXPECT_EQ(suggestion("./walking_xyz", names), "");
  EXPECT_EQ(suggestion("qqqq", names), "");
  EXPECT_EQ(suggestion("markt", names), "; did you mean \"market\"?");
}

}  // namespace
}  // namespace stillpoint::bench
