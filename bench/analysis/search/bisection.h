// SPDX-License-Identifier: BSD-3-Clause
/// Search for the version that changed a metric, from pairs of runs of the first version and of others.
///
/// Let m be the change of the metric from the first to the last version, which is significant, and [l, u] the
/// 95 % interval of its change from the first version to version i; of an exact change l = u. Version i is
///
///   after the change if l > m / 2,  before it if u < m / 2  (signs as of m > 0)
///
/// and undecided otherwise: more pairs are needed. For failures, of which the last version has the rate r,
/// version i is after the change if its runs fail more often by the rule of missing_results.h, and before it
/// if none of n runs failed newly and (1 - r)^n <= 0.05.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/analysis/comparison.h"

namespace stillpoint::bench {

/// Where a version is relative to the change.
enum class VersionSide {
  kBefore,
  kAfter,
  kUndecided,   ///< too few pairs
  kUntestable,  ///< it cannot be built, or has no value of the metric
};

/// The runs with one metric or module only, so that a comparison tests nothing else.
/// @param metric name of a metric or of a module, or `metric_id::kFailedRuns` for none
[[nodiscard]] std::vector<StoredRun> with_metric_only(std::vector<StoredRun> runs, const std::string& metric);

/// The change between two versions that a search follows.
struct FollowedChange {
  bool failures = false;    ///< the number of failed runs; else `change`
  MetricChange change;      ///< the largest significant one of the metric
  double failure_rate = 0;  ///< of head
};

/// The change to follow, of a comparison of runs with one metric only.
/// @param looks comparisons of the same versions, with more and more pairs, of which the first significant
/// one is taken: a p-value is then significant at a fraction of the level (Bonferroni)
/// @return nullopt if the metric did not change significantly
[[nodiscard]] std::optional<FollowedChange> followed_change(const Comparison& comparison,
                                                            const std::string& metric, std::size_t looks = 1);

/// @param comparison of the first version with another one, of runs with the metric only
/// @param whole      from the first to the last version
[[nodiscard]] VersionSide side_of(const Comparison& comparison, const FollowedChange& whole);

/// "0.0071 -> 0.014 m (+98.2 %) on my_slam on office", or the number of failed runs.
[[nodiscard]] std::string change_text(const Comparison& comparison, const FollowedChange& followed);

/// Two versions between which the metric changed.
struct Bisection {
  std::size_t last_before = 0;
  std::size_t first_after = 0;
  std::vector<std::size_t> left_out;  ///< undecided and untestable versions, also between these two

  [[nodiscard]] bool is_single() const { return first_after - last_before == 1; }
};

/// Halves the range until two neighbors are known; ceil(log2(count - 1)) calls if all versions are decided.
/// Another version near the middle replaces one that is not.
/// @param count of versions, at least 2; the first is before the change, the last after it
/// @param side  called with 1 to count - 2, each at most once
[[nodiscard]] Bisection bisect_versions(std::size_t count,
                                        const std::function<VersionSide(std::size_t version)>& side);

}  // namespace stillpoint::bench
