// SPDX-License-Identifier: BSD-3-Clause
/// Invariants of the metrics on random trajectories; the test parameter is the random seed.
#include <gtest/gtest.h>

#include <random>

#include "eval/compare/time_offset.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

class EvalProperty : public testing::TestWithParam<unsigned> {
 protected:
  [[nodiscard]] double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] Eigen::Vector3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  [[nodiscard]] Pose rigid_transform() { return Pose{exp_so3(vector(1.5)), vector(20.0)}; }

  /// The path with noise of up to 3 cm and 0.02 rad per axis.
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

TEST_P(EvalProperty, AteIsInvariantToARigidTransformOfTheEstimate) {
  const AteResult original = *ate(gt_, est_);
  const AteResult transformed = *ate(gt_, moved(rigid_transform(), 1.0, est_));
  EXPECT_NEAR(transformed.translation_m.rmse, original.translation_m.rmse, 1e-10);
  EXPECT_NEAR(transformed.rotation_deg.rmse, original.rotation_deg.rmse, 1e-7);
}

TEST_P(EvalProperty, AteIsInvariantToARigidTransformOfTheGroundTruth) {
  EXPECT_NEAR(ate(moved(rigid_transform(), 1.0, gt_), est_)->translation_m.rmse,
              ate(gt_, est_)->translation_m.rmse, 1e-10);
}

TEST_P(EvalProperty, MoreDegreesOfFreedomNeverIncreaseTheAte) {
  const auto matches = matched_poses(gt_, est_, associate_tum(gt_, est_));
  double last = 1e300;
  for (const Alignment kind : {Alignment::kNone, Alignment::kYaw, Alignment::kSe3, Alignment::kSim3}) {
    const AlignmentResult fit = align(matches, kind);
    const double rmse = statistics(ate_errors(matches, fit.S_w_v).translation_m)->rmse;
    EXPECT_LE(rmse, last + 1e-12);  // the degrees of freedom include those of the previous alignment
    last = rmse;
  }
}

TEST_P(EvalProperty, RpeIsInvariantToACommonLeftTransform) {
  const RpeResult original = *rpe(gt_, est_);
  const Pose T_v_w = rigid_transform();
  const RpeResult transformed = *rpe(moved(T_v_w, 1.0, gt_), moved(T_v_w, 1.0, est_));
  EXPECT_NEAR(transformed.translation_m.rmse, original.translation_m.rmse, 1e-10);
  EXPECT_NEAR(transformed.rotation_deg.rmse, original.rotation_deg.rmse, 1e-9);
}

TEST_P(EvalProperty, RpeIsZeroOnlyForEqualMotion) {
  EXPECT_NEAR(rpe(gt_, moved(rigid_transform(), 1.0, gt_))->translation_m.max, 0.0, 1e-12);
  EXPECT_GT(rpe(gt_, est_)->translation_m.min, 0.0);
  Trajectory outlier = gt_;
  outlier.poses[200].T_w_f.p.x() += 1e-3;
  EXPECT_NEAR(rpe(gt_, outlier)->translation_m.max, 1e-3, 1e-9);
  EXPECT_NEAR(strict_rpe(strict_matches(gt_, outlier), 1.0).errors->translation_m.max, 1e-3, 1e-9);
}

TEST_P(EvalProperty, Sim3RecoversAKnownScale) {
  const double scale = uniform(0.1, 10.0);
  const Trajectory est = moved(rigid_transform(), scale, gt_);
  const auto matches = matched_poses(gt_, est, associate_tum(gt_, est));
  const AlignmentResult fit = align(matches, Alignment::kSim3);
  EXPECT_NEAR(fit.S_w_v.scale * scale, 1.0, 1e-10);
  EXPECT_LT(statistics(ate_errors(matches, fit.S_w_v).translation_m)->max, 1e-9);
}

TEST_P(EvalProperty, YawRecoversARotationAboutTheVertical) {
  const Pose T_v_w{exp_so3({0.0, 0.0, uniform(-3.0, 3.0)}), vector(20.0)};
  const Trajectory est = moved(T_v_w, 1.0, gt_);
  const auto matches = matched_poses(gt_, est, associate_tum(gt_, est));
  EXPECT_LT(statistics(ate_errors(matches, align(matches, Alignment::kYaw).S_w_v).translation_m)->max, 1e-9);
}

TEST_P(EvalProperty, AteIsInvariantToACommonTimeShift) {
  const double shift = uniform(-1e6, 1e6);
  Trajectory gt = gt_;
  Trajectory est = est_;
  for (Trajectory* path : {&gt, &est}) {
    for (StampedPose& pose : path->poses) pose.t = after(pose.t, shift);
  }
  EXPECT_DOUBLE_EQ(ate(gt, est)->translation_m.rmse, ate(gt_, est_)->translation_m.rmse);
}

TEST_P(EvalProperty, TimeOffsetOfAShiftedEstimateIsRecovered) {
  const double shift = uniform(-0.3, 0.3);
  Trajectory shifted = gt_;
  for (StampedPose& pose : shifted.poses) pose.t = after(pose.t, shift);
  const std::optional<TimeOffset> found = find_time_offset(gt_, shifted);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_s, -shift, 5e-4);
}

TEST_P(EvalProperty, ErrorsOfADecimatedEstimateAreThoseOfItsPoses) {
  const auto all = matched_poses(gt_, est_, associate_tum(gt_, est_));
  Trajectory tenth;
  for (std::size_t i = 0; i < est_.poses.size(); i += 10) tenth.poses.push_back(est_.poses[i]);
  const auto decimated = matched_poses(gt_, tenth, associate_tum(gt_, tenth));
  const AteErrors all_errors = ate_errors(all, {});
  const AteErrors decimated_errors = ate_errors(decimated, {});
  ASSERT_EQ(decimated.size(), tenth.poses.size());
  for (std::size_t i = 0; i < decimated.size(); ++i)
    EXPECT_EQ(decimated_errors.translation_m[i], all_errors.translation_m[10 * i]);
}

/// Reference implementation with all candidates sorted by difference, as in the TUM tool; quadratic.
std::vector<IndexPair> associate_by_sorting(const Trajectory& gt, const Trajectory& est,
                                            double max_difference_s) {
  struct Candidate {
    std::int64_t difference;
    IndexPair pair;
  };
  std::vector<Candidate> candidates;
  for (PoseIndex g = 0; g < gt.poses.size(); ++g) {
    for (PoseIndex e = 0; e < est.poses.size(); ++e) {
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

TEST_P(EvalProperty, AssociationEqualsTheReferenceImplementation) {
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
}  // namespace stillpoint::eval
