// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_result.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/record/result_values.h"
#include "bench/record/run_files.h"

namespace stillpoint::bench {
namespace {

constexpr int kFrames = 60;
constexpr double kFrameInterval_s = 0.1;

Pose at_x(double x) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.0, 0.0)}; }

/// Frames every 0.1 s; ground truth at 1 m/s along x, of a frame 2 m beside the camera.
datasets::SequenceInfo straight_sequence() {
  datasets::SequenceInfo info;
  info.name = "straight";
  info.ground_truth.T_c_f = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 2.0, 0.0)};
  for (int i = 0; i < kFrames; ++i) {
    const Timestamp t = from_seconds(i * kFrameInterval_s);
    info.frame_times.push_back(t);
    info.ground_truth.trajectory.poses.push_back({t, at_x(i * kFrameInterval_s)});
  }
  return info;
}

/// The exact camera trajectory over the first `frames` frames.
OdometryRun perfect_run(const datasets::SequenceInfo& info, int frames) {
  OdometryRun run;
  run.trajectory.frame = "camera";
  run.frames_planned = kFrames;
  run.summary.frames = static_cast<std::size_t>(frames);
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  for (int i = 0; i < frames; ++i) {
    const StampedPose& truth = info.ground_truth.trajectory.poses[static_cast<std::size_t>(i)];
    run.trajectory.poses.push_back({truth.t, truth.T_w_f * T_f_c});
  }
  return run;
}

TEST(RunResult, IsScoredAgainstTheGroundTruthOfTheCamera) {
  const datasets::SequenceInfo info = straight_sequence();
  const RunResult result = score_run(info, perfect_run(info, kFrames));
  EXPECT_EQ(result.outcome, Outcome::kOk);
  EXPECT_NEAR(result.score.ate.value().translation_m.rmse, 0.0, 1e-9);
  EXPECT_NEAR(result.score.rpe.value().translation_m.rmse, 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(result.score.coverage.value(), 1.0);
  EXPECT_NEAR(result.score.correct_rate.value(), 1.0, 1e-9);
}

TEST(RunResult, WarnsOfAWrongScale) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  EXPECT_TRUE(score_run(info, run).warnings.empty());
  for (StampedPose& pose : run.trajectory.poses) pose.T_w_f.p *= 0.2;
  const RunResult result = score_run(info, std::move(run));
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(
      result.warnings.front().find("trajectory: the estimate is 0.2 times as large as the ground truth"),
      std::string::npos)
      << result.warnings.front();
}

TEST(RunResult, WarnsOfGroundTruthThatIsLateOrSparse) {
  const datasets::SequenceInfo info = straight_sequence();
  const OdometryRun run = perfect_run(info, kFrames);
  datasets::SequenceInfo late = info;
  std::vector<StampedPose>& poses = late.ground_truth.trajectory.poses;
  for (StampedPose& pose : poses) pose.t = after(pose.t, 10.0 + 0.1);
  const auto expect_warning = [&](const datasets::SequenceInfo& sequence, const char* text) {
    const RunResult result = score_run(sequence, run);
    ASSERT_EQ(result.warnings.size(), 1U) << text;
    EXPECT_NE(result.warnings.front().find(text), std::string::npos) << result.warnings.front();
  };
  expect_warning(late, "ground truth: compared with it, the files do not overlap in time");
  datasets::SequenceInfo sparse = info;
  std::erase_if(sparse.ground_truth.trajectory.poses, [&](const StampedPose& pose) {
    return pose.t.ns % 1'000'000'000 != info.frame_times.front().ns % 1'000'000'000;
  });
  expect_warning(sparse,
                 "ground truth: has a pose within 0.02 s for 6 of 60 poses only; the ATE is that of these; "
                 "the ground truth has one pose per 1 s: RPE compares poses with one up to 0.5 s away");
  datasets::SequenceInfo partial = info;
  partial.ground_truth.trajectory.poses.resize(20);
  expect_warning(partial,
                 "ground truth: has a pose within 0.02 s for 20 of 60 poses only; the errors are those of");
}

TEST(RunResult, WarnsOfAFaultThatNoFrameHas) {
  datasets::SequenceInfo info = straight_sequence();
  std::erase_if(info.frame_times, [&](Timestamp t) {
    const double elapsed_s = seconds_between(info.frame_times.front(), t);
    return elapsed_s > 2.0 && elapsed_s < 3.05;
  });
  const auto doubt = [&](const char* fault) {
    const std::vector<datasets::SensorFault> faults = {datasets::parse_fault(fault)};
    return error_doubt(score_run(info, perfect_run(info, kFrames), faults).warnings);
  };
  EXPECT_EQ(doubt("blank:start=1,duration=0.5"), "");
  EXPECT_EQ(doubt("imu_gap:start=2.1,duration=0.5"), "");
  EXPECT_EQ(doubt("dropped:start=2.01,duration=1"), "");
  EXPECT_EQ(doubt("focal_error:amount=2"), "");
  EXPECT_NE(doubt("blank:start=2.01,duration=1").find("is active at none of the frames"), std::string::npos);
  EXPECT_NE(doubt("imu_gap:start=100").find("fault: imu_gap:start=100"), std::string::npos);
}

TEST(RunResult, WholeSecondsThatMatchTheGroundTruthAreNoOtherUnit) {
  datasets::SequenceInfo info = straight_sequence();
  for (int i = 0; i < kFrames; ++i) {
    const auto index = static_cast<std::size_t>(i);
    info.frame_times[index] = from_seconds(i);
    info.ground_truth.trajectory.poses[index].t = from_seconds(i);
  }
  const RunResult result = score_run(info, perfect_run(info, kFrames));
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
}

TEST(RunResult, OfAnInterruptedRunIsMarkedAndScoredOnProcessedFrames) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, 30);
  run.summary.interrupted = true;
  const RunResult result = score_run(info, std::move(run));
  EXPECT_EQ(result.outcome, Outcome::kInterrupted);
  EXPECT_EQ(result.failure, "interrupted after 30 of 60 frames");
  EXPECT_DOUBLE_EQ(result.score.coverage.value(), 1.0);
  EXPECT_NEAR(result.score.correct_rate.value(), 1.0, 1e-9);
  EXPECT_TRUE(trajectory_text(result).starts_with("# partial: interrupted after 30 of 60 frames\n"));
}

TEST(RunResult, OfARunWithoutPosesIsFailedWithAReason) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run;
  run.frames_planned = kFrames;
  run.summary.frames = kFrames;
  const RunResult result = score_run(info, std::move(run));
  EXPECT_EQ(result.outcome, Outcome::kLost);
  EXPECT_FALSE(result.failure.empty());
  EXPECT_FALSE(result.score.ate.has_value());
}

TEST(RunResult, OfARunWithOnePoseIsFailed) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  run.trajectory.poses.resize(1);
  const RunResult result = score_run(info, std::move(run));
  EXPECT_EQ(result.outcome, Outcome::kLost);
  EXPECT_EQ(result.failure, "only one frame has a pose, which tells no error");
  EXPECT_FALSE(result.score.ate || result.score.rpe);
  EXPECT_EQ(result.score.correct_rate, 0.0);
}

TEST(RunResult, WarnsOfRepairedFilesGapsAndMissingBoxes) {
  datasets::SequenceInfo info = straight_sequence();
  info.warnings = {"ground truth: repaired"};
  OdometryRun run = perfect_run(info, kFrames);
  run.summary.imu_health = {.rejected_samples = 2, .gaps = 1};
  run.summary.detector_counters.unrecorded = 15;
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  ASSERT_EQ(json["warnings"].size(), 4u);
  EXPECT_EQ(json["warnings"][0], "ground truth: repaired");
  EXPECT_EQ(json["frames_without_boxes"], 15);
  EXPECT_DOUBLE_EQ(json["detector"]["fraction_without_boxes"], 0.25);  // 15 of 60
}

TEST(RunResult, WarnsOfACalibrationAtItsBound) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  run.calibration = {.time_offset_s = 0.15, .time_offset_sigma_s = 0.002, .time_offset_at_bound = 7};
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  ASSERT_EQ(json["warnings"].size(), 1u);
  EXPECT_NE(json["warnings"][0].get<std::string>().find("0.1500 s"), std::string::npos);
  EXPECT_DOUBLE_EQ(json["calibration"]["time_offset_sigma_s"], 0.002);
  EXPECT_EQ(json["calibration"]["frames_at_bound"]["time_offset"], 7);
  EXPECT_DOUBLE_EQ(json["calibration"]["depth_scale"], 1.0);
}

TEST(RunResult, WarnsOfARigThatTheDataContradicts) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  run.calibration = {.depth_scale = 0.851, .depth_scale_sigma = 0.002};
  run.calibration.extrinsics_agree = true;
  run.calibration.depth_scale_agrees = false;
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  ASSERT_EQ(json["warnings"].size(), 1u);
  EXPECT_NE(json["warnings"][0].get<std::string>().find("0.8510 +- 0.0020"), std::string::npos);
  EXPECT_EQ(json["calibration"]["agrees_with_rig"]["depth_scale"], false);
  EXPECT_EQ(json["calibration"]["agrees_with_rig"]["extrinsics"], true);
}

TEST(RunResult, ContainsTheEstimatedExtrinsics) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  run.calibration.T_b_c = {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.01, 0.02, 0.03}};
  run.calibration.extrinsics_sigma_m = 0.004;
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  EXPECT_EQ(json["calibration"]["T_b_c"]["p_m"], nlohmann::ordered_json({0.01, 0.02, 0.03}));
  EXPECT_EQ(json["calibration"]["T_b_c"]["q_xyzw"], nlohmann::ordered_json({1.0, 0.0, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(json["calibration"]["extrinsics_sigma_m"], 0.004);
  EXPECT_TRUE(json["calibration"]["extrinsics_sigma_rad"].is_null());
  EXPECT_TRUE(json["calibration"]["agrees_with_rig"]["extrinsics"].is_null());
}

TEST(RunResult, WithoutRecordedBoxesDoesNotCountFramesWithoutThem) {
  const datasets::SequenceInfo info = straight_sequence();
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, perfect_run(info, kFrames))));
  EXPECT_TRUE(json["frames_without_boxes"].is_null());
  EXPECT_TRUE(json["detector"]["fraction_without_boxes"].is_null());
  EXPECT_TRUE(json["warnings"].empty());
}

TEST(RunResult, CountsTheSegmentsWithLocatedPoses) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  for (const int segment : {0, 0, 1, 2}) {
    run.claims.push_back(
        {.claim = segment == 1 ? eval::PoseClaim::kNone : eval::PoseClaim::kLocated, .segment = segment});
  }
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  EXPECT_EQ(json["segments"], 2);
}

TEST(RunResult, IsConvertedFromJsonToMetricsAndCosts) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  run.trajectory.poses.erase(run.trajectory.poses.begin(), run.trajectory.poses.begin() + 15);
  run.timings.add(Module::kWindowSolve, {.ns = 2'500'000, .calls = 1});
  run.timings.add(Module::kTrackingThread, {.ns = 1'500'000, .calls = 1});
  const auto json = nlohmann::ordered_json::parse(result_json(score_run(info, std::move(run))));
  const StoredRun read{.metrics = stored_metrics(json), .costs = module_costs(json["timings"])};
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["frames"], kFrames);
  EXPECT_EQ(metric_value(read, "frames"), kFrames);
  EXPECT_DOUBLE_EQ(metric_value(read, "coverage").value(), 0.75);      // 45 of 60
  EXPECT_NEAR(metric_value(read, "first_pose_s").value(), 1.5, 1e-9);  // 15 frames of 0.1 s
  EXPECT_FALSE(metric_value(read, "no_such_number").has_value());
  ASSERT_EQ(read.costs.size(), 2u);
  EXPECT_EQ(read.costs[0].module, "window_solve");
  EXPECT_EQ(read.costs[0].per, "call");
  EXPECT_DOUBLE_EQ(read.costs[0].mean_ms, 2.5);
  EXPECT_EQ(read.costs[1].module, "tracking_thread");
  EXPECT_EQ(read.costs[1].per, "frame");
}

TEST(RunResult, ContainsTheScoreOfPosesAtImuRateIfTheyWereRecorded) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  EXPECT_EQ(result_json(score_run(info, run)).find("imu_rate_"), std::string::npos);
  run.imu_rate.emplace();
  run.imu_rate->trajectory = run.trajectory;
  run.imu_rate->ages_ms = {10.0};
  const auto json = nlohmann::json::parse(result_json(score_run(info, std::move(run))));
  EXPECT_NEAR(json.at("imu_rate_ate_rmse_m").get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(json.at("imu_rate_age_p95_ms").get<double>(), 10.0, 1e-9);
  EXPECT_TRUE(json.at("imu_rate_step_p95_m").is_null());
}

TEST(RunResult, ContainsTheCovarianceOfTheLevelingRotationIfItIsEstimated) {
  const datasets::SequenceInfo info = straight_sequence();
  OdometryRun run = perfect_run(info, kFrames);
  EXPECT_TRUE(
      nlohmann::json::parse(result_json(score_run(info, run))).at("leveling_covariance_rad2").is_null());
  run.level_covariance = Eigen::Matrix2d{{4e-6, 1e-6}, {1e-6, 9e-6}};
  const auto json = nlohmann::json::parse(result_json(score_run(info, std::move(run))));
  EXPECT_EQ(json.at("leveling_covariance_rad2"), nlohmann::json::parse("[[4e-6, 1e-6], [1e-6, 9e-6]]"));
}

}  // namespace
}  // namespace stillpoint::bench
