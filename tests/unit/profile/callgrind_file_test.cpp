// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/instruction_count.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

/// main (3 + 2 of its own) calls f twice; f (10 a call) calls g. Lines are absolute, relative and equal.
constexpr const char* kText =
    "version: 1\n"
    "creator: callgrind-3.19.0\n"
    "positions: line\n"
    "events: Ir\n"
    "summary: 45\n"
    "\n"
    "ob=(1) /usr/bin/program\n"
    "fl=(1) main.cpp\n"
    "fn=(1) main\n"
    "16 3\n"
    "cfn=(2) stillpoint::TrackingStage::process(stillpoint::Frame const&)\n"
    "calls=2 50\n"
    "+1 40\n"
    "* 2\n"
    "\n"
    "fn=(2)\n"
    "50 20\n"
    "cfi=(2) g.cpp\n"
    "cfn=(3) g\n"
    "calls=2 70\n"
    "-2 20\n"
    "\n"
    "fl=(2)\n"
    "fn=(3)\n"
    "70 20\n"
    "\n"
    "totals: 45\n";

TEST(CallgrindFile, SumsSelfAndInclusiveCountsPerFunction) {
  const CallgrindCounts counts = parse_callgrind(kText, "callgrind.out");
  EXPECT_EQ(counts.total, 45);
  EXPECT_EQ(counts.self.at("main"), 5);
  EXPECT_EQ(counts.self.at("g"), 20);
  EXPECT_EQ(counts.inclusive.at("g"), 20);
  const std::string stage = "stillpoint::TrackingStage::process(stillpoint::Frame const&)";
  EXPECT_EQ(counts.self.at(stage), 20);
  EXPECT_EQ(counts.inclusive.at(stage), 40);  // 20 of its own and 20 in g
}

TEST(CallgrindFile, ErrorsNameTheLine) {
  expect_input_error([] { static_cast<void>(parse_callgrind("events: Ir\nfn=(7)\n", "c.out")); },
                     {"c.out:2", "undefined name id"});
  expect_input_error([] { static_cast<void>(parse_callgrind("events: Ir\nfn=(1) f\n12 x\n", "c.out")); },
                     {"c.out:3", "invalid count"});
  expect_input_error([] { static_cast<void>(parse_callgrind("events: Cycles\n", "c.out")); },
                     {"c.out:1", "\"Ir\""});
}

TEST(CallgrindFile, RejectsAnIncompleteFile) {
  expect_input_error([] { static_cast<void>(parse_callgrind("events: Ir\nfn=(1) f\n12 5\n", "c.out")); },
                     {"c.out", "has no counts"});
}

TEST(InstructionCount, SumsTheFunctionsOfEachStage) {
  const CallgrindCounts counts{
      .total = 100,
      .self = {},
      .inclusive = {{"stillpoint::TrackingStage::process(stillpoint::Frame const&, bool)", 10},
                    {"stillpoint::OptimizationStage::process(int)", 5},
                    {"stillpoint::OptimizationStage::process(int) (.cold)", 3},  // included in the line above
                    {"stillpoint::OptimizationStage::predict(int)", 2}}};
  const std::vector<Metric> metrics = instruction_metrics(stage_instructions(counts, "c.out"));
  ASSERT_EQ(metrics.size(), 4u);
  EXPECT_EQ(metrics[0].name, "instructions");
  EXPECT_EQ(metrics[0].value, 17.0);  // 10 + 5 + 2
  EXPECT_EQ(metrics[1].name, "instructions_tracking");
  EXPECT_EQ(metrics[1].value, 10.0);
  EXPECT_EQ(metrics[2].value, 0.0);
  EXPECT_EQ(metrics[3].value, 7.0);
}

TEST(InstructionCount, RejectsAStrippedBinary) {
  expect_input_error([] { static_cast<void>(stage_instructions({.total = 9}, "c.out")); },
                     {"c.out", "symbols"});
}

}  // namespace
}  // namespace stillpoint::bench
