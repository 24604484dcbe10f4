// SPDX-License-Identifier: BSD-3-Clause
// Statistics over 2,000 random stores with planted effects: number of values, sign, certainty, and rate of
// statements without cause.
#include <iostream>

#include <gtest/gtest.h>

#include "bench/analysis/comparison.h"
#include "bench/analysis/history_changes.h"
#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "tests/property/planted_store.h"
#include "tests/unit/analysis/synthetic_history.h"

namespace stillpoint::bench {
namespace {

constexpr unsigned kStores = 2000;
constexpr const char* kMetric = "ate_rmse_m";

void report(const char* what, const FalseAlarms& alarms, double rate) {
  std::cout << what << ": " << alarms.made << " of " << alarms.possible << ", limit " << alarms.limit(rate)
            << '\n';
  EXPECT_LE(alarms.made, alarms.limit(rate)) << what;
}

TEST(Statements, OfSpreadsHaveTheRightCountAndCoverTheMedian) {
  FalseAlarms misses;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    const PlantedStore store = StorePlanter(seed, {}).planted();
    ASSERT_EQ(newest_build(store.runs), store.builds.back());
    const std::vector<StoredRun> runs = runs_with(store, store.builds.back());
    for (const RunSpread& row : run_spreads(runs, kMetric)) {
      const std::size_t count = succeeded(runs, row.variant, row.sequence);
      ASSERT_EQ(row.runs - row.failed, count) << seed;
      ASSERT_EQ(row.spread.has_value(), count > 0) << seed;
      if (count == 0) continue;
      ASSERT_EQ(row.spread->count, count) << seed;
      ASSERT_EQ(row.spread->median_interval.has_value(), count >= kSmallestCount) << seed;
      if (!row.spread->median_interval || row.variant != store.base) continue;
      const double median = store.medians.at(row.sequence);
      misses.add(median < row.spread->median_interval->low || median > row.spread->median_interval->high);
    }
  }
  report("intervals that miss the median", misses, 0.05);
}

TEST(Statements, OfAblationsHaveTheRightCountSignAndCertainty) {
  FalseAlarms alarms;
  int detected = 0;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    const PlantedStore store = StorePlanter(seed, {}).planted();
    const std::vector<StoredRun> runs = runs_with(store, store.builds.back());
    const std::vector<AblationRow> rows = ablation(runs, store.base, kMetric);
    const AblationRow& all = rows.front();
    ASSERT_EQ(all.variant, kChangedVariant);
    const std::size_t count = paired_values(runs, store.base);
    ASSERT_EQ(all.change.has_value(), count > 0) << seed;
    if (count == 0) continue;
    ASSERT_EQ(all.change->count, count) << seed;
    ASSERT_EQ(all.difference->count, count) << seed;
    ASSERT_EQ(all.change->interval.has_value(), count >= kSmallestCount) << seed;
    const bool is_certain = eval::is_significant(*all.change);
    if (count < kSmallestCount) {
      ASSERT_FALSE(is_certain) << seed;
    } else if (store.variant_effect == 1.0) {
      alarms.add(is_certain);
    } else if (is_certain) {
      ASSERT_EQ(sign_of(all.change->median), sign_of(store.variant_effect - 1.0)) << seed;
      ++detected;
    }
  }
  report("significant differences between equal variants", alarms, 0.05);
  EXPECT_GT(detected, 200);
}

/// Whether a deciding change contradicts the planted effects.
bool is_false(const MetricChange& change, double effect) {
  const int planted = change.metric == kMetric ? sign_of(effect - 1.0) : 0;
  if (!change.decides || change.result == ChangeClass::kSame || change.result == ChangeClass::kInconclusive)
    return false;
  return (change.result == ChangeClass::kWorse ? 1 : -1) != planted;
}

TEST(Statements, OfComparisonsHaveTheRightCountsAndClasses) {
  FalseAlarms alarms;
  int detected = 0;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    const PlantedStore store = StorePlanter(seed, {}).planted();
    if (store.builds.size() < 2) continue;
    const std::vector<StoredRun> base = runs_with(store, store.builds[store.builds.size() - 2]);
    const std::vector<StoredRun> head = runs_with(store, store.builds.back());
    const Comparison comparison = compare_runs(base, head);
    std::size_t newly_failed = 0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < base.size(); ++i) {  // equal order
      const bool base_ok = base[i].outcome == Outcome::kOk;
      compared += base_ok && head[i].outcome == Outcome::kOk ? 1 : 0;
      newly_failed += base_ok && head[i].outcome != Outcome::kOk ? 1 : 0;
    }
    ASSERT_EQ(comparison.pairs, base.size()) << seed;
    ASSERT_EQ(comparison.compared, compared) << seed;
    ASSERT_EQ(comparison.newly_failed, newly_failed) << seed;
    ASSERT_TRUE(comparison.missing.empty()) << seed;  // nothing is removed
    const bool fails_more_often = comparison.failures == ChangeClass::kWorse;
    if (fails_more_often) {
      ASSERT_EQ(comparison.result(), ChangeClass::kWorse) << seed;
      ASSERT_GT(newly_failed, 0U) << seed;
    }
    bool is_any_false = false;
    for (const MetricChange& change : comparison.changes) {
      is_any_false = is_any_false || is_false(change, store.build_effect);
      const bool is_class = change.result == ChangeClass::kWorse || change.result == ChangeClass::kBetter;
      if (is_class) {
        ASSERT_LE(change.change.p_value, change.level) << seed;
      }
      detected += is_class && change.metric == kMetric && !is_false(change, store.build_effect) ? 1 : 0;
    }
    alarms.add(is_any_false);
  }
  report("comparisons with a class that is not planted", alarms, 0.05);
  EXPECT_GT(detected, 200);
}

TEST(Statements, OfHistoriesHaveTheRightSign) {
  FalseAlarms alarms;
  int detected = 0;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    std::mt19937_64 random(seed);
    const std::size_t before = 1 + random() % 30;
    const std::size_t after = 1 + random() % 30;
    const int planted = static_cast<int>(random() % 3) - 1;
    std::vector<double> values;
    append_level(values, before, 1.0, 0.03, random);
    append_level(values, after, 1.0 + 0.4 * planted, 0.03, random);
    const std::vector<LevelShift> shifts = history_changes(history_of("ms", {values}), {}).shifts;
    if (planted == 0) alarms.add(!shifts.empty());
    for (const LevelShift& shift : shifts) {
      if (planted == 0 || shifts.size() > 1) continue;
      ASSERT_TRUE(shift.change && eval::is_significant(*shift.change)) << seed;
      ASSERT_EQ(sign_of(shift.change->median), planted) << seed;
      ASSERT_EQ(shift.state, planted > 0 ? ChangeState::kOpen : ChangeState::kImproved) << seed;
      ++detected;
    }
  }
  report("shifts of constant histories", alarms, 0.005);
  EXPECT_GT(detected, 200);
}

}  // namespace
}  // namespace stillpoint::bench
