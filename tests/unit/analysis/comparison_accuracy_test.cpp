// SPDX-License-Identifier: BSD-3-Clause
// Accuracy in comparisons: replicates, and pooling over sequences.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "bench/analysis/comparison.h"
#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

/// Error of a replicate: chaotic decisions change it by some percent.
double scattered(double error, std::mt19937_64& random) {
  return error * std::exp(std::normal_distribution<double>(0.0, 0.05)(random));
}

struct Sides {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
};

/// Replicates on one sequence, whose error changes by a factor at head.
Sides replicates(int count, double factor, const std::string& sequence = "a") {
  std::mt19937_64 random(1);
  Sides sides;
  for (int i = 1; i <= count; ++i) {
    sides.base.push_back(compared_run(sequence, scattered(0.01, random), i));
    sides.head.push_back(compared_run(sequence, scattered(0.01 * factor, random), i, "head"));
  }
  return sides;
}

const MetricChange& change_on(const Comparison& comparison, const std::string& subject) {
  for (const MetricChange& change : comparison.changes) {
    if (change.metric == "ate_rmse_m" && change.subject == subject) return change;
  }
  throw std::runtime_error("no change on " + subject);
}

bool has_note(const Comparison& comparison, const std::string& words) {
  return std::any_of(comparison.notes.begin(), comparison.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(ComparisonAccuracy, AChangeOfOneReplicateIsNotWorseHoweverLarge) {
  const Sides sides{{compared_run("a", 0.01, 1)}, {compared_run("a", 0.02, 1, "head")}};
  const Comparison comparison = compare_runs(sides.base, sides.head);
  const MetricChange& change = change_on(comparison, "vo on a");
  EXPECT_EQ(change.result, ChangeClass::kInconclusive);
  EXPECT_TRUE(change.changed);
  EXPECT_NEAR(change.change.median, 1.0, 1e-12);
  EXPECT_FALSE(change.change.interval.has_value());
  // One test: 4 replicates per side reach 2 / 70 = 0.029, 6 pairs 2^-5 = 0.031.
  EXPECT_EQ(change.needed, 4u);
  EXPECT_EQ(change.needed_seeds, 6u);
  EXPECT_TRUE(has_note(comparison, "1 replicate cannot go below p = 1, ")) << comparison.notes.front();
  EXPECT_TRUE(has_note(comparison, "but a significant change requires p <= 0.05"))
      << comparison.notes.front();
  EXPECT_TRUE(has_note(comparison, "store 4 perturbations or 6 seeds of each")) << comparison.notes.front();
  const Comparison executed = compare_runs(sides.base, sides.head, CompareSource::kPrograms);
  EXPECT_TRUE(has_note(executed, "run with --pairs 4")) << executed.notes.front();
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive);
}

TEST(ComparisonAccuracy, AChangeBelowTheMarginIsTheSame) {
  const Sides sides{{compared_run("a", 0.01, 1)}, {compared_run("a", 0.01 * 1.04, 1, "head")}};
  EXPECT_EQ(compare_runs(sides.base, sides.head).result(), ChangeClass::kSame);
}

// Single runs of a program with a scatter of 5 % agree to the margin in half of all cases, whatever changed.
TEST(ComparisonAccuracy, TooFewRunsOfAnotherSystemForAnIntervalAreOnlyTheSameIfTheyAreEqual) {
  const auto result = [](const std::string& system, const std::string& mode, double factor) {
    Sides sides{{compared_run("a", 0.01, 1)}, {compared_run("a", 0.01 * factor, 1, "head")}};
    for (StoredRun* run : {&sides.base.front(), &sides.head.front()}) {
      run->identity.system = system;
      run->identity.mode = mode;
    }
    return compare_runs(sides.base, sides.head).result();
  };
  EXPECT_EQ(result("slam", "sequential", 1.04), ChangeClass::kInconclusive);
  EXPECT_EQ(result("stillpoint", "realtime", 1.04), ChangeClass::kInconclusive);
  EXPECT_EQ(result("slam", "sequential", 1.0), ChangeClass::kSame);
  EXPECT_EQ(result("stillpoint", "sequential", 1.04), ChangeClass::kSame);
}

TEST(ComparisonAccuracy, RepetitionsOfADeterministicProgramAreOneReplicate) {
  Sides sides = replicates(12, 1.0);
  for (StoredRun& run : sides.base) run.blobs["trajectory"] = "t1";
  for (StoredRun& run : sides.head) run.blobs["trajectory"] = "t2";
  for (StoredRun& run : sides.base) run.metrics.front().value = 0.01;
  for (StoredRun& run : sides.head) run.metrics.front().value = 0.02;
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_EQ(change_on(comparison, "vo on a").change.count, 1u);
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive);
}

/// Two repetitions per side and sequence; those of a deterministic program are equal.
Sides repeated(int sequences, double factor, bool deterministic) {
  Sides sides;
  for (int s = 0; s < sequences; ++s) {
    for (const bool is_base : {true, false}) {
      for (int repetition = 1; repetition <= 2; ++repetition) {
        const double ate = 0.01 * (is_base ? 1.0 : factor) * (deterministic || repetition == 1 ? 1.0 : 1.01);
        StoredRun run = compared_run("s" + std::to_string(s), ate, 1, is_base ? "base" : "head");
        run.identity.repetition = repetition;
        (is_base ? sides.base : sides.head).push_back(std::move(run));
      }
    }
  }
  return sides;
}

TEST(ComparisonAccuracy, ADeterministicChangeIsAFactWithOnePairPerSequence) {
  for (const int sequences : {1, 2, 3, 12}) {
    const Sides worse = repeated(sequences, 1.1, true);
    const Comparison comparison = compare_runs(worse.base, worse.head);
    EXPECT_EQ(comparison.result(), ChangeClass::kWorse) << sequences;
    const MetricChange& change = change_on(comparison, "vo on s0");
    EXPECT_EQ(change.test, ChangeTest::kExact);
    EXPECT_EQ(change.change.count, 1u);
    EXPECT_NEAR(change.change.median, 0.1, 1e-9);
    const Sides better = repeated(sequences, 0.9, true);
    EXPECT_EQ(compare_runs(better.base, better.head).result(), ChangeClass::kBetter);
    const Sides within_margin = repeated(sequences, 1.04, true);
    EXPECT_EQ(compare_runs(within_margin.base, within_margin.head).result(), ChangeClass::kSame);
  }
}

TEST(ComparisonAccuracy, AChangeIsNoFactUnlessRepetitionsOfBothSidesAreBitEqual) {
  const Sides random = repeated(1, 1.1, false);
  EXPECT_EQ(compare_runs(random.base, random.head).result(), ChangeClass::kInconclusive);
  Sides one_side = repeated(3, 1.1, true);
  for (StoredRun& run : one_side.head) {
    if (run.identity.repetition == 2) run.blobs["trajectory"] += " other";
  }
  EXPECT_EQ(compare_runs(one_side.base, one_side.head).result(), ChangeClass::kInconclusive);
  Sides failing = repeated(1, 1.1, true);
  failing.base[1].outcome = failing.head[1].outcome = Outcome::kCrashed;
  EXPECT_EQ(compare_runs(failing.base, failing.head).result(), ChangeClass::kInconclusive);
  Sides single = repeated(3, 1.1, true);
  for (std::vector<StoredRun>* side : {&single.base, &single.head})
    std::erase_if(*side, [](const StoredRun& run) { return run.identity.repetition == 2; });
  const Comparison comparison = compare_runs(single.base, single.head);
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive);
  EXPECT_TRUE(has_note(comparison, "or execute each run 2 times: bit-equal repetitions"));
  Sides without_trajectories = repeated(3, 1.1, true);
  for (std::vector<StoredRun>* side : {&without_trajectories.base, &without_trajectories.head}) {
    for (StoredRun& run : *side) run.blobs.clear();
  }
  EXPECT_EQ(compare_runs(without_trajectories.base, without_trajectories.head).result(),
            ChangeClass::kInconclusive);
}

/// A program with two results, executed `repetitions` times per side on one sequence.
/// @param results bit i: whether run i has the second result; the runs of base are first
Comparison comparison_of_results(const std::string& system, int repetitions, unsigned results) {
  Sides sides;
  for (int i = 0; i < 2 * repetitions; ++i) {
    const double ate = (results >> i & 1U) == 0 ? 0.01 : 0.02;
    StoredRun run = compared_run("a", ate, 1, i < repetitions ? "base" : "head");
    run.identity.system = system;
    run.identity.repetition = i % repetitions + 1;
    (i < repetitions ? sides.base : sides.head).push_back(std::move(run));
  }
  return compare_runs(sides.base, sides.head);
}

// Both sides are the same program: all combinations of results are equally likely.
TEST(ComparisonAccuracy, AProgramWithTwoResultsIsRarelyCalledWorseOrBetterThanItself) {
  for (const int repetitions : {2, 3, 4}) {
    const unsigned combinations = 1U << (2 * repetitions);
    unsigned called = 0;
    for (unsigned results = 0; results < combinations; ++results) {
      const ChangeClass result = comparison_of_results("slam", repetitions, results).result();
      called += result == ChangeClass::kWorse || result == ChangeClass::kBetter ? 1 : 0;
    }
    EXPECT_LE(called, kSignificance * combinations) << repetitions << " repetitions";
  }
}

TEST(ComparisonAccuracy, BitEqualRepetitionsOfAnotherProgramAreAFactFromThreeOn) {
  constexpr unsigned kChange = 0b111000, kChangeOfTwo = 0b1100;
  EXPECT_EQ(comparison_of_results("slam", 3, kChange).result(), ChangeClass::kWorse);
  EXPECT_EQ(comparison_of_results("stillpoint", 2, kChangeOfTwo).result(), ChangeClass::kWorse);
  const Comparison two = comparison_of_results("slam", 2, kChangeOfTwo);
  EXPECT_EQ(two.result(), ChangeClass::kInconclusive);
  EXPECT_TRUE(has_note(two, "or execute each run 3 times: bit-equal repetitions"));
  const RunIdentity other{.system = "slam"}, own{}, own_realtime{.mode = "realtime"};
  EXPECT_EQ(exact_repetitions(other, 2), 4u);  // 2 * 2 / 4^3 > 0.05
  EXPECT_EQ(exact_repetitions(other, 6), 4u);
  EXPECT_EQ(exact_repetitions(other, 7), 5u);
  EXPECT_EQ(exact_repetitions(own, 100), 2u);
  EXPECT_EQ(exact_repetitions(own_realtime, 1), 3u);
}

TEST(ComparisonAccuracy, AChangeOf20PercentOverPerturbationsIsDetected) {
  const Sides worse = replicates(6, 1.2);
  const Comparison comparison = compare_runs(worse.base, worse.head);
  EXPECT_EQ(change_on(comparison, "vo on a").result, ChangeClass::kWorse);
  EXPECT_EQ(change_on(comparison, "vo on a").test, ChangeTest::kReplicates);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
  const Sides better = replicates(6, 0.8);
  EXPECT_EQ(compare_runs(better.base, better.head).result(), ChangeClass::kBetter);
}

TEST(ComparisonAccuracy, AChangeOf20PercentOverSeedsIsDetected) {
  Sides sides = replicates(6, 1.2);
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side) {
      RunIdentity& identity = run.identity;
      identity.seed = std::exchange(identity.repetition, 1);
      identity.sequence_id += std::to_string(identity.seed);
      identity.config_hash = std::to_string(identity.seed);
      run.metrics.front().value *=
          static_cast<double>(identity.seed);  // the scenes are not equally difficult
    }
  }
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_EQ(change_on(comparison, "vo on a").test, ChangeTest::kPairs);
  EXPECT_EQ(change_on(comparison, "vo on a").change.count, 6u);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
}

/// `count` seeds of each sequence, on other data, with 1.5 times the error at head.
Sides seeds_of(const std::vector<std::string>& sequences, int count) {
  Sides sides;
  for (const std::string& sequence : sequences) {
    for (int seed = 1; seed <= count; ++seed) {
      for (const bool is_base : {true, false}) {
        const double error = 0.01 * seed * (is_base ? 1.0 : 1.5);
        StoredRun run = compared_run(sequence, error, 1, is_base ? "base" : "head");
        run.identity.seed = seed;
        run.identity.sequence_id += std::to_string(seed);
        (is_base ? sides.base : sides.head).push_back(std::move(run));
      }
    }
  }
  return sides;
}

TEST(ComparisonAccuracy, TheNumberOfSeedsThatIsProposedIsEnough) {
  for (const int seeds : {3, 4, 5}) {
    const Sides sides = seeds_of({"a"}, seeds);
    const Comparison comparison = compare_runs(sides.base, sides.head);
    EXPECT_TRUE(has_note(comparison, "store 6 seeds of each sequence")) << comparison.notes.front();
  }
  const Sides enough = seeds_of({"a"}, 6);
  EXPECT_EQ(compare_runs(enough.base, enough.head).result(), ChangeClass::kWorse);
  // The pool of two sequences with two seeds each has four pairs, and six with three.
  const Sides pooled = seeds_of({"a", "b"}, 2);
  EXPECT_EQ(change_on(compare_runs(pooled.base, pooled.head), "vo on all sequences").needed_seeds, 3u);
  const Sides enough_in_pool = seeds_of({"a", "b"}, 3);
  EXPECT_EQ(compare_runs(enough_in_pool.base, enough_in_pool.head).result(), ChangeClass::kWorse);
}

TEST(ComparisonAccuracy, EqualTrajectoriesOnOtherDataAreNoCopies) {
  Sides sides;
  for (int seed = 1; seed <= 6; ++seed) {
    for (const bool is_base : {true, false}) {
      // Base does not move, so its error is the extent of the scene.
      const double error = 0.1 * seed;
      StoredRun run = compared_run("a", is_base ? error : 2.0 * error, 1, is_base ? "base" : "head");
      run.identity.seed = seed;
      run.identity.sequence_id += std::to_string(seed);
      if (is_base) run.blobs["trajectory"] = "at rest";
      (is_base ? sides.base : sides.head).push_back(std::move(run));
    }
  }
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_EQ(change_on(comparison, "vo on a").change.count, 6u);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);  // p = 2^-5
}

TEST(ComparisonAccuracy, DoesNotMaskARegressionOnOneSequence) {
  Sides sides = replicates(8, 0.5);
  const Sides worse = replicates(8, 1.2, "b");
  sides.base.insert(sides.base.end(), worse.base.begin(), worse.base.end());
  sides.head.insert(sides.head.end(), worse.head.begin(), worse.head.end());
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_EQ(change_on(comparison, "vo on a").result, ChangeClass::kBetter);
  EXPECT_EQ(change_on(comparison, "vo on b").result, ChangeClass::kWorse);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
}

/// One run on each of 12 sequences.
Sides one_run_each(double factor) {
  std::mt19937_64 random(1);
  Sides sides;
  for (int i = 0; i < 12; ++i) {
    const std::string sequence = "s" + std::to_string(i);
    const double error = 0.01 * (i + 1);
    sides.base.push_back(compared_run(sequence, scattered(error, random), 1));
    sides.head.push_back(compared_run(sequence, scattered(error * factor, random), 1, "head"));
  }
  return sides;
}

TEST(ComparisonAccuracy, SingleRunsArePooledOverTheSequencesOfTheVariant) {
  const Sides worse = one_run_each(1.2);
  const Comparison comparison = compare_runs(worse.base, worse.head);
  const MetricChange& pool = change_on(comparison, "vo on all sequences");
  EXPECT_EQ(pool.change.count, 12u);
  EXPECT_EQ(pool.result, ChangeClass::kWorse);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
  for (const MetricChange& change : comparison.changes) {
    EXPECT_TRUE(change.decides || change.result != ChangeClass::kWorse) << change.subject;
  }
}

TEST(ComparisonAccuracy, AChangeOnOneSequenceIsSaidButDoesNotDecide) {
  Sides sides = one_run_each(1.0);
  for (std::size_t i = 0; i < 12; ++i)
    sides.head[i].metrics.front().value = sides.base[i].metrics.front().value * 1.001;
  sides.head[3].metrics.front().value *= 1.3;
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_TRUE(change_on(comparison, "vo on s3").changed);
  EXPECT_EQ(change_on(comparison, "vo on s3").result, ChangeClass::kInconclusive);
  EXPECT_EQ(change_on(comparison, "vo on all sequences").result, ChangeClass::kSame);
  EXPECT_EQ(comparison.result(), ChangeClass::kSame);
}

TEST(ComparisonAccuracy, PerturbedRunsOfBaseAloneExtendTheReference) {
  Sides sides = replicates(40, 1.0);
  sides.head = {compared_run("a", 0.02, 1, "head")};
  // Outside the spread of 40 runs of base: p = 2 / 41.
  EXPECT_EQ(compare_runs(sides.base, sides.head).result(), ChangeClass::kWorse);
  sides.head = {compared_run("a", sides.base[5].metrics.front().value * 1.001, 1, "head")};
  EXPECT_NE(compare_runs(sides.base, sides.head).result(), ChangeClass::kWorse);
}

/// `count` pairs whose false confidence changes, and equal errors; with `zeros` runs of base of which it is
/// 0.
Sides confidences(int count, int zeros, double head) {
  Sides sides = replicates(count, 1.0);
  for (std::size_t i = 0; i < sides.base.size(); ++i) {
    const double base = static_cast<int>(i) < zeros ? 0.0 : 1e-4;
    sides.base[i].metrics = {{"false_confidence", "", "", base}};
    sides.head[i].metrics = {{"false_confidence", "", "", head}};
  }
  return sides;
}

TEST(ComparisonAccuracy, AChangeFromZeroIsADifference) {
  for (const int zeros : {8, 5, 1}) {
    const Sides sides = confidences(8, zeros, 0.6);
    const Comparison comparison = compare_runs(sides.base, sides.head);
    ASSERT_EQ(comparison.changes.size(), 1u);
    EXPECT_TRUE(comparison.changes.front().is_absolute);
    EXPECT_NEAR(comparison.changes.front().change.median, 0.6, 1e-3);
    EXPECT_EQ(comparison.result(), ChangeClass::kWorse) << zeros;
  }
}

TEST(ComparisonAccuracy, AChangeFromZeroOfOneRunOrBelowTheFloorIsNotWorse) {
  const Sides one = confidences(1, 1, 0.6);
  EXPECT_EQ(compare_runs(one.base, one.head).result(), ChangeClass::kInconclusive);
  const Sides small = confidences(8, 8, 0.004);  // the floor is 0.005
  EXPECT_EQ(compare_runs(small.base, small.head).result(), ChangeClass::kSame);
  const Sides none = confidences(8, 8, 0.0);
  EXPECT_EQ(compare_runs(none.base, none.head).result(), ChangeClass::kSame);
}

TEST(ComparisonAccuracy, OutliersInTheMinorityOfTheReplicatesAreNotTheSame) {
  Sides sides = replicates(8, 1.0);
  for (std::size_t i = 0; i < 3; ++i) sides.head[i].metrics.front().value = 1.0;  // 100 times the error
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_NE(change_on(comparison, "vo on a").result, ChangeClass::kSame);
}

/// Eight timing runs on each of three sequences with different levels, of which the last one changes.
TEST(ComparisonAccuracy, ATimeThatDoublesOnTheSlowestOfThreeSequencesIsWorse) {
  Sides sides;
  const std::pair<const char*, double> levels[] = {{"a", 1.0}, {"b", 5.0}, {"c", 20.0}};
  for (const auto& [sequence, ms] : levels) {
    for (int i = 1; i <= 8; ++i) {
      for (const bool is_base : {true, false}) {
        StoredRun run = compared_run(sequence, 0.01, i, is_base ? "base" : "head");
        run.identity.kind = "timing";
        const double factor = is_base ? 1.0 : (ms == 20.0 ? 2.0 : 1.0001);
        run.costs = {{.module = "window_solve", .per = "call", .mean_ms = ms * factor}};
        (is_base ? sides.base : sides.head).push_back(std::move(run));
      }
    }
  }
  const Comparison comparison = compare_runs(sides.base, sides.head);
  const auto change = std::ranges::find(comparison.changes, "window_solve", &MetricChange::metric);
  ASSERT_NE(change, comparison.changes.end());
  // The pooled values have nearly equal medians: those of the unchanged sequence "b".
  EXPECT_LT(change->head_median - change->base_median, 0.001);
  EXPECT_EQ(change->result, ChangeClass::kWorse);
}

/// One run on each of several sequences, with another error at head on the first ones.
Sides single_runs(int sequences, int changed, double factor) {
  Sides sides;
  for (int i = 0; i < sequences; ++i) {
    const std::string sequence(1, static_cast<char>('a' + i));
    sides.base.push_back(compared_run(sequence, 0.01, 1));
    sides.head.push_back(compared_run(sequence, i < changed ? 0.01 * factor : 0.01, 1, "head"));
  }
  return sides;
}

TEST(ComparisonAccuracy, PairsThatArePooledCountOnce) {
  const Sides sides = single_runs(13, 3, 2.0);
  const Comparison comparison = compare_runs(sides.base, sides.head);
  std::size_t pools = 0;
  for (const MetricChange& change : comparison.changes) {
    if (!change.subject.ends_with(" on all sequences") || change.metric != "ate_rmse_m") continue;
    ++pools;
    EXPECT_EQ(change.change.count, 13u);
  }
  EXPECT_EQ(pools, 1u);
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive);
}

TEST(ComparisonAccuracy, AChangeFromZeroInTheMinorityOfTheRunsIsNotHiddenByTheMedian) {
  Sides sides = confidences(20, 20, 0.0);
  for (std::size_t i = 0; i < 9; ++i) sides.head[i].metrics.front().value = 0.6;
  const Comparison comparison = compare_runs(sides.base, sides.head);
  EXPECT_NEAR(comparison.changes.front().change.median, 0.3, 1e-12);  // pseudomedian
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
}

TEST(ComparisonAccuracy, AModuleThatNeededNoTimeIsComparedByTheDifference) {
  Sides sides = replicates(12, 1.0);
  for (std::size_t i = 0; i < 12; ++i) {
    sides.base[i].metrics.clear();
    sides.head[i].metrics.clear();
    sides.base[i].identity.kind = sides.head[i].identity.kind = "timing";
    sides.base[i].costs = {{.module = "object_detection", .per = "call", .mean_ms = 0.0}};
    sides.head[i].costs = {{.module = "object_detection", .per = "call", .mean_ms = 5.0 + 0.01 * double(i)}};
  }
  EXPECT_EQ(compare_runs(sides.base, sides.head).result(), ChangeClass::kWorse);
}

TEST(ComparisonAccuracy, ComparesABaselineWithoutTrajectories) {
  Sides sides{{compared_run("a", 0.01, 1)}, {compared_run("a", 0.01, 1, "head")}};
  for (StoredRun* run : {&sides.base.front(), &sides.head.front()}) {
    run->blobs.clear();
    run->identity.kind = "instructions";
    run->metrics.push_back({"instructions", "", "", 1e9});
  }
  EXPECT_EQ(compare_runs(sides.base, sides.head).result(), ChangeClass::kSame);
  sides.head.front().metrics.back().value = 1.02e9;
  EXPECT_EQ(compare_runs(sides.base, sides.head).result(), ChangeClass::kWorse);
}

}  // namespace
}  // namespace stillpoint::bench
