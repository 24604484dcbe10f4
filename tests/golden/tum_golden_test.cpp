// SPDX-License-Identifier: BSD-3-Clause
/// Compares the metrics on freiburg1_xyz with the output of the TUM tools, evo, rpg_trajectory_evaluation and
/// ov_eval.
#include <gtest/gtest.h>

#include "eval/io/trajectory_file.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "tests/golden/golden_file.h"
#include "tests/support/test_data.h"

namespace stillpoint::eval {
namespace {

using nlohmann::json;
using test::printed;

class TumGoldenBase {
 protected:
  /// @return false if the data are not available
  [[nodiscard]] bool load(const std::string& name) {
    const std::optional<json> golden = test::golden_file("tum_fr1_xyz.json");
    const auto folder = find_test_data("tum_fr1_xyz");
    if (!golden || !folder) return false;
    golden_ = golden->at(name);
    gt_ = read_tum(*folder / "freiburg1_xyz-groundtruth.txt").trajectory;
    est_ = read_tum(*folder / name).trajectory;
    return true;
  }

  void expect_tum(const std::string& protocol, const std::string& error, const Statistics& ours) const {
    const json& theirs = golden_.at(protocol);
    EXPECT_EQ(ours.count, theirs.at("compared_pose_pairs").get<std::size_t>());
    expect_same(
        protocol, [&](const char* key) { return theirs.at(error + "." + key).get<double>(); }, ours);
  }

  void expect_evo(const std::string& protocol, const std::optional<Statistics>& ours) const {
    const json& theirs = golden_.at(protocol);
    if (theirs.is_string()) {  // evo found no pair
      EXPECT_FALSE(ours) << protocol;
      return;
    }
    ASSERT_TRUE(ours) << protocol;
    expect_same(
        protocol, [&](const char* key) { return theirs.at(key).get<double>(); }, *ours);
    EXPECT_EQ(printed(ours->sse), printed(theirs.at("sse").get<double>())) << protocol;
  }

  template <class Theirs>
  static void expect_same(const std::string& protocol, const Theirs& theirs, const Statistics& ours) {
    EXPECT_EQ(printed(ours.rmse), printed(theirs("rmse"))) << protocol;
    EXPECT_EQ(printed(ours.mean), printed(theirs("mean"))) << protocol;
    EXPECT_EQ(printed(ours.median), printed(theirs("median"))) << protocol;
    EXPECT_EQ(printed(ours.std), printed(theirs("std"))) << protocol;
    EXPECT_EQ(printed(ours.min), printed(theirs("min"))) << protocol;
    EXPECT_EQ(printed(ours.max), printed(theirs("max"))) << protocol;
  }

  [[nodiscard]] std::vector<MatchedPose> evo_matches() const {
    return matched_poses(
        gt_, est_,
        associate_evo(gt_, est_, {.max_difference_s = 0.02, .arithmetic = StampArithmetic::kDouble}));
  }

  [[nodiscard]] std::optional<Statistics> evo_ape(Alignment alignment) const {
    const auto matches = evo_matches();
    return statistics(ate_errors(matches, align(matches, alignment).S_w_v).translation_m);
  }

  json golden_;
  Trajectory gt_;
  Trajectory est_;
};

class TumGolden : public testing::TestWithParam<const char*>, protected TumGoldenBase {
 protected:
  void SetUp() override {
    if (!load(GetParam())) GTEST_SKIP() << missing_test_data("tum_fr1_xyz and ../golden");
  }
};

class RpgGolden : public testing::Test, protected TumGoldenBase {};

TEST_P(TumGolden, AteAgreesWithTheTumTool) {
  expect_tum("tum_ate", "absolute_translational_error",
             ate(gt_, est_, {.arithmetic = StampArithmetic::kDouble})->translation_m);
}

TEST_P(TumGolden, RpeOverOneSecondAgreesWithTheTumTool) {
  const RpeResult ours = *rpe(gt_, est_);
  expect_tum("tum_rpe_1s", "translational_error", ours.translation_m);
  expect_tum("tum_rpe_1s", "rotational_error", ours.rotation_deg);
}

TEST_P(TumGolden, RpeOverOneFrameAgreesWithTheTumTool) {
  const RpeResult ours = *rpe(gt_, est_, {.unit = RpeUnit::kFrames});
  expect_tum("tum_rpe_1f", "translational_error", ours.translation_m);
  expect_tum("tum_rpe_1f", "rotational_error", ours.rotation_deg);
}

TEST_P(TumGolden, AbsoluteErrorsAgreeWithEvo) {
  expect_evo("evo_ape_se3", evo_ape(Alignment::kSe3));
  expect_evo("evo_ape_sim3", evo_ape(Alignment::kSim3));
  expect_evo("evo_ape_none", evo_ape(Alignment::kNone));
  const auto matches = evo_matches();
  expect_evo("evo_ape_se3_deg",
             statistics(ate_errors(matches, align(matches, Alignment::kSe3).S_w_v).rotation_deg));
}

TEST_P(TumGolden, RelativeErrorsAgreeWithEvo) {
  const auto matches = evo_matches();
  const auto error_over = [&](const std::vector<PosePair>& pairs) {
    return statistics(relative_errors(matches, pairs).translation_m);
  };
  expect_evo("evo_rpe_1f", error_over(pairs_over_frames(matches.size(), 1, false)));
  const std::vector<double> lengths = path_lengths(matches, PathOf::kEstimate);
  expect_evo("evo_rpe_1m_all", error_over(pairs_over_meters(lengths, 1.0, 0.1).pairs));
}

TEST_F(RpgGolden, AbsoluteErrorsAgreeWithRpgAndOvEval) {
  if (!load("freiburg1_xyz-rgbdslam_drift.txt"))
    GTEST_SKIP() << missing_test_data("tum_fr1_xyz and ../golden");
  const auto matches =
      matched_poses(gt_, est_, associate_tum(gt_, est_, {.arithmetic = StampArithmetic::kDouble}));
  const auto errors = [&](Alignment kind) { return ate_errors(matches, align(matches, kind).S_w_v); };
  // rpg: se3 0.0134735 m, sim3 0.0133941 m, rotation 2.051896 deg; posyaw of both tools: 0.052145 m, 21.312
  // deg.
  EXPECT_NEAR(statistics(errors(Alignment::kSe3).translation_m)->rmse, 0.0134735, 5e-8);
  EXPECT_NEAR(statistics(errors(Alignment::kSim3).translation_m)->rmse, 0.0133941, 5e-8);
  EXPECT_NEAR(statistics(errors(Alignment::kSe3).rotation_deg)->rmse, 2.051896, 5e-7);
  EXPECT_NEAR(statistics(errors(Alignment::kYaw).translation_m)->rmse, 0.052145, 5e-7);
  EXPECT_NEAR(statistics(errors(Alignment::kYaw).rotation_deg)->rmse, 21.312, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Freiburg1Xyz, TumGolden,
                         testing::Values("freiburg1_xyz-rgbdslam.txt", "freiburg1_xyz-rgbdslam_drift.txt",
                                         "freiburg1_xyz-rgbdslam_drift_short.txt",
                                         "freiburg1_xyz-ORB_kf_mono.txt"),
                         [](const auto& run) {
                           std::string name = run.param;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
                           return name;
                         });

}  // namespace
}  // namespace stillpoint::eval
