// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "bench/model/honesty_metrics.h"
#include "bench/model/imu_rate_metrics.h"
#include "bench/model/loop_metrics.h"
#include "bench/model/metrics.h"
#include "bench/model/resource_metrics.h"

namespace stillpoint::bench {
namespace {

using Value = std::optional<double>;

const eval::Score* score_of(const Measurements& m) { return m.scored ? &m.scored->score : nullptr; }

Value ate(const Measurements& m) {
  const eval::Score* score = score_of(m);
  return score != nullptr && score->ate ? Value(score->ate->translation_m.rmse) : std::nullopt;
}

Value rpe(const Measurements& m, eval::Statistics eval::RpeResult::*errors) {
  const eval::Score* score = score_of(m);
  if (score == nullptr || !score->rpe) return std::nullopt;
  return ((*score->rpe).*errors).rmse / score->rpe_delta_s;
}
Value rpe_translation(const Measurements& m) { return rpe(m, &eval::RpeResult::translation_m); }
Value rpe_rotation(const Measurements& m) { return rpe(m, &eval::RpeResult::rotation_deg); }

/// A pose that is paired with itself counts as zero error in the RPE, but is no pair.
Value rpe_pairs(const Measurements& m) {
  const eval::Score* score = score_of(m);
  if (score == nullptr) return std::nullopt;
  return score->rpe ? static_cast<double>(score->rpe->translation_m.count - score->rpe->self_pairs) : 0.0;
}

template <Value eval::Score::*kMember>
Value member(const Measurements& m) {
  const eval::Score* score = score_of(m);
  return score != nullptr ? score->*kMember : std::nullopt;
}

template <auto kMember>
Value count(const Measurements& m) {
  return m.counts ? Value(static_cast<double>((*m.counts).*kMember)) : std::nullopt;
}

Value frames_without_boxes(const Measurements& m) {
  if (!m.counts || !m.counts->frames_without_boxes) return std::nullopt;
  return static_cast<double>(*m.counts->frames_without_boxes);
}

using enum MetricDirection;
using enum MetricSource;
using enum MetricFamily;

constexpr MetricProtocol kAteProtocol{"ate", "compat:tum, 0.02 s, one-to-one, rigid alignment"};
constexpr MetricProtocol kRpeProtocol{"rpe", "compat:tum, fixed delta of 1 s, all pairs"};
constexpr MetricProtocol kCorrectProtocol{metric_id::kCorrectRate,
                                          "openloris, 1 m, 30 deg, over the time of the ground truth"};
constexpr MetricProtocol kCoverageProtocol{metric_id::kCoverage, "fraction of frames with a pose"};

// Accuracy margin: the smallest practically relevant change. Cost margin: the smallest change that ten to
// twenty pairs can resolve on a shared machine. Floor: the precision of the ground truth.
constexpr MetricDescriptor kMetrics[] = {
    {.id = metric_id::kAte,
     .label = "ATE",
     .title = "Absolute trajectory error (ATE), RMSE",
     .description = "Root mean square distance between estimated and true positions after rigid alignment",
     .unit = "m",
     .direction = kSmallerIsBetter,
     .protocol = kAteProtocol,
     .gate = MetricGate{kAccuracy, 0.05, 2e-4},
     .value = ate},
    {.id = metric_id::kRpeTranslation,
     .label = "T.RPE",
     .title = "Translational relative pose error (RPE) over 1 s, RMSE",
     .description = "Root mean square translation error of the estimated motion over 1 s",
     .unit = "m/s",
     .direction = kSmallerIsBetter,
     .protocol = kRpeProtocol,
     .gate = MetricGate{kAccuracy, 0.05, 2e-4},
     .value = rpe_translation},
    {.id = metric_id::kRpeRotation,
     .label = "R.RPE",
     .title = "Rotational relative pose error (RPE) over 1 s, RMSE",
     .description = "Root mean square rotation error of the estimated motion over 1 s",
     .unit = "deg/s",
     .direction = kSmallerIsBetter,
     .protocol = kRpeProtocol,
     .gate = MetricGate{kAccuracy, 0.05, 5e-3},
     .value = rpe_rotation},
    {.id = metric_id::kCorrectRate,
     .label = "CR",
     .title = "Correct rate",
     .description = "Fraction of the time of the sequence with a pose within 1 m and 30 degrees of the truth",
     .direction = kLargerIsBetter,
     .protocol = kCorrectProtocol,
     .gate = MetricGate{.margin = 0.01, .is_fraction = true},
     .value = member<&eval::Score::correct_rate>},
    {.id = metric_id::kCoverage,
     .label = "coverage",
     .title = "Coverage: fraction of the frames with a pose",
     .description = "Fraction of the frames of the sequence for which the system reported a pose",
     .direction = kLargerIsBetter,
     .protocol = kCoverageProtocol,
     .gate = MetricGate{.margin = 0.01, .is_fraction = true},
     .value = member<&eval::Score::coverage>},
    {.id = metric_id::kFirstPose,
     .label = "first pose",
     .title = "Time until the first pose",
     .description = "Time from the first frame to the first reported pose",
     .unit = "s",
     .direction = kSmallerIsBetter,
     .decimals = 3,
     .value = member<&eval::Score::first_pose_s>},
    {.id = "segments",
     .label = "segments",
     .title = "Segments: world frames with poses",
     .description =
         "Number of world frames in which the system reported poses; the scores are those of the first",
     .direction = kSmallerIsBetter,
     .decimals = 0,
     .value = count<&RunCounts::segments>},
    {.id = metric_id::kRpePairs,
     .label = "RPE pairs",
     .title = "Pairs of poses in the relative pose error",
     .description = "Number of pairs of two poses in T.RPE and R.RPE; few ones tell little",
     .decimals = 0,
     .value = rpe_pairs},
    {.id = "resets",
     .label = "resets",
     .title = "Estimator resets",
     .description = "Number of times that the estimator failed and started again",
     .direction = kSmallerIsBetter,
     .decimals = 0,
     .source = kRun,
     .value = count<&RunCounts::resets>},
    {.id = metric_id::kFrames,
     .label = "frames",
     .description = "Number of processed frames",
     .decimals = 0,
     .source = kRun,
     .value = count<&RunCounts::frames>},
    {.id = metric_id::kFramesWithoutBoxes,
     .label = "frames without boxes",
     .description = "Number of frames whose dynamic objects were not masked, as the recorded boxes lack them",
     .direction = kSmallerIsBetter,
     .decimals = 0,
     .source = kRun,
     .value = frames_without_boxes},
    {.id = "poses",
     .label = "poses",
     .description = "Number of reported poses",
     .decimals = 0,
     .source = kRun,
     .value = count<&RunCounts::poses>},
    {.id = metric_id::kWallTime,
     .label = "wall time",
     .description = "Time from the request of the first frame to the last pose",
     .unit = "s",
     .decimals = 2,
     .source = kRun,
     .value = count<&RunCounts::wall_s>},
};

/// Computed by evaluation protocols, or from stored runs.
constexpr MetricDescriptor kDerivedMetrics[] = {
    {.id = metric_id::kAteRotation,
     .label = "ATE, rotation",
     .description = "Root mean square rotation between estimated and true orientations after alignment",
     .unit = "deg",
     .source = kProtocol},
    {.id = metric_id::kRpeTranslationPerDelta,
     .label = "T.RPE",
     .description =
         "Root mean square translation error of the estimated motion over the interval of the protocol",
     .unit = "m",
     .source = kProtocol},
    {.id = metric_id::kRpeRotationPerDelta,
     .label = "R.RPE",
     .description =
         "Root mean square rotation error of the estimated motion over the interval of the protocol",
     .unit = "deg",
     .source = kProtocol},
    {.id = metric_id::kDrift,
     .label = "drift",
     .description = "Translation error over segments of the trajectory, relative to their length",
     .unit = "%",
     .source = kProtocol},
    {.id = metric_id::kModuleTime,
     .label = "module time",
     .description = "Mean time of a module per call, or of a thread per frame",
     .unit = "ms",
     .direction = kSmallerIsBetter,
     .source = kStore,
     .gate = MetricGate{kCost, 0.03, 0.01, false}},
    {.id = metric_id::kFailedRuns,
     .label = "failed runs",
     .description = "Fraction of the runs that did not succeed",
     .direction = kSmallerIsBetter,
     .source = kStore,
     .gate = MetricGate{}},
};

template <std::size_t... kSizes>
constexpr auto joined(const MetricDescriptor (&... lists)[kSizes]) {
  std::array<MetricDescriptor, (kSizes + ...)> all{};
  auto end = all.begin();
  ((end = std::ranges::copy(lists, end).out), ...);
  return all;
}
constexpr auto kAllMetrics = joined(kMetrics, kCostMetrics, kDerivedMetrics, kImuRateMetrics, kHonestyMetrics,
                                    kLoopMetrics, kDeviceMetrics);

}  // namespace

std::span<const MetricDescriptor> all_metrics() { return kAllMetrics; }

}  // namespace stillpoint::bench
