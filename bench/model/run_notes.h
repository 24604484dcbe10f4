// SPDX-License-Identifier: BSD-3-Clause
/// Footnotes of tables on what makes runs incomparable or doubtful: frames without recorded boxes, a metric
/// whose value depends on the evaluation protocol, data that contradicts what is stated about it, and times
/// that were measured while other processes used the machine.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Errors over fractions of the frames that differ by more than this are not ranked: a run that lost most of
/// its track has a small error over the rest.
inline constexpr double kMaxCoverageGap = 0.2;

/// The notes that are not empty, separated by semicolons.
[[nodiscard]] std::string joined_notes(std::initializer_list<std::string> notes);

/// Footnote about the run with the most frames without recorded boxes: "no recorded boxes in 12 of 240
/// frames", and "in up to 12 of 240 frames" for several runs; empty if there is no such run. Failed runs are
/// ignored.
[[nodiscard]] std::string missing_boxes_note(const std::vector<const StoredRun*>& runs);

/// Footnote about a metric for which a "strict:*" protocol differs by a factor of 2 or more, in either
/// direction, and by more than the floor of the metric's gate, in at least one run: "ATE 0.0021 m by
/// compat:tum, 0.0089 m by strict:se3 (medians of 3 runs; differ by a factor of 2 or more in 1)".
/// @param runs of one variant on one sequence; failed ones are ignored
/// @param metric id, e.g. "ate_rmse_m"
/// @return names both protocols and both values; empty without such a difference
[[nodiscard]] std::string protocol_difference_note(std::span<const StoredRun* const> runs,
                                                   std::string_view metric);

/// Footnote about an RPE, by any protocol, of fewer than ten pairs of poses in at least one run: "RPE of only
/// 4 pairs of poses: not ranked"; empty for other metrics, and for runs that did not record the number.
/// @param runs of one variant on one sequence; failed ones are ignored
/// @param metric name, e.g. "rpe_trans_rmse_m_per_s"
[[nodiscard]] std::string few_rpe_pairs_note(std::span<const StoredRun* const> runs, std::string_view metric);

/// Footnote about an error that differs by a factor of 2 or more, and by more than the floor of its gate,
/// between runs on the same data: starts, seeds or perturbations of one recording. One run of them tells
/// little: "ATE 0.0033 m to ATE 0.0278 m on the same data, a factor of 8.4: one run is no result". Empty for
/// other metrics.
/// @param runs of one variant on one sequence; failed ones are ignored
/// @param metric id, e.g. "ate_rmse_m"
[[nodiscard]] std::string scatter_note(std::span<const StoredRun* const> runs, std::string_view metric);

/// Footnote on why errors are doubtful though the run succeeded, as another unit or body frame than that of
/// the ground truth: the `detail` of the first such run. Empty for a metric that is no error.
/// @param runs of one variant on one sequence; failed ones are ignored
/// @param metric id, e.g. "ate_rmse_m"
[[nodiscard]] std::string doubtful_error_note(std::span<const StoredRun* const> runs,
                                              std::string_view metric);

/// What the innovations of a run say about its data: one phrase for a mean NIS of the images above 4, and one
/// for that of the IMU above 3 (metrics `nis_reprojection`, `nis_inertial`; 1 is consistent).
[[nodiscard]] std::vector<std::string> innovation_doubts(std::optional<double> nis_reprojection,
                                                         std::optional<double> nis_inertial);

/// Footnote with these phrases about the run with the most of them: "NIS inertial 10.2: the IMU is noisier
/// than stated; see `stillpoint diagnose`". Failed runs are ignored.
/// @param runs of one variant on one sequence
[[nodiscard]] std::string innovation_note(std::span<const StoredRun* const> runs);

/// How far the times of a run are its own; the best first.
enum class TimeSource {
  kUndisturbed,  ///< timing run on an idle machine
  kBusy,         ///< timing run while other processes used the machine, see the metric "quiet"
  kShared,       ///< no timing run: other runs may have executed at the same time
};

[[nodiscard]] TimeSource time_source(const StoredRun& run);

/// Restriction of times from this source and its remedy, as a footnote; empty for undisturbed times.
[[nodiscard]] std::string time_source_note(TimeSource source);

}  // namespace stillpoint::bench
