// SPDX-License-Identifier: BSD-3-Clause
/// What must hold for any trajectory, tried on random ones; the seed is the test's parameter.
#include <gtest/gtest.h>

#include <random>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/trajectory/time_offset.h"
#include "tests/support/smooth_path.h"

namespace stillpoint {
namespace {

class EvalProperty : public testing::TestWithParam<unsigned> {
 protected:
  [[nodiscard]] double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] Eigen::Vector3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  [[nodiscard]] Pose rigid_motion() { return Pose{exp_so3(vector(1.5)), vector(20.0)}; }

  /// The path with noise of a few centimetres and degrees.
  [[nodiscard]] Trajectory noisy(const Trajectory& path) {
    Trajectory result = path;
    for (StampedPose& pose : result.poses) {
      pose.T_w_f = pose.T_w_f * Pose{exp_so3(vector(0.02)), vector(0.03)};
    }
    return result;
  }
  [[nodiscard]] static Trajectory moved(const Pose& T_v_w, double scale, const Trajectory& path) {
    const Similarity S{T_v_w, scale};
    Trajectory result = path;
    for (StampedPose& pose : result.poses) pose.T_w_f = S * pose.T_w_f;
    return result;
  }

  std::mt19937 random_{GetParam()};
  Trajectory gt_ = test::smooth_path(400, 0.05, uniform(0.0, 100.0));
  Trajectory est_ = noisy(gt_);
};

TEST_P(EvalProperty, AteDoesNotChangeWithARigidMotionOfTheEstimate) {
  const AteResult before = *ate(gt_, est_);
  const AteResult behind = *ate(gt_, moved(rigid_motion(), 1.0, est_));
  EXPECT_NEAR(behind.translation_m.rmse, before.translation_m.rmse, 1e-10);
  EXPECT_NEAR(behind.rotation_deg.rmse, before.rotation_deg.rmse, 1e-7);
}

TEST_P(EvalProperty, AteDoesNotChangeWithARigidMotionOfTheGroundTruth) {
  EXPECT_NEAR(ate(moved(rigid_motion(), 1.0, gt_), est_)->translation_m.rmse,
              ate(gt_, est_)->translation_m.rmse, 1e-10);
}

TEST_P(EvalProperty, AlignmentIsNeverWorseThanNone) {
  const auto matches = matched_poses(gt_, est_, associate_tum(gt_, est_));
  double last = 1e300;
  for (const Alignment kind : {Alignment::kNone, Alignment::kYaw, Alignment::kSe3, Alignment::kSim3}) {
    const AlignmentResult fit = align(matches, kind);
    const double rmse = statistics(ate_errors(matches, fit.S_w_v).translation_m)->rmse;
    EXPECT_LE(rmse, last + 1e-12);  // each has all freedom of the one before
    last = rmse;
  }
}

TEST_P(EvalProperty, RpeDoesNotChangeWithACommonLeftTransform) {
  const RpeResult before = *rpe(gt_, est_);
  const Pose T_v_w = rigid_motion();
  const RpeResult behind = *rpe(moved(T_v_w, 1.0, gt_), moved(T_v_w, 1.0, est_));
  EXPECT_NEAR(behind.translation_m.rmse, before.translation_m.rmse, 1e-10);
  EXPECT_NEAR(behind.rotation_deg.rmse, before.rotation_deg.rmse, 1e-9);
}

TEST_P(EvalProperty, RpeIsZeroOnlyForEqualMotion) {
  EXPECT_NEAR(rpe(gt_, moved(rigid_motion(), 1.0, gt_))->translation_m.max, 0.0, 1e-12);
  EXPECT_GT(rpe(gt_, est_)->translation_m.min, 0.0);
  Trajectory one_off = gt_;
  one_off.poses[200].T_w_f.p.x() += 1e-3;
  EXPECT_NEAR(rpe(gt_, one_off)->translation_m.max, 1e-3, 1e-9);
  EXPECT_NEAR(strict_rpe(strict_matches(gt_, one_off), 1.0).errors->translation_m.max, 1e-3, 1e-9);
}

TEST_P(EvalProperty, Sim3RecoversAKnownScale) {
  const double scale = uniform(0.1, 10.0);
  const Trajectory est = moved(rigid_motion(), scale, gt_);
  const auto matches = matched_poses(gt_, est, associate_tum(gt_, est));
  const AlignmentResult fit = align(matches, Alignment::kSim3);
  EXPECT_NEAR(fit.S_w_v.scale * scale, 1.0, 1e-10);
  EXPECT_LT(statistics(ate_errors(matches, fit.S_w_v).translation_m)->max, 1e-9);
}

TEST_P(EvalProperty, YawRecoversATurnAboutTheVertical) {
  const Pose T_v_w{exp_so3({0.0, 0.0, uniform(-3.0, 3.0)}), vector(20.0)};
  const Trajectory est = moved(T_v_w, 1.0, gt_);
  const auto matches = matched_poses(gt_, est, associate_tum(gt_, est));
  EXPECT_LT(statistics(ate_errors(matches, align(matches, Alignment::kYaw).S_w_v).translation_m)->max, 1e-9);
}

TEST_P(EvalProperty, ACommonShiftOfTimeChangesNothing) {
  const double shift = uniform(-1e6, 1e6);
  Trajectory gt = gt_;
  Trajectory est = est_;
  for (Trajectory* path : {&gt, &est}) {
    for (StampedPose& pose : path->poses) pose.t = after(pose.t, shift);
  }
  EXPECT_DOUBLE_EQ(ate(gt, est)->translation_m.rmse, ate(gt_, est_)->translation_m.rmse);
}

TEST_P(EvalProperty, TheOffsetOfAShiftedEstimateIsFound) {
  const double shift = uniform(-0.3, 0.3);
  Trajectory shifted = gt_;
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, shift);
  const std::optional<TimeOffset> found = find_time_offset(gt_, shifted);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_s, -shift, 5e-4);
}

TEST_P(EvalProperty, EveryTenthPoseHasTheErrorsOfItsPoses) {
  // The errors of a decimated estimate are those of the poses it keeps, if the alignment is the same.
  const auto all = matched_poses(gt_, est_, associate_tum(gt_, est_));
  Trajectory tenth;
  for (std::size_t i = 0; i < est_.poses.size(); i += 10) tenth.poses.push_back(est_.poses[i]);
  const auto few = matched_poses(gt_, tenth, associate_tum(gt_, tenth));
  const AteErrors of_all = ate_errors(all, {});
  const AteErrors of_few = ate_errors(few, {});
  ASSERT_EQ(few.size(), tenth.poses.size());
  for (std::size_t i = 0; i < few.size(); ++i)
    EXPECT_EQ(of_few.translation_m[i], of_all.translation_m[10 * i]);
}

/// All candidates sorted by difference: the TUM tool's own way, quadratic.
std::vector<IndexPair> associate_by_sorting(const Trajectory& gt, const Trajectory& est,
                                            double max_difference_s) {
  struct Candidate {
    std::int64_t difference;
    IndexPair pair;
  };
  std::vector<Candidate> candidates;
  for (std::size_t g = 0; g < gt.poses.size(); ++g) {
    for (std::size_t e = 0; e < est.poses.size(); ++e) {
      const std::int64_t difference = std::abs(gt.poses[g].t.ns - est.poses[e].t.ns);
      if (static_cast<double>(difference) / 1e9 < max_difference_s)
        candidates.push_back({difference, {g, e}});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
  std::vector<bool> gt_taken(gt.poses.size());
  std::vector<bool> est_taken(est.poses.size());
  std::vector<IndexPair> pairs;
  for (const Candidate& candidate : candidates) {
    if (gt_taken[candidate.pair.gt] || est_taken[candidate.pair.est]) continue;
    gt_taken[candidate.pair.gt] = est_taken[candidate.pair.est] = true;
    pairs.push_back(candidate.pair);
  }
  std::sort(pairs.begin(), pairs.end(), [](const IndexPair& a, const IndexPair& b) { return a.est < b.est; });
  return pairs;
}

TEST_P(EvalProperty, AssociationIsThatOfSortingAllCandidates) {
  const auto random_stamps = [this](std::size_t count) {
    Trajectory path;
    std::int64_t ms = 0;
    for (std::size_t i = 0; i < count; ++i) {
      ms += std::uniform_int_distribution<std::int64_t>(1, 12)(random_);  // ties are common on a grid of 1 ms
      path.poses.push_back({Timestamp{ms * 1'000'000}, Pose{}});
    }
    return path;
  };
  const Trajectory gt = random_stamps(200);
  const Trajectory est = random_stamps(150);
  EXPECT_EQ(associate_tum(gt, est), associate_by_sorting(gt, est, 0.02));
}

INSTANTIATE_TEST_SUITE_P(Seeds, EvalProperty, testing::Range(0u, 25u));

}  // namespace
}  // namespace stillpoint
