// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/timeline.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/trace_rules.h"

namespace stillpoint::bench {
namespace {

using std::chrono::nanoseconds;

FrameSpan span_of(Module module, int start_ns, int elapsed_ns, std::int64_t frame = 0) {
  return {.frame = frame,
          .span = {.module = module,
                   .start = std::chrono::steady_clock::time_point(nanoseconds(5'000'000 + start_ns)),
                   .elapsed = nanoseconds(elapsed_ns)}};
}

/// In the order in which timers end: inner ones first.
const std::vector<FrameSpan> kRun = {
    span_of(Module::kImageDecoding, 0, 900),
    span_of(Module::kFeatureTracking, 1100, 300),
    span_of(Module::kFeatureDetection, 1500, 1234),
    span_of(Module::kTrackingThread, 1000, 2000),
    span_of(Module::kMarginalization, 4000, 700),
    span_of(Module::kStateOptimization, 4000, 700),  // as long as its inner span
    span_of(Module::kOptimizationThread, 3500, 1300),
    span_of(Module::kTrackingThread, 3200, 500, 1),  // concurrent to the optimization
};

using Faults = std::vector<std::string>;

Faults faults_of(const std::vector<FrameSpan>& spans) {
  return trace_format_errors(nlohmann::json::parse(chrome_trace(spans, "test")));
}

TEST(ChromeTrace, IsValid) { EXPECT_EQ(faults_of(kRun), Faults{}); }

TEST(ChromeTrace, OfOverlappingSpansIsInvalid) {
  const std::vector<FrameSpan> spans = {span_of(Module::kFeatureTracking, 0, 10),
                                        span_of(Module::kFeatureDetection, 5, 10)};
  EXPECT_EQ(faults_of(spans), Faults{"feature_detection: overlaps"});
}

TEST(ChromeTrace, PreservesNanoseconds) {
  const nlohmann::json trace = nlohmann::json::parse(chrome_trace(kRun, "test"));
  for (const auto& event : trace.at("traceEvents")) {
    if (event.at("name") != "feature_detection") continue;
    EXPECT_DOUBLE_EQ(event.at("ts").get<double>(), 1.5);
    EXPECT_DOUBLE_EQ(event.at("dur").get<double>(), 1.234);
    return;
  }
  FAIL() << "the span is missing";
}

TEST(ChromeTrace, WithoutSpansIsValid) { EXPECT_EQ(faults_of({}), Faults{}); }

TEST(FoldedStacks, ContainTheSelfTimeOfTheInnermostModule) {
  EXPECT_EQ(folded_stacks(kRun),
            "image decoding;image_decoding 900\n"
            "optimization;optimization_thread 600\n"  // 1300 - 700
            "optimization;optimization_thread;state_optimization 0\n"
            "optimization;optimization_thread;state_optimization;marginalization 700\n"
            "tracking;tracking_thread 966\n"  // 2000 - 300 - 1234 + 500
            "tracking;tracking_thread;feature_detection 1234\n"
            "tracking;tracking_thread;feature_tracking 300\n");
}

}  // namespace
}  // namespace stillpoint::bench
