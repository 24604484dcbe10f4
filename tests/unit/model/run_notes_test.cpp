// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bench/model/metrics.h"
#include "bench/model/run_notes.h"

namespace stillpoint::bench {
namespace {

StoredRun evaluated_run(double tum, double strict) {
  StoredRun run;
  run.metrics = {{"ate_rmse_m", "compat:tum, 0.02 s, one-to-one", "m", tum},
                 {"strict:se3/ate_rmse_m", "Ground truth interpolated", "m", strict}};
  return run;
}

std::string note_of(const std::vector<StoredRun>& runs) {
  std::vector<const StoredRun*> pointers;
  for (const StoredRun& run : runs) pointers.push_back(&run);
  return protocol_difference_note(pointers, metric_id::kAte);
}

TEST(ProtocolDifference, NamesBothProtocolsAndValuesFromAFactorOfTwoOn) {
  EXPECT_EQ(note_of({evaluated_run(0.01, 0.02)}), "ATE 0.0100 m by compat:tum, ATE 0.0200 m by strict:se3");
  EXPECT_EQ(note_of({evaluated_run(0.04, 0.02)}), "ATE 0.0400 m by compat:tum, ATE 0.0200 m by strict:se3");
  EXPECT_EQ(note_of({evaluated_run(0.01, 0.0199)}), "");
}

TEST(ProtocolDifference, IsNotHiddenByTheMedianOfTheOtherRuns) {
  EXPECT_EQ(
      note_of({evaluated_run(0.01, 0.01), evaluated_run(0.01, 0.05), evaluated_run(0.01, 0.01)}),
      "ATE 0.0100 m by compat:tum, ATE 0.0100 m by strict:se3 (medians of 3 runs; differ by a factor of 2 or "
      "more in 1)");
}

TEST(ProtocolDifference, IgnoresFailedRunsOtherMetricsAndDifferencesBelowThePrecision) {
  StoredRun failed = evaluated_run(0.01, 0.05);
  failed.outcome = Outcome::kLost;
  StoredRun rotation = evaluated_run(0.01, 0.01);
  rotation.metrics.push_back({"strict:se3/ate_rmse_deg", "", "deg", 5.0});
  EXPECT_EQ(note_of({failed}), "");
  EXPECT_EQ(note_of({rotation}), "");
  EXPECT_EQ(note_of({evaluated_run(1e-5, 1e-4)}), "");  // the floor of the ATE is 0.2 mm
  EXPECT_EQ(note_of({}), "");
}

TEST(FewRpePairs, AreNotedForTheRunWithTheFewest) {
  const auto run_with = [](const std::string& prefix, double pairs) {
    StoredRun run;
    run.metrics = {{prefix + "rpe_trans_rmse_m_per_s", "", "m/s", 0.001},
                   {prefix + "rpe_pairs", "", "", pairs}};
    return run;
  };
  const auto note = [](const std::vector<StoredRun>& runs, const std::string& metric) {
    std::vector<const StoredRun*> pointers;
    for (const StoredRun& run : runs) pointers.push_back(&run);
    return few_rpe_pairs_note(pointers, metric);
  };
  const std::string metric = "rpe_trans_rmse_m_per_s";
  EXPECT_EQ(note({run_with("", 200), run_with("", 4)}, metric), "RPE of only 4 pairs of poses: not ranked");
  EXPECT_EQ(note({run_with("", 200), run_with("", 10)}, metric), "");
  EXPECT_EQ(note({run_with("strict:se3/", 3)}, "strict:se3/" + metric),
            "RPE of only 3 pairs of poses: not ranked");
  EXPECT_EQ(note({run_with("", 4)}, "ate_rmse_m"), "");
  StoredRun failed = run_with("", 4);
  failed.outcome = Outcome::kCrashed;
  StoredRun older = run_with("", 4);
  older.metrics.pop_back();
  EXPECT_EQ(note({failed, older}, metric), "");
}

TEST(Scatter, OfRunsOnTheSameDataIsNotedFromAFactorOfTwoOn) {
  const auto note = [](const std::vector<std::pair<std::string, double>>& errors) {
    std::vector<StoredRun> runs;
    for (const auto& [data, ate] : errors) {
      runs.emplace_back();
      runs.back().identity.sequence_id = data;
      runs.back().metrics = {{"ate_rmse_m", "", "m", ate}};
    }
    std::vector<const StoredRun*> pointers;
    for (const StoredRun& run : runs) pointers.push_back(&run);
    return scatter_note(pointers, metric_id::kAte);
  };
  EXPECT_EQ(note({{"a", 0.0126}, {"a", 0.0278}, {"a", 0.0045}, {"a", 0.0033}}),
            "ATE 0.0033 m to ATE 0.0278 m on the same data, a factor of 8.4: one run is no result");
  EXPECT_EQ(note({{"a", 0.01}, {"a", 0.019}}), "");
  EXPECT_EQ(note({{"a", 0.01}, {"b", 0.09}}), "");       // other scenes
  EXPECT_EQ(note({{"a", 0.00001}, {"a", 0.0001}}), "");  // below the floor
  EXPECT_EQ(note({{"", 0.01}, {"", 0.09}}), "");         // unknown data
  EXPECT_EQ(note({}), "");
}

TEST(DoubtfulErrors, AreNotedOfRunsThatSucceeded) {
  StoredRun run;
  run.detail = "the estimate is mirrored";
  run.metrics = {{"ate_rmse_m", "", "m", 0.1}, {"coverage", "", "", 1.0}};
  const std::vector<const StoredRun*> runs{&run};
  EXPECT_EQ(doubtful_error_note(runs, metric_id::kAte), "the estimate is mirrored");
  EXPECT_EQ(doubtful_error_note(runs, metric_id::kCoverage), "");
  EXPECT_EQ(doubtful_error_note(runs, "rpe_rot_rmse_deg_per_s"), "");  // the run has none
  run.outcome = Outcome::kCrashed;
  EXPECT_EQ(doubtful_error_note(runs, metric_id::kAte), "");
}

TEST(Innovations, AreNotedForTheRunThatContradictsItsDataMost) {
  const auto run_with = [](double reprojection, double inertial) {
    StoredRun run;
    run.metrics = {{"nis_reprojection", "", "", reprojection}, {"nis_inertial", "", "", inertial}};
    return run;
  };
  const auto note = [](const std::vector<StoredRun>& runs) {
    std::vector<const StoredRun*> pointers;
    for (const StoredRun& run : runs) pointers.push_back(&run);
    return innovation_note(pointers);
  };
  EXPECT_EQ(note({run_with(1.0, 0.3), run_with(4.0, 3.0), StoredRun{}}), "");
  EXPECT_EQ(note({run_with(1.0, 0.3), run_with(1.0, 10.24)}),
            "NIS inertial 10.2: the IMU is noisier than stated; see `stillpoint diagnose`");
  EXPECT_EQ(note({run_with(1.0, 5.0), run_with(6.0, 3.5)}),
            "NIS inertial 3.5: the IMU is noisier than stated; NIS reprojection 6.0: images contradict the "
            "prediction; see `stillpoint diagnose`");
  StoredRun failed = run_with(9.0, 9.0);
  failed.outcome = Outcome::kLost;
  EXPECT_EQ(note({failed}), "");
}

TEST(TimeSource, DependsOnTheKindOfTheRunAndOnOtherLoad) {
  StoredRun run;
  EXPECT_EQ(time_source(run), TimeSource::kShared);
  run.identity.kind = "timing";
  EXPECT_EQ(time_source(run), TimeSource::kUndisturbed);
  run.metrics = {{std::string(metric_id::kQuiet), "", "", 0.0}};
  EXPECT_EQ(time_source(run), TimeSource::kBusy);
  run.metrics.front().value = 1.0;
  EXPECT_EQ(time_source(run), TimeSource::kUndisturbed);
  EXPECT_EQ(time_source_note(TimeSource::kUndisturbed), "");
  EXPECT_NE(time_source_note(TimeSource::kShared).find("kind = \"timing\""), std::string::npos);
  EXPECT_NE(time_source_note(TimeSource::kBusy).find("idle machine"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint::bench
