// SPDX-License-Identifier: BSD-3-Clause
/// Change detection in the metric history: level shifts and drifts, and which of them are open regressions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/analysis/commit_history.h"
#include "bench/store/store.h"
#include "eval/statistics/change_points.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::bench {

enum class ChangeState {
  kOpen,      ///< regression: worse by more than the margin of the metric, up to the newest commit
  kAccepted,  ///< regression that was accepted, with a reason
  kResolved,  ///< regression in the past; the newest level is as good as the level before it
  kImproved,
  kNeutral,  ///< a metric without a good direction
};

/// "open", "accepted", "resolved", "improved" or "neutral".
[[nodiscard]] std::string state_name(ChangeState state);

/// Abrupt change of a metric between two consecutive measured commits.
struct LevelShift {
  std::size_t series = 0;     ///< index
  std::size_t before = 0;     ///< index of the last commit of the old level
  std::size_t after = 0;      ///< index of the first commit of the new level
  double level_before = 0.0;  ///< median of the segment before; `level_after`: of the segment after
  double level_after = 0.0;
  std::optional<eval::RelativeChange> change;  ///< nullopt for failed runs, and if the old level is 0
  double p_value = 0.0;
  ChangeState state = ChangeState::kNeutral;
  std::string reason;  ///< of the acceptance
  std::string
      missing{};  ///< why there is no new level: "no value", "other data" or "not measured"; else empty
};

/// Gradual change of a metric: small at each commit, significant over many. Detected by a linear trend.
struct MetricDrift {
  std::size_t series = 0;
  std::size_t first = 0;  ///< index of the first commit of the trend
  std::size_t last = 0;   ///< index of the last commit
  double start = 0.0;     ///< value of the fitted line at `first`
  double end = 0.0;       ///< value of the fitted line at `last`
  double change = 0.0;    ///< (end - start) / |start|
  double p_value = 1.0;
  bool worse = false;
  bool is_accepted = false;  ///< an acceptance covers all of it that is relevant

  [[nodiscard]] bool is_open() const { return worse && !is_accepted; }
};

struct HistoryChanges {
  std::vector<LevelShift> shifts;
  std::vector<MetricDrift> drifts;
};

/// Number of newest commits that are tested for changes; the run time is quadratic in it. Older values are
/// displayed only.
inline constexpr std::size_t kMaxAnalyzedCommits = 300;

/// Detects changes in all series, in their order.
///
/// Level shifts are change points of E-divisive (eval/statistics/change_points.h). A change point counts if
/// the levels differ by at least the margin and the floor of the metric (`MetricGate`), the 95 % confidence
/// interval of the change excludes 0, and the step at the change point itself reaches the same limits after a
/// trend that both levels share is removed (`eval::step_beside_trend`). A slow change is therefore listed as
/// a drift, also if it consists of many steps below the margin; at most 6 of 180 simulated ones still count
/// as a level shift (`drift_validation_test`). A drift is a linear trend with p
/// <= 0.005 that exceeds the same limits and fits better than the level shifts; for the worse, it is a
/// finding as a regression is. The fraction of failed runs needs no test: it is a regression if it is larger
/// at the newest commit than at an earlier one.
///
/// Metrics without noise need no forty commits: if a deterministic metric (`MetricGate::repeatable`)
/// typically changes by less than a tenth of its margin from commit to commit, each change beyond margin and
/// floor is a level shift that two commits before and three after it confirm.
///
/// What vanishes is an open regression: a metric that the newest successful runs of a subject lack; a subject
/// that continues with other data of the same name; and a subject that the newest commit of its machine, mode
/// and kind lacks, although it has more than half of those that were measured with the subject before. The
/// last two are listed for the headline metric of the subject.
[[nodiscard]] HistoryChanges history_changes(const CommitHistory& history,
                                             std::span<const Acceptance> acceptances,
                                             const eval::ChangePointOptions& options = {});

/// The newest one to five values of a series: all differ from the median of the earlier ones of its level by
/// more than margin and floor, in one direction, and their median is outside of the range of these.
struct SuspectedChange {
  std::size_t series = 0;  ///< index
  std::size_t before = 0;  ///< commit indices, as in `LevelShift`
  std::size_t after = 0;
  double level_before = 0.0;  ///< median of the earlier values
  double level_after = 0.0;   ///< median of the newest values
  std::size_t count_before = 0;
  std::size_t count_after = 0;
  /// Mann-Whitney, two-sided, times the number of tried commits; at most 1. With few commits it is large
  /// whatever the step.
  double p_value = 1.0;
  bool is_exact = false;  ///< the earlier values of a repeatable metric, at least two, are equal: no noise
  bool worse = false;
};

/// A difference in units of what is relevant, the larger one of margin and floor of the metric; infinite if
/// that is 0.
[[nodiscard]] double size_in_margins(double before, double after, const MetricDescriptor& gated);

/// Suspected changes that are no shifts of `changes`, in the order of `precedes`. They are no findings.
[[nodiscard]] std::vector<SuspectedChange> suspected_changes(const CommitHistory& history,
                                                             const HistoryChanges& changes);

/// Order of changes: failures and missing results (infinite size), accuracy before cost, then by size.
/// @param size as `size_in_margins`
[[nodiscard]] bool precedes(const MetricDescriptor* a, double size_a, const MetricDescriptor* b,
                            double size_b);

/// Smallest relative step of a family of metrics that the newest commit could show as a suspected change: the
/// median over its series of the distance from the median to the farthest of the earlier values of the newest
/// level, at least the margin; nullopt without a level of two values.
[[nodiscard]] std::optional<double> visible_step(const CommitHistory& history, const HistoryChanges& changes,
                                                 MetricFamily family);

}  // namespace stillpoint::bench
