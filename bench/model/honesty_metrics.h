// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of claimed errors, and of runs with injected sensor faults; definitions in
/// eval/metrics/consistency.h.
#pragma once

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// The value of one member of `eval::Honesty`; nullopt for a run without faults.
template <auto kMember>
[[nodiscard]] std::optional<double> honesty_value(const Measurements& m) {
  return m.honesty ? std::optional<double>((*m.honesty).*kMember) : std::nullopt;
}

/// nullopt for a system that claims no standard deviations.
[[nodiscard]] inline std::optional<double> claimed_three_sigma(const Measurements& m) {
  return m.counts ? m.counts->claimed_three_sigma_m : std::nullopt;
}

/// The value of one member of `eval::MeanNees`; nullopt without claimed covariances or ground truth.
template <auto kMember>
[[nodiscard]] std::optional<double> nees_value(const Measurements& m) {
  return m.counts && m.counts->nees ? std::optional<double>((*m.counts->nees).*kMember) : std::nullopt;
}

/// The value of one member of `RunCounts`; nullopt without claimed covariances or inertial data.
template <auto kMember>
[[nodiscard]] std::optional<double> nis_value(const Measurements& m) {
  return m.counts ? (*m.counts).*kMember : std::nullopt;
}

inline constexpr MetricDescriptor kHonestyMetrics[] = {
    {.id = metric_id::kClaimedThreeSigma,
     .label = "claimed 3 sigma",
     .description = "Median over the located frames of three claimed standard deviations of the position, "
                    "along its least certain direction",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kRun,
     .value = claimed_three_sigma},
    {.id = metric_id::kNeesPosition,
     .label = "NEES position",
     .description = "Mean over the frames from 3 s on of the squared position error relative to the first "
                    "pose, normalized by its claimed covariance, divided by 3; 1 is consistent",
     .decimals = 2,
     .source = MetricSource::kRun,
     .value = nees_value<&eval::MeanNees::position>},
    {.id = metric_id::kNeesRotation,
     .label = "NEES rotation",
     .description = "As NEES position, of the rotation",
     .decimals = 2,
     .source = MetricSource::kRun,
     .value = nees_value<&eval::MeanNees::rotation>},
    {.id = "nis_reprojection",
     .label = "NIS reprojection",
     .description =
         "Mean over the located frames of the squared reprojection error of static landmarks at the "
         "pose predicted by inertial data, normalized by its covariance; of each frame the median "
         "divided by that of the distribution, so that 1 is consistent",
     .decimals = 2,
     .source = MetricSource::kRun,
     .value = nis_value<&RunCounts::nis_reprojection>},
    {.id = "nis_inertial",
     .label = "NIS inertial",
     .description =
         "Mean over the located frames of the squared difference of the pose by vision alone and the "
         "pose predicted by inertial data, normalized by the covariance of both, divided by 6; 0.2 "
         "to 0.3 with exact sensors, because that covariance is too large; above 1, the noise is too small",
     .decimals = 2,
     .source = MetricSource::kRun,
     .value = nis_value<&RunCounts::nis_inertial>},
    {.id = metric_id::kFalseConfidence,
     .label = "false confidence",
     .title = "False confidence: fraction of the frames called located with a wrong pose",
     .description =
         "Fraction of the frames whose pose was called located, but is wrong by more than 5 cm or "
         "2 degrees and three claimed standard deviations, in excess of the drift before the fault",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kHonesty,
     .gate = MetricGate{.margin = 0.01, .floor = 0.005, .is_fraction = true},
     .value = honesty_value<&eval::Honesty::false_confidence>},
    {.id = metric_id::kMissedAvailability,
     .label = "missed availability",
     .title = "Missed availability: fraction of the frames called lost with a good pose",
     .description =
         "Fraction of the frames that were called lost although the pose is within 5 cm and 2 degrees",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kHonesty,
     .gate = MetricGate{.margin = 0.01, .floor = 0.02, .is_fraction = true},
     .value = honesty_value<&eval::Honesty::missed_availability>},
    {.id = metric_id::kTimeToDetect,
     .label = "time to detect",
     .title = "Time to detect a wrong pose",
     .description =
         "Time from the first wrong pose after the begin of a fault to the first frame that is not "
         "called located",
     .unit = "s",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 3,
     .source = MetricSource::kHonesty,
     .gate = MetricGate{.margin = 0.05, .floor = 0.1, .absent_is_good = true},
     .value = honesty_value<&eval::Honesty::time_to_detect_s>},
    {.id = metric_id::kTimeToRecover,
     .label = "time to recover",
     .title = "Time to recover from a fault",
     .description = "Time from the end of the last fault to the first right pose in the same world",
     .unit = "s",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 3,
     .source = MetricSource::kHonesty,
     .gate = MetricGate{MetricFamily::kAccuracy, 0.05, 0.1},
     .value = honesty_value<&eval::Honesty::time_to_recover_s>},
    {.id = metric_id::kErrorAfterRecovery,
     .label = "error after recovery",
     .title = "Error after the recovery from a fault, RMSE",
     .description = "Root mean square position error after the recovery, aligned before the fault",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kHonesty,
     .gate = MetricGate{MetricFamily::kAccuracy, 0.05, 2e-3},
     .value = honesty_value<&eval::Honesty::error_after_recovery_m>},
};

}  // namespace stillpoint::bench
