// SPDX-License-Identifier: BSD-3-Clause
// Statistics over 5,000 random stores with planted effects: number of values, sign, certainty, and rate of
// statements without cause.
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/analysis/comparison.h"
#include "bench/analysis/history_changes.h"
#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "tests/property/planted_store.h"
#include "tests/unit/analysis/synthetic_history.h"

namespace stillpoint::bench {
namespace {

constexpr unsigned kStores = 5000;
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

/// The last two builds of a store that has at least two, with few failures.
struct PlantedSides {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
};

std::optional<PlantedSides> sides_of(unsigned seed) {
  const PlantedStore store = StorePlanter(seed, {.replicates = 8}).planted();
  if (store.builds.size() < 2) return std::nullopt;
  PlantedSides sides{runs_with(store, store.builds[store.builds.size() - 2]),
                     runs_with(store, store.builds.back())};
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    std::erase_if(*side, [](const StoredRun& run) { return run.outcome != Outcome::kOk; });
  }
  return sides;
}

/// Whether base and head have a pair with the variant and the sequence of a run.
bool has_pair(const PlantedSides& sides, const RunIdentity& identity) {
  const PairedRuns runs = paired_runs(sides.base, sides.head);
  return std::ranges::any_of(runs.pairs, [&](const RunPair& pair) {
    return subject_label(pair.base->identity) == subject_label(identity);
  });
}

/// Defects that a comparison must state, planted into the runs of head of one variant on one sequence.
enum class Defect { kSubject, kLostMetric, kInfinite, kData, kKind, kProtocol, kCount };

void plant(std::vector<StoredRun>& runs, const RunIdentity& subject, Defect defect) {
  const auto is_of_subject = [&](const StoredRun& run) {
    return subject_label(run.identity) == subject_label(subject);
  };
  if (defect == Defect::kSubject) std::erase_if(runs, is_of_subject);
  for (StoredRun& run : runs) {
    if (!is_of_subject(run)) continue;
    if (defect == Defect::kLostMetric) run.metrics.erase(run.metrics.begin());
    if (defect == Defect::kInfinite) run.metrics.front().value = std::numeric_limits<double>::infinity();
    if (defect == Defect::kData) run.identity.sequence_id += " longer";
    if (defect == Defect::kKind) run.identity.kind = "timing";
    if (defect == Defect::kProtocol) run.metrics.front().protocol = "strict:sim3";
  }
}

TEST(Statements, NameWhatVanishesAndWhatIsUnlike) {
  std::map<Defect, int> named;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    std::optional<PlantedSides> sides = sides_of(seed);
    if (!sides || sides->base.empty()) continue;
    const RunIdentity subject = sides->base[seed % sides->base.size()].identity;
    if (!has_pair(*sides, subject)) continue;
    const auto defect = static_cast<Defect>(seed % static_cast<unsigned>(Defect::kCount));
    plant(sides->head, subject, defect);
    const Comparison comparison = compare_runs(sides->base, sides->head);
    const bool vanishes = defect <= Defect::kInfinite;
    const auto is_of_subject = [&](const std::string& name) {
      return name == subject_label(subject) || name == subject.variant || name == subject.sequence;
    };
    const auto has_vanished = [&](const MissingResult& missing) {
      return missing.what != "runs" && is_of_subject(missing.subject);  // runs are left out at random
    };
    ASSERT_EQ(std::ranges::any_of(comparison.missing, has_vanished), vanishes) << seed;
    ASSERT_EQ(std::ranges::any_of(comparison.unlike, is_of_subject, &UnlikeResult::subject), !vanishes)
        << seed;
    ASSERT_NE(comparison.result(), ChangeClass::kSame) << seed;
    ASSERT_NE(comparison.result(), ChangeClass::kBetter) << seed;
    if (vanishes && comparison.pairs > 0) {
      ASSERT_GE(comparison.result(), ChangeClass::kMissing) << seed;
    }
    ++named[defect];
  }
  for (int i = 0; i < static_cast<int>(Defect::kCount); ++i)
    EXPECT_GT(named[static_cast<Defect>(i)], 100) << i;
}

TEST(Statements, OfChangesFromZeroAreDifferences) {
  int worse = 0;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    std::optional<PlantedSides> sides = sides_of(seed);
    if (!sides) continue;
    for (StoredRun& run : sides->base) run.metrics = {{"false_confidence", "", "", 0.0}};
    for (StoredRun& run : sides->head)
      run.metrics = {{"false_confidence", "", "", seed % 2 == 0 ? 0.6 : 0.0}};
    const Comparison comparison = compare_runs(sides->base, sides->head);
    for (const MetricChange& change : comparison.changes) {
      ASSERT_TRUE(change.is_absolute) << seed;
      ASSERT_DOUBLE_EQ(change.change.median, seed % 2 == 0 ? 0.6 : 0.0) << seed;
      ASSERT_EQ(change.result == ChangeClass::kSame, seed % 2 != 0) << seed;
      worse += change.result == ChangeClass::kWorse ? 1 : 0;
    }
  }
  EXPECT_GT(worse, 200);
}

TEST(Statements, OfCopiesAreThoseOfOneRun) {
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    std::optional<PlantedSides> sides = sides_of(seed);
    if (!sides) continue;
    for (std::vector<StoredRun>* side : {&sides->base, &sides->head}) {
      for (StoredRun& run : *side) {
        const char* name = side == &sides->base ? "base" : "head";
        run.blobs["trajectory"] = subject_label(run.identity) + name;
        run.metrics.front().value = side == &sides->base ? 0.01 : 0.02127;
      }
    }
    for (const RunSpread& row : run_spreads(sides->head, kMetric)) {
      ASSERT_EQ(row.spread->count, 1U) << seed;
      ASSERT_EQ(row.copies, row.runs - 1) << seed;
    }
    for (const MetricChange& change : compare_runs(sides->base, sides->head).changes) {
      if (change.metric == kMetric && change.subject.find("all sequences") == std::string::npos) {
        ASSERT_EQ(change.change.count, 1U) << seed;
      }
    }
  }
}

TEST(Statements, TheNewestBuildDoesNotDependOnTheOrderOfAMerge) {
  for (unsigned seed = 1; seed <= kStores; seed += 10) {
    PlantedStore store = StorePlanter(seed, {.replicates = 3}).planted();
    for (StoredRun& run : store.runs) {
      run.committed = "2026-01-0" + std::to_string(1 + std::ranges::find(store.builds, run.identity.build) -
                                                   store.builds.begin());
      run.started = "2026-02-0" + std::to_string(1 + seed % 9);
    }
    std::mt19937_64 random(seed);
    std::ranges::shuffle(store.runs, random);
    for (std::size_t i = 0; i < store.runs.size(); ++i) store.runs[i].id = static_cast<std::int64_t>(i);
    ASSERT_EQ(newest_build(store.runs), store.builds.back()) << seed;
  }
}

TEST(Statements, OverAllSequencesAreNotMadeByTheEffectsOfSingleSequences) {
  FalseAlarms alarms;
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<StoredRun> runs;
    const std::size_t sequences = 2 + seed % 9;
    for (std::size_t i = 0; i < sequences; ++i) {
      const double effect =
          std::exp(0.3 * normal(random));  // of the variant on this sequence; none on average
      for (int k = 1; k <= 8; ++k) {
        for (const char* variant : {"base", kChangedVariant}) {
          StoredRun run;
          run.identity = {.variant = variant, .sequence = fmt::format("s{}", i), .seed = k};
          run.metrics = {
              {kMetric, "", "m", (variant[0] == 'b' ? 1.0 : effect) * std::exp(0.05 * normal(random))}};
          runs.push_back(run);
        }
      }
    }
    const AblationRow all = ablation(runs, "base", kMetric).front();
    ASSERT_EQ(all.change->count, sequences);
    ASSERT_EQ(all.change->interval.has_value(), sequences >= kSmallestCount);
    if (all.change->interval) alarms.add(eval::is_significant(*all.change));
  }
  report("significant effects over all sequences", alarms, 0.05);
}

}  // namespace
}  // namespace stillpoint::bench
