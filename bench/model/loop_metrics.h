// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of runs with loop closure.
#pragma once

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// The value of one member of `LoopScore`; nullopt for a run without loop closure.
template <auto kMember>
[[nodiscard]] std::optional<double> loop_value(const Measurements& m) {
  if (!m.loops) return std::nullopt;
  if constexpr (std::is_same_v<std::remove_cvref_t<decltype((*m.loops).*kMember)>, std::size_t>) {
    return static_cast<double>((*m.loops).*kMember);
  } else {
    return (*m.loops).*kMember;
  }
}

/// The value of one member of `eval::RevisitScore`; nullopt for a run without loop closure or ground truth.
template <auto kMember>
[[nodiscard]] std::optional<double> revisit_value(const Measurements& m) {
  if (!m.loops || !m.loops->revisits) return std::nullopt;
  if constexpr (std::is_same_v<decltype(kMember), std::size_t eval::RevisitScore::*>) {
    return static_cast<double>((*m.loops->revisits).*kMember);
  } else {
    return (*m.loops->revisits).*kMember;
  }
}

/// The value of one member of `eval::ErrorAfterLoop`; nullopt without loops or with a loaded map.
template <auto kMember>
[[nodiscard]] std::optional<double> value_after_loop(const Measurements& m) {
  if (!m.loops || !m.loops->after_first) return std::nullopt;
  return (*m.loops->after_first).*kMember;
}

inline constexpr MetricDescriptor kLoopMetrics[] = {
    {.id = "ate_optimized_m",
     .label = "ATE, optimized",
     .title = "Absolute trajectory error (ATE) after loop closure, RMSE",
     .description =
         "Root mean square distance between true positions and those of the pose graph after the last frame",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kLoop,
     .gate = MetricGate{MetricFamily::kAccuracy, 0.05, 2e-4},
     .value = loop_value<&LoopScore::optimized_ate_m>},
    {.id = "ate_loop_m",
     .label = "ATE, causal",
     .title = "Absolute trajectory error (ATE) with loop closure while running, RMSE",
     .description = "Root mean square distance between true positions and those with the corrections known "
                    "at each frame",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kLoop,
     .gate = MetricGate{MetricFamily::kAccuracy, 0.05, 2e-4},
     .value = loop_value<&LoopScore::causal_ate_m>},
    {.id = "ate_after_loop_ratio",
     .label = "causal / odometry after a loop",
     .title = "Error with loop closure relative to that of the odometry, after the first loop",
     .description = "Root mean square error from 1 s after the first loop on, with the corrections known at "
                    "each frame, relative to that of the odometry; both aligned at the start",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 2,
     .source = MetricSource::kLoop,
     .value = value_after_loop<&eval::ErrorAfterLoop::ratio>},
    {.id = "ate_after_loop_m",
     .label = "ATE, causal, after a loop",
     .description = "Root mean square distance between true positions and those with the corrections known "
                    "at each frame, from 1 s after the first loop on, aligned at the start",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kLoop,
     .value = value_after_loop<&eval::ErrorAfterLoop::causal_m>},
    {.id = "ate_odometry_after_loop_m",
     .label = "ATE, odometry, after a loop",
     .description = "Root mean square distance between true positions and those of the odometry, from 1 s "
                    "after the first loop on, aligned at the start",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kLoop,
     .value = value_after_loop<&eval::ErrorAfterLoop::odometry_m>},
    {.id = "loops",
     .label = "loops",
     .description = "Number of accepted loops",
     .decimals = 0,
     .source = MetricSource::kLoop,
     .value = loop_value<&LoopScore::loops>},
    {.id = "loop_candidates",
     .label = "loop candidates",
     .description = "Number of recognized places, accepted or not",
     .decimals = 0,
     .source = MetricSource::kLoop,
     .value = loop_value<&LoopScore::candidates>},
    {.id = "loop_keyframes",
     .label = "keyframes",
     .description = "Number of keyframes in the pose graph",
     .decimals = 0,
     .source = MetricSource::kLoop,
     .value = loop_value<&LoopScore::keyframes>},
    {.id = "loop_median_ms",
     .label = "loop closure",
     .description = "Median time of the loop closure per keyframe",
     .unit = "ms",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 2,
     .source = MetricSource::kLoop,
     .value = loop_value<&LoopScore::median_ms>},
    {.id = "relocalization_s",
     .label = "relocalization",
     .description = "Time from the first pose to the first one that is located in the loaded map",
     .unit = "s",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 2,
     .source = MetricSource::kLoop,
     .value = loop_value<&LoopScore::relocalization_s>},
    {.id = "false_loops",
     .label = "false loops",
     .description = "Number of accepted loops that are off by more than 20 cm or 5 degrees",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 0,
     .source = MetricSource::kLoop,
     .gate = MetricGate{MetricFamily::kAccuracy, 0.0, 0.5},
     .value = revisit_value<&eval::RevisitScore::false_loops>},
    {.id = "missed_loops",
     .label = "missed loops",
     .description = "Number of candidates that were refused although they are within 20 cm and 5 degrees",
     .decimals = 0,
     .source = MetricSource::kLoop,
     .value = revisit_value<&eval::RevisitScore::missed_loops>},
    {.id = "revisits",
     .label = "revisits",
     .description = "Number of keyframes within 1 m and 30 degrees of an earlier visit",
     .decimals = 0,
     .source = MetricSource::kLoop,
     .value = revisit_value<&eval::RevisitScore::revisits>},
    {.id = "revisit_recall",
     .label = "recall of revisits",
     .description = "Fraction of the revisits with an accepted loop that is not false",
     .direction = MetricDirection::kLargerIsBetter,
     .source = MetricSource::kLoop,
     .gate = MetricGate{.margin = 0.05, .floor = 0.02, .is_fraction = true},
     .value = revisit_value<&eval::RevisitScore::recall>},
};

}  // namespace stillpoint::bench
