// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/rig_report.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

/// An exact rig, all of which was observed.
EstimatedCalibration observed_calibration() {
  EstimatedCalibration calibration;
  calibration.rig.camera.fx = calibration.rig.camera.fy = 500.0;
  calibration.depth_scale_agrees = calibration.lens_agrees = true;
  calibration.depth_scale_sigma = 0.002;
  calibration.lens_sigma = Eigen::Vector4d(0.0005, 0.0005, 0.0005, 0.0005);
  calibration.time_offset_sigma_s = 0.0002;
  return calibration;
}

TEST(RigReport, IsSilentAboutAnExactRig) {
  const std::vector<RigFinding> findings = rig_report(observed_calibration());
  ASSERT_EQ(findings.size(), 6U);
  for (const RigFinding& finding : findings) EXPECT_EQ(finding.result, RigResult::kAgrees);
  EXPECT_EQ(rig_report_line({findings[0], findings[1]}),
            "depth scale [%]: agrees (to 0.2); focal length [%]: agrees (to 0.05)");
}

TEST(RigReport, NamesTheParameterOfTheLensThatDiffers) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.lens_agrees = false;
  calibration.lens = {0.001, -0.05, 0.0, 0.01};
  const std::vector<RigFinding> findings = rig_report(calibration);
  EXPECT_EQ(findings[1].result, RigResult::kAgrees);
  EXPECT_EQ(findings[2].result, RigResult::kDiffers);
  EXPECT_DOUBLE_EQ(findings[2].difference, 0.05);
  EXPECT_EQ(findings[3].result, RigResult::kAgrees);
  EXPECT_EQ(rig_report_line({findings[4]}), "center y [px]: differs by -5 (20 sigma)");
}

/// The residuals ask for a focal length 2 % shorter, but not with the certainty that contradicts a rig.
TEST(RigReport, DoesNotCallADoubtedParameterOneThatAgrees) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.lens_sigma = Eigen::Vector4d(0.0065, 0.0005, 0.0005, 0.0005);
  calibration.rig_step.lens[0] = 0.02;
  EXPECT_EQ(rig_report(calibration)[1].result, RigResult::kNotObserved);
  calibration.rig_step.lens[0] = 0.005;
  EXPECT_EQ(rig_report(calibration)[1].result, RigResult::kAgrees);
}

TEST(RigReport, NamesTheRotationThatContradictsTheRig) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.aligned_rotation = {.difference_rad = 0.002, .sigma_rad = 0.002, .deviations = 0.6};
  EXPECT_EQ(rig_report_line({rig_report(calibration).back()}),
            "camera rotation on the body [deg]: agrees (to 0.11)");
  calibration.aligned_rotation->deviations = 9.0;
  calibration.extrinsics_sigma_rad = 0.002;
  calibration.T_b_c.q = Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitX());
  EXPECT_EQ(rig_report_line({rig_report(calibration).back()}),
            "camera rotation on the body [deg]: differs by +2.01 (18 sigma)");
}

/// The camera hardly turned about one axis, but the rotation about the others is wrong.
TEST(RigReport, NamesARotationThatIsWrongAboutTheAxesThatWereObserved) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.aligned_rotation = {.difference_rad = 0.035, .sigma_rad = 0.02, .deviations = 6.0};
  EXPECT_EQ(rig_report(calibration).back().result, RigResult::kDiffers);
  calibration.aligned_rotation->deviations = 0.5;
  EXPECT_EQ(rig_report(calibration).back().result, RigResult::kNotObserved);
}

TEST(RigReport, SaysWhatWasNotObserved) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.depth_scale_sigma = 0.06;
  EXPECT_EQ(rig_report_line(rig_report(calibration)).substr(0, 29), "depth scale [%]: not observed");
}

TEST(RigReport, ATimeOffsetOfMoreThanAMillisecondDiffers) {
  EstimatedCalibration calibration = observed_calibration();
  calibration.rig.time_offset_s = 0.002;
  calibration.time_offset_s = 0.004;
  EXPECT_EQ(rig_report(calibration).back().result, RigResult::kAgrees);
  calibration.time_offset_s = 0.006;
  EXPECT_EQ(rig_report_line({rig_report(calibration).back()}), "time offset [ms]: differs by +4 (20 sigma)");
}

TEST(RigReport, IsEmptyIfNothingWasEstimated) { EXPECT_TRUE(rig_report({}).empty()); }

/// k1 off by 0.08 contradicts the rig in the first comparison: the lens was missing in the report.
TEST(RecordAgreement, KnowsALensThatNeverAgreed) {
  EstimatedCalibration calibration;
  OdometryUpdate update;
  record_agreement(update, true, calibration);
  EXPECT_FALSE(calibration.lens_agrees || calibration.depth_scale_agrees || calibration.extrinsics_agree);
  update.lens[1] = -0.08;
  record_agreement(update, false, calibration);  // estimated from the start, without a comparison
  EXPECT_FALSE(calibration.lens_agrees);
  record_agreement(update, true, calibration);
  EXPECT_EQ(calibration.lens_agrees, false);
  update = {.agrees_with_rig = {.lens = true}};
  record_agreement(update, true, calibration);
  EXPECT_EQ(calibration.lens_agrees, true);
}

}  // namespace
}  // namespace stillpoint::bench
