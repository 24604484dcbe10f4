// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/association.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

Trajectory from_to(double first_s, double last_s) {
  return {.frame = "camera", .poses = {{from_seconds(first_s), {}}, {from_seconds(last_s), {}}}};
}

TEST(RequireOverlap, AcceptsACommonInstantAndAppliesTheOffset) {
  EXPECT_NO_THROW(require_overlap(from_to(0, 10), from_to(10, 20), 0.0, "est"));
  EXPECT_NO_THROW(require_overlap(from_to(0, 10), from_to(100, 110), -95.0, "est"));
  EXPECT_NO_THROW(require_overlap(from_to(0, 10), from_to(-5, 50), 0.0, "est"));
}

TEST(RequireOverlap, NamesBothSpansOtherwise) {
  expect_input_error([] { require_overlap(from_to(0, 10), from_to(11, 20), 0.5, "est.txt"); },
                     {"est.txt: covers 11.500000000 to 20.500000000 s", "0.000000000 to 10.000000000 s",
                      "no overlap in time", "--offset"});
}

TEST(RequireOverlap, NamesKnownCauses) {
  struct Case {
    double gt_s;
    double est_s;
    const char* cause;
  };
  for (const auto& [gt_s, est_s, cause] : {Case{1.4e9, 0.0, "try --offset 1400000000.000"},
                                           {1.4e9, 1.4e9 - 315964818.0, "GPS epoch"},
                                           {1.4e9, 1.4e9 + 7200.0, "local time: try --offset -7200"},
                                           {1.4e6, 1.4e9, "milliseconds"},
                                           {100.0, 300.0, "same clock"}}) {
    expect_input_error(
        [&] { require_overlap(from_to(gt_s, gt_s + 10), from_to(est_s, est_s + 10), 0.0, "e"); }, {cause});
  }
}

}  // namespace
}  // namespace stillpoint::eval
