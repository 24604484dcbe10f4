// SPDX-License-Identifier: BSD-3-Clause
/// How much of a sequence has a pose at all, and how much has a correct one: what stands beside every error.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "eval/trajectory/association.h"

namespace stillpoint {

/// Share of the expected stamps with a pose at most `tolerance_s` away, each pose counted once. Nothing when
/// nothing is expected.
/// @param expected strictly rising, e.g. the frame times of the sequence
[[nodiscard]] std::optional<double> coverage(const Trajectory& est, std::span<const Timestamp> expected,
                                             double tolerance_s = 1e-3);

/// Seconds from `start` to the first pose; nothing without a pose.
[[nodiscard]] std::optional<double> first_pose_seconds(const Trajectory& est, Timestamp start);

struct TimeSpan {
  Timestamp begin;
  Timestamp end;
};

/// Parts of `whole` in which no pose stands: a pose stands from its stamp to the next one, at most
/// `max_hold_s`. In order of time.
[[nodiscard]] std::vector<TimeSpan> lost_spans(const Trajectory& est, const TimeSpan& whole,
                                               double max_hold_s);

/// Share of `whole` outside the lost spans; nothing when it has no extent.
[[nodiscard]] std::optional<double> time_coverage(std::span<const TimeSpan> lost, const TimeSpan& whole);

/// When a pose counts as correct, and for how long.
struct CorrectRateOptions {
  double max_translation_m = std::numeric_limits<double>::infinity();
  double max_rotation_deg = std::numeric_limits<double>::infinity();
  double max_hold_s = 1.0;  ///< a pose stands until the next one, at most this long
};

/// Correct rate of OpenLORIS-Scene (Shi et al., ICRA 2020): the time for which a correct pose stands, over
/// the time of the ground truth. The estimate is laid over the ground truth rigidly by all matches; ground
/// truth is interpolated over gaps below 1 s. 0 when no pose matches; nothing when the ground truth has no
/// extent.
[[nodiscard]] std::optional<double> correct_rate(const Trajectory& gt, const Trajectory& est,
                                                 const CorrectRateOptions& options = {},
                                                 double offset_s = 0.0);

/// Time [s] for which correct poses stand. `errors_m` and `errors_deg` belong to `matches`.
/// @param end the last pose stands until here
[[nodiscard]] double correct_seconds(std::span<const MatchedPose> matches, std::span<const double> errors_m,
                                     std::span<const double> errors_deg, Timestamp end,
                                     const CorrectRateOptions& options);

}  // namespace stillpoint
