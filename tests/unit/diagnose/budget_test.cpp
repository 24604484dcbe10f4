// SPDX-License-Identifier: BSD-3-Clause
// The budget of a diagnosis, with a clock that counts passes over the frames; and depth of another time or
// place.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "bench/diagnose/diagnosis.h"
#include "bench/diagnose/evidence/depth_alignment.h"
#include "bench/diagnose/image_causes.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

/// A bright near square that moves sideways before a far wall, at 30 Hz with stamps rounded to 10 ms.
class SquareStream final : public datasets::SensorStream {
 public:
  explicit SquareStream(int depth_delay = 0, cv::Point depth_shift = {})
      : depth_delay_(depth_delay), depth_shift_(depth_shift) {
    info_.name = "square";
    info_.folder = "square";
    info_.rig.camera = {.width = 96, .height = 72, .fx = 80.0, .fy = 80.0, .cx = 47.5, .cy = 35.5};
    info_.rig.depth_units_per_m = 1000.0;
    info_.ground_truth.trajectory.frame = "camera";
    for (int i = 0; i < 60; ++i) {
      const Timestamp t{static_cast<std::int64_t>(std::lround(i / 0.3)) * 10'000'000};
      info_.frame_times.push_back(t);
      info_.ground_truth.trajectory.poses.push_back(
          {t, {Eigen::Quaterniond::Identity(), {0.01 * i, 0.0, 0.0}}});
    }
  }
  [[nodiscard]] const datasets::SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    if (index == 0) ++passes_;
    Frame frame;
    frame.id = static_cast<std::int64_t>(index);
    frame.t = info_.frame_times[index];
    frame.gray = cv::Mat(72, 96, CV_8UC1, cv::Scalar(60));
    cv::randn(frame.gray, 60, 4);
    frame.gray(square(static_cast<int>(index))) += cv::Scalar(100);
    frame.depth = cv::Mat(72, 96, CV_16UC1, cv::Scalar(2000));
    frame.depth(square(static_cast<int>(index) - depth_delay_) + depth_shift_) = cv::Scalar(1000);
    frame.depth_units_per_m = 1000.0;
    return frame;
  }
  [[nodiscard]] bool frames_are_cached() const override { return false; }
  [[nodiscard]] std::optional<datasets::MotionLabels> load_labels(std::size_t) const override { return {}; }

  /// Number of times that the first frame was read.
  [[nodiscard]] int passes() const { return passes_; }

 private:
  static cv::Rect square(int index) { return {14 + 2 * ((index + 60) % 20), 18, 28, 28}; }

  datasets::SequenceInfo info_;
  int depth_delay_;
  cv::Point depth_shift_;
  mutable std::atomic<int> passes_{0};
};

/// Each pass over the frames takes 10 s.
DiagnosisOptions options_for(const SquareStream& stream, double budget_s) {
  return {.config = {"stillpoint", "vo", {"detector.kind=none"}},
          .budget_s = budget_s,
          .elapsed_s = [&stream] { return 10.0 * stream.passes(); }};
}

bool mentions(const std::vector<std::string>& phrases, const std::string& part) {
  return std::ranges::any_of(
      phrases, [&](const std::string& phrase) { return phrase.find(part) != std::string::npos; });
}

TEST(DiagnosisBudget, MeasuresAllCandidatesIfItSuffices) {
  const SquareStream stream;
  const Diagnosis diagnosis = diagnose(stream, options_for(stream, 1e6));
  EXPECT_TRUE(diagnosis.left_out.empty());
  EXPECT_TRUE(std::ranges::none_of(diagnosis.others, [](const Cause& cause) {
    return cause.correction.has_value() && !cause.error_ratio && !cause.needs_effect;
  }));
  EXPECT_EQ(diagnosis.frames, 60U);
  EXPECT_GE(diagnosis.trials, 2);  // as it is, and without rounded stamps
}

/// The first trial, the run without IMU, and two readings of the frames take 40 s.
TEST(DiagnosisBudget, StartsNoTrialThatWouldEndLater) {
  const SquareStream stream;
  const Diagnosis diagnosis = diagnose(stream, options_for(stream, 45.0));
  EXPECT_EQ(diagnosis.trials, 1);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.others, [](const Cause& cause) { return !cause.error_ratio; }));
  EXPECT_TRUE(mentions(diagnosis.left_out, "the effects of")) << diagnosis.left_out.size();
  EXPECT_LE(10.0 * stream.passes(), 45.0);
}

TEST(DiagnosisBudget, LeavesOutAComparisonThatItCutsOff) {
  const SquareStream stream;
  DiagnosisOptions options = options_for(stream, 45.0);
  options.elapsed_s = [&stream] { return stream.passes() > 1 ? 20.0 * stream.passes() - 10.0 : 10.0; };
  const Diagnosis diagnosis = diagnose(stream, options);
  EXPECT_EQ(diagnosis.trials, 1);
  EXPECT_TRUE(mentions(diagnosis.left_out, "the comparison of images")) << diagnosis.left_out.size();
}

TEST(DiagnosisBudget, OfTooFewFramesIsAnError) {
  const SquareStream stream;
  DiagnosisOptions options = options_for(stream, 40.0);
  options.elapsed_s = [] { return 11.0; };
  expect_input_error([&] { static_cast<void>(diagnose(stream, options)); }, {"--budget", "0 frames"});
}

TEST(DepthAlignment, IsSilentAboutDepthOfTheSameTimeAndPlace) {
  const SquareStream stream;
  const auto alignment = align_depth(stream, {});
  ASSERT_TRUE(alignment);
  EXPECT_TRUE(alignment_causes(*alignment).empty());
}

TEST(DepthAlignment, FindsDepthOfAnotherFrameAndTheCorrectionUndoesIt) {
  for (const int delay : {-1, 2}) {
    const SquareStream stream(delay);
    const std::vector<Cause> causes = alignment_causes(align_depth(stream, {}).value());
    const auto found = std::ranges::find(causes, "depth_late", &Cause::id);
    ASSERT_NE(found, causes.end()) << delay;
    const auto corrected = corrected_part(stream, {.count = 60}, {*found->correction});
    EXPECT_EQ(cv::norm(corrected->load_frame(10).depth, SquareStream().load_frame(10).depth), 0.0) << delay;
  }
}

TEST(DepthAlignment, FindsShiftedDepthAndTheCorrectionUndoesIt) {
  const SquareStream stream(0, {4, -3});
  const std::vector<Cause> causes = alignment_causes(align_depth(stream, {}).value());
  const auto found = std::ranges::find(causes, "depth_unregistered", &Cause::id);
  ASSERT_NE(found, causes.end());
  const auto corrected = corrected_part(stream, {.count = 60}, {*found->correction});
  const cv::Rect inner(8, 8, 80, 56);
  EXPECT_LE(cv::norm(corrected->load_frame(10).depth(inner), SquareStream().load_frame(10).depth(inner),
                     cv::NORM_L1),
            1000.0 * 2 * 56);  // edges of 1 px
}

}  // namespace
}  // namespace stillpoint::bench
