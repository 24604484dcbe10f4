// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_statistics.h"

#include <limits>

#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

StoredRun run_of(const std::string& variant, const std::string& sequence, std::int64_t seed, double ate) {
  StoredRun run;
  run.identity = {.variant = variant, .sequence = sequence, .seed = seed};
  run.metrics = {{"ate_rmse_m", "", "m", ate}};
  return run;
}

StoredRun lost_run(const std::string& variant, const std::string& sequence, std::int64_t seed) {
  StoredRun run = run_of(variant, sequence, seed, 0.0);
  run.metrics.clear();
  run.outcome = Outcome::kLost;
  return run;
}

TEST(RunSpreads, CountFailuresAndUseTheMedianOfSuccessfulRuns) {
  const std::vector<StoredRun> runs = {run_of("vo", "a", 1, 1.0), run_of("vo", "a", 2, 3.0),
                                       lost_run("vo", "a", 3), run_of("vo", "b", 1, 9.0)};
  const std::vector<RunSpread> rows = run_spreads(runs, "ate_rmse_m");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].runs, 3u);
  EXPECT_EQ(rows[0].failed, 1u);
  EXPECT_EQ(rows[0].spread->median, 2.0);
  EXPECT_EQ(rows[1].spread->median, 9.0);
}

TEST(RunSpreads, CountEqualRepetitionsOfADeterministicMetricOnce) {
  std::vector<StoredRun> runs;
  for (int repetition = 1; repetition <= 6; ++repetition) {
    runs.push_back(run_of("vo", "a", 1, 1.0));
    runs.back().identity.repetition = repetition;
    runs.back().metrics.push_back({"process_cpu_s", "", "s", 10.0});
  }
  for (StoredRun& run : runs) run.metrics.front().value = 1.037;
  EXPECT_EQ(run_spreads(runs, "ate_rmse_m")[0].spread->count, 1u);
  EXPECT_EQ(run_spreads(runs, "process_cpu_s")[0].spread->count, 6u);  // a cost is measured in each run
  runs.back().metrics[0].value = 1.5;                                  // not deterministic
  EXPECT_EQ(run_spreads(runs, "ate_rmse_m")[0].spread->count, 2u);
}

TEST(RunSpreads, HaveNoIntervalForFewerThanSixReplicates) {
  std::vector<StoredRun> runs;
  for (int seed = 1; seed <= 5; ++seed) runs.push_back(run_of("vo", "a", seed, 0.1 * seed));
  EXPECT_FALSE(run_spreads(runs, "ate_rmse_m")[0].spread->median_interval);
  runs.push_back(run_of("vo", "a", 6, 0.6));
  EXPECT_TRUE(run_spreads(runs, "ate_rmse_m")[0].spread->median_interval);
}

TEST(RunSpreads, TheWorstValueIsTheSmallestIfLargerIsBetter) {
  std::vector<StoredRun> runs = {run_of("vo", "a", 1, 1.0), run_of("vo", "a", 2, 2.0)};
  for (StoredRun& run : runs)
    run.metrics = {{"correct_rate", "", "", 0.5 * static_cast<double>(run.identity.seed)}};
  EXPECT_EQ(run_spreads(runs, "correct_rate")[0].spread->worst, 0.5);
}

TEST(RunSpreads, OmitValuesThatAreNotFinite) {
  const std::vector<StoredRun> runs = {run_of("vo", "a", 1, 1.0),
                                       run_of("vo", "a", 2, std::numeric_limits<double>::infinity())};
  EXPECT_EQ(run_spreads(runs, "ate_rmse_m")[0].spread->count, 1u);
}

TEST(Ablation, PairsBySequenceAndSeed) {
  // Differences of "wo" to "full": a1 +1, a2 +2, b1 +9; on a the median is 1.5. Over the sequences, 1.5 and
  // 9, the means of two are 1.5, 5.25, 9.
  const std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("full", "a", 2, 2.0),
                                       run_of("full", "b", 1, 1.0), run_of("wo", "b", 1, 10.0),
                                       run_of("wo", "a", 2, 4.0),   run_of("wo", "a", 1, 2.0)};
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].sequence, "");
  EXPECT_EQ(rows[0].difference->median, 5.25);
  EXPECT_EQ(rows[0].difference->count, 2u);
  EXPECT_EQ(rows[0].difference->effect, 1.0);
  EXPECT_EQ(rows[1].sequence, "a");
  EXPECT_EQ(rows[1].difference->median, 1.5);
}

TEST(Ablation, CountsPairsInWhichOnlyTheVariantFailed) {
  const std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), lost_run("wo", "a", 1)};
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  EXPECT_EQ(rows[0].newly_failed, 1u);
  EXPECT_FALSE(rows[0].difference.has_value());
}

TEST(Ablation, ARowWithoutPairsNamesTheReason) {
  const std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("full", "a", 2, 1.0),
                                       run_of("wo", "a", 3, 1.0),   run_of("full", "b", 1, 1.0),
                                       run_of("wo", "c", 1, 1.0),   run_of("lost", "b", 1, 1.0)};
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  ASSERT_EQ(rows.size(), 8u);
  EXPECT_EQ(rows[0].doubt, "no sequence and seed in common with the base");
  EXPECT_EQ(rows[1].doubt, "no seed in common with the base");
  EXPECT_EQ(rows[2].doubt, "no run of the variant");
  EXPECT_EQ(rows[3].doubt, "no run of the base");
  EXPECT_EQ(rows[4].doubt, "");
  EXPECT_EQ(rows[6].doubt, "");
}

TEST(Ablation, ErrorsOverFewerFramesAreNotComparable) {
  std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("wo", "a", 1, 0.4),
                                 run_of("full", "b", 1, 1.0), run_of("wo", "b", 1, 0.9)};
  for (StoredRun& run : runs) run.metrics.push_back({"coverage", "", "", 1.0});
  runs[1].metrics.back().value = 0.33;
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].doubt, "coverage 0.33, base 1.00: not comparable");
  EXPECT_EQ(rows[1].doubt, rows[0].doubt);
  EXPECT_EQ(rows[2].doubt, "");
  EXPECT_EQ(ablation(runs, "full", "coverage")[1].doubt, "");  // it is the difference itself
}

TEST(Ablation, AnRpeOfFewPairsIsDoubtful) {
  std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("wo", "a", 1, 0.4),
                                 run_of("full", "b", 1, 1.0), run_of("wo", "b", 1, 0.9)};
  for (StoredRun& run : runs)
    run.metrics = {{"rpe_trans_rmse_m_per_s", "", "m/s", 0.1}, {"rpe_pairs", "", "", 20.0}};
  runs[3].metrics.back().value = 5.0;
  const std::vector<AblationRow> rows = ablation(runs, "full", "rpe_trans_rmse_m_per_s");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].doubt, "RPE of only 5 pairs of poses: not ranked");
  EXPECT_EQ(rows[1].doubt, "");
  EXPECT_EQ(rows[2].doubt, rows[0].doubt);
}

TEST(Ablation, ErrorsAgainstADoubtfulGroundTruthAreDoubtful) {
  std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("wo", "a", 1, 0.4),
                                 run_of("full", "b", 1, 1.0), run_of("wo", "b", 1, 0.9)};
  runs[1].detail = "ground truth: has a pose within 0.02 s for 6 of 90 poses only";
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].doubt, "doubtful errors on a");
  EXPECT_EQ(rows[1].doubt, runs[1].detail);
  EXPECT_EQ(rows[2].doubt, "");
}

TEST(RunSpreads, StateEveryDoubt) {
  std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0)};
  runs[0].metrics = {{"rpe_trans_rmse_m_per_s", "", "m/s", 0.1}, {"rpe_pairs", "", "", 5.0}};
  runs[0].detail = "ground truth: is sparse";
  const std::vector<RunSpread> rows = run_spreads(runs, "rpe_trans_rmse_m_per_s");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].doubt, "RPE of only 5 pairs of poses: not ranked; ground truth: is sparse");
}

TEST(Ablation, AChangeFromZeroHasADifferenceButNoRatio) {
  std::vector<StoredRun> runs;
  for (int seed = 1; seed <= 6; ++seed) {
    runs.push_back(run_of("full", "a", seed, 0.0));
    runs.push_back(run_of("wo", "a", seed, seed == 1 ? 0.0 : 0.6));
  }
  for (StoredRun& run : runs)
    run.blobs["trajectory"] = run.identity.variant + std::to_string(run.identity.seed);
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  EXPECT_EQ(rows[0].difference->median, 0.6);
  EXPECT_FALSE(rows[0].change.has_value());
}

TEST(Ablation, SequencesAreTheReplicatesOfTheRowOverAll) {
  // Eight seeds on each of three sequences: no interval over all of them, and one from six sequences on.
  for (const int sequences : {3, 6}) {
    std::vector<StoredRun> runs;
    for (int sequence = 0; sequence < sequences; ++sequence) {
      for (int seed = 1; seed <= 8; ++seed) {
        runs.push_back(run_of("full", "s" + std::to_string(sequence), seed, 1.0 + 0.01 * seed));
        runs.push_back(run_of("wo", "s" + std::to_string(sequence), seed, 2.0 + 0.01 * seed));
      }
    }
    const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
    EXPECT_EQ(rows[0].change->count, static_cast<std::size_t>(sequences));
    EXPECT_EQ(rows[0].change->interval.has_value(), sequences >= 6);
    EXPECT_EQ(rows[1].change->count, 8u);
    EXPECT_TRUE(rows[1].change->interval.has_value());
  }
}

TEST(Ablation, CopiesOfARecordedSequenceCountOnce) {
  std::vector<StoredRun> runs;
  for (int seed = 1; seed <= 8; ++seed) {
    for (const char* variant : {"full", "wo"}) {
      runs.push_back(run_of(variant, "a", seed, variant[0] == 'f' ? 1.0 : 2.127));
      runs.back().blobs["trajectory"] = variant;
    }
  }
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  EXPECT_EQ(rows[0].change->count, 1u);
  EXPECT_FALSE(rows[0].change->interval.has_value());
  EXPECT_EQ(rows[0].copies, 7u);
  const std::vector<RunSpread> spreads = run_spreads(runs, "ate_rmse_m");
  EXPECT_EQ(spreads[0].spread->count, 1u);
  EXPECT_EQ(spreads[0].copies, 7u);
}

TEST(Ablation, ARunWithoutAValueDidNotFail) {
  std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0), run_of("wo", "a", 1, 2.0)};
  runs.back().metrics.clear();
  const std::vector<AblationRow> rows = ablation(runs, "full", "ate_rmse_m");
  EXPECT_EQ(rows[0].newly_failed, 0u);
  EXPECT_EQ(rows[0].newly_without_value, 1u);
  EXPECT_EQ(run_spreads(runs, "ate_rmse_m")[1].without_value, 1u);
}

TEST(Ablation, ListsTheExistingVariantsInTheError) {
  const std::vector<StoredRun> runs = {run_of("full", "a", 1, 1.0)};
  expect_input_error([&] { static_cast<void>(ablation(runs, "ful", "ate_rmse_m")); }, {"\"ful\"", "full"});
}

TEST(FirstDifference, IsTheFirstModuleOfTheFirstDifferingFrame) {
  const std::string head = "frame,tracking,dynamic,optimization\n";
  const std::string one = head + "0,a,b,c\n1,d,e,f\n";
  EXPECT_EQ(first_difference(one, one), "");
  EXPECT_EQ(first_difference(one, head + "0,a,b,c\n1,d,x,y\n"), "frame 1, dynamic");
  EXPECT_EQ(first_difference(one, head + "0,a,b,c\n"), "the number of frames");
}

TEST(RepetitionReport, AFailureIsNotRepeatable) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  StoreWriter writer(file);
  for (const std::int64_t repetition : {1, 2, 3}) {
    const RunIdentity identity{.variant = "vo", .sequence = "a", .repetition = repetition};
    static_cast<void>(writer.acquire(identity));
    RunOutcome outcome{.attachments = {{"trajectory", "same"}}};
    if (repetition == 2) outcome = {.outcome = Outcome::kCrashed, .attachments = {}};
    writer.finish(identity, outcome);
  }
  const Store store(file);
  const std::vector<RepetitionRow> rows = repetition_report(store, store.runs());
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].repetitions, 3u);
  EXPECT_EQ(rows[0].failed, 1u);
  EXPECT_EQ(rows[0].distinct_trajectories, 1u);
  EXPECT_FALSE(rows[0].is_repeatable());
}

TEST(RepetitionReport, ReportsTheFirstDifferenceBetweenRepetitions) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  StoreWriter writer(file);
  for (const std::int64_t repetition : {1, 2, 3}) {
    const RunIdentity identity{
        .variant = "vo", .sequence = "a", .repetition = repetition, .axis = "param.n", .axis_value = 2.0};
    static_cast<void>(writer.acquire(identity));
    const std::string last = repetition == 3 ? "other" : "same";
    writer.finish(identity,
                  {.attachments = {{"trajectory", last}, {"frames", "frame,tracking\n0," + last + "\n"}}});
  }
  const Store store(file);
  const std::vector<RepetitionRow> rows = repetition_report(store, store.runs());
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].repetitions, 3u);
  EXPECT_EQ(rows[0].label, "a vo seed 1 param.n = 2");
  EXPECT_EQ(rows[0].distinct_trajectories, 2u);
  EXPECT_EQ(rows[0].first_difference, "frame 0, tracking");
}

}  // namespace
}  // namespace stillpoint::bench
