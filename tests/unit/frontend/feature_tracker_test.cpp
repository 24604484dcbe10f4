// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/feature_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "tests/unit/frontend/textured_picture.h"

namespace stillpoint {
namespace {

constexpr double kDistance = 2.0;  // [m] of the plane
constexpr bool kDetect = true;

const Pose kSmallMotion{exp_so3({0.002, -0.003, 0.004}), {0.01, -0.005, 0.02}};  // 1 to 4 px
const Pose kLargeRotation{exp_so3({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};    // 500 px * 0.1 rad = 50 px
const Pose kLargeShift{Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}};         // 500 px * 0.2 / 2 = 50 px

MotionPrior exact_prior(const Pose& T_ccur_cprev) {
  return {.T_ccur_cprev = T_ccur_cprev, .has_rotation = true, .has_translation = true};
}

TexturedPlane test_plane() { return {test_camera(), kDistance, 7}; }

/// Features of the first picture that the second still has, within half a pixel of the truth.
int count_followed(const FrontendConfig& config, const Pose& motion, const MotionPrior& prior) {
  const TexturedPlane plane = test_plane();
  FeatureTracker tracker(config, test_camera());
  const TrackedFrame first = tracker.track(plane.frame_at(Pose{}, 0), {}, kDetect);
  const TrackedFrame second = tracker.track(plane.frame_at(motion, 1), prior, !kDetect);
  int followed = 0;
  for (const TrackedFeature& feature : second.features) {
    const Eigen::Vector2d expected =
        plane.pixel_in(motion, first.features[static_cast<std::size_t>(feature.id)].pixel);
    if ((feature.pixel - expected).norm() < 0.5) ++followed;
  }
  return followed;
}

FrontendConfig one_level(TrackerPrediction prediction) {
  FrontendConfig config;
  config.prediction = prediction;
  config.pyramid_levels = 1;
  config.unpredicted_pyramid_levels = 1;
  return config;
}

bool same_bits(const TrackedFrame& a, const TrackedFrame& b) {
  return std::equal(a.features.begin(), a.features.end(), b.features.begin(), b.features.end(),
                    [](const TrackedFeature& x, const TrackedFeature& y) {
                      return x.id == y.id && x.pixel == y.pixel && x.bearing == y.bearing &&
                             x.velocity == y.velocity && x.depth == y.depth && x.age == y.age;
                    });
}

std::vector<TrackedFrame> track_four_pictures(const FrontendConfig& config) {
  const TexturedPlane plane = test_plane();
  FeatureTracker tracker(config, test_camera());
  std::vector<TrackedFrame> results;
  Pose T_c_first;
  for (int i = 0; i < 4; ++i) {
    results.push_back(tracker.track(plane.frame_at(T_c_first, i), exact_prior(kSmallMotion), kDetect));
    T_c_first = kSmallMotion * T_c_first;
  }
  return results;
}

TEST(FeatureTracker, FirstPictureGivesNewFeaturesAtRest) {
  FeatureTracker tracker({}, test_camera());
  const TrackedFrame result = tracker.track(test_plane().frame_at(Pose{}, 0), {}, kDetect);
  ASSERT_GT(result.features.size(),
            80U);  // of 130 wanted; circles of 30 px leave room for some 150 of 640x480
  EXPECT_LE(result.features.size(), 130U);
  EXPECT_EQ(result.detected, static_cast<int>(result.features.size()));
  EXPECT_EQ(result.lost, 0);
  for (std::size_t i = 0; i < result.features.size(); ++i) {
    EXPECT_EQ(result.features[i].id, static_cast<std::int64_t>(i));
    EXPECT_EQ(result.features[i].age, 1);
    EXPECT_TRUE(result.features[i].velocity.isZero());
  }
}

TEST(FeatureTracker, WithoutDetectionNoFeatureIsBorn) {
  FeatureTracker tracker({}, test_camera());
  EXPECT_TRUE(tracker.track(test_plane().frame_at(Pose{}, 0), {}, !kDetect).features.empty());
}

TEST(FeatureTracker, FollowsKnownMotionToSubpixels) {
  const TexturedPlane plane = test_plane();
  FeatureTracker tracker({}, test_camera());
  const TrackedFrame first = tracker.track(plane.frame_at(Pose{}, 0), {}, kDetect);
  const TrackedFrame second = tracker.track(plane.frame_at(kSmallMotion, 1), {}, !kDetect);
  ASSERT_GT(second.features.size(), first.features.size() * 9 / 10);
  std::vector<double> errors;
  for (const TrackedFeature& feature : second.features) {
    const TrackedFeature& before = first.features[static_cast<std::size_t>(feature.id)];
    errors.push_back((feature.pixel - plane.pixel_in(kSmallMotion, before.pixel)).norm());
    EXPECT_EQ(feature.age, 2);
    // Pictures are 0.1 s apart.
    EXPECT_LT((feature.velocity - 10.0 * (feature.bearing - before.bearing)).norm(), 1e-9);
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);  // KLT on noise-free texture: a tenth of a pixel
}

TEST(FeatureTracker, RotationPriorSparesPyramidLevels) {
  const MotionPrior prior = exact_prior(kLargeRotation);
  EXPECT_GT(count_followed(one_level(TrackerPrediction::kRotation), kLargeRotation, prior), 70);
  // 50 px are far outside the 10 px that a single level can reach.
  EXPECT_LT(count_followed(one_level(TrackerPrediction::kNone), kLargeRotation, prior), 5);
}

TEST(FeatureTracker, FullPriorMovesFeaturesByTranslationAtTheirDepth) {
  const MotionPrior prior = exact_prior(kLargeShift);
  EXPECT_GT(count_followed(one_level(TrackerPrediction::kFull), kLargeShift, prior), 70);
  EXPECT_LT(count_followed(one_level(TrackerPrediction::kRotation), kLargeShift, prior), 5);
}

TEST(FeatureTracker, WithoutAValidPriorMorePyramidLevelsAreUsed) {
  FrontendConfig config = one_level(TrackerPrediction::kFull);
  config.unpredicted_pyramid_levels = 5;
  const Pose motion{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}};  // 25 px
  MotionPrior broken = exact_prior(motion);
  broken.T_ccur_cprev.q.coeffs()[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(count_followed(config, motion, broken), 70);
  EXPECT_GT(count_followed(config, motion, MotionPrior{}), 70);
}

TEST(FeatureTracker, BlankPicturesHaveNoFeatures) {
  FeatureTracker tracker({}, test_camera());
  Frame frame = test_plane().frame_at(Pose{}, 0);
  frame.gray.setTo(90);
  EXPECT_TRUE(tracker.track(frame, {}, kDetect).features.empty());
}

TEST(FeatureTracker, SameInputGivesSameBits) {
  const std::vector<TrackedFrame> once = track_four_pictures({});
  const std::vector<TrackedFrame> again = track_four_pictures({});
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_TRUE(same_bits(once[i], again[i])) << i;
}

TEST(FeatureTracker, NumberOfThreadsDoesNotChangeTheResult) {
  FrontendConfig two_threads;
  two_threads.grid.threads = 2;
  const std::vector<TrackedFrame> serial = track_four_pictures({});
  const std::vector<TrackedFrame> parallel = track_four_pictures(two_threads);
  for (std::size_t i = 0; i < serial.size(); ++i) EXPECT_TRUE(same_bits(serial[i], parallel[i])) << i;
}

TEST(FeatureTracker, FeaturesComeInOrderOfTheirIdAndFinite) {
  for (const TrackedFrame& result : track_four_pictures({})) {
    EXPECT_TRUE(std::is_sorted(result.features.begin(), result.features.end(),
                               [](const auto& a, const auto& b) { return a.id < b.id; }));
    for (const TrackedFeature& feature : result.features) {
      EXPECT_TRUE(feature.pixel.allFinite() && feature.bearing.allFinite() && feature.velocity.allFinite());
    }
  }
}

TEST(FeatureTracker, CircularMaskKeepsFeaturesApart) {
  const TrackedFrame last = track_four_pictures({}).back();
  for (const TrackedFeature& a : last.features) {
    for (const TrackedFeature& b : last.features) {
      // A circle is drawn around the rounded pixel: 30 px less the rounding of both centres, 2 * sqrt(0.5).
      EXPECT_TRUE(a.id == b.id || (a.pixel - b.pixel).norm() > 28.5) << a.id << " " << b.id;
    }
  }
}

TEST(FeatureTracker, NothingIsBornWhereFeaturesWereLost) {
  const TexturedPlane plane = test_plane();
  const Frame first = plane.frame_at(Pose{}, 0);
  Frame second = plane.frame_at(Pose{}, 1);
  const cv::Rect covered(160, 120, 320, 240);  // an object comes into view: other texture, no match
  const cv::Mat other = random_texture(second.gray.size(), 99);
  other(covered).copyTo(second.gray(covered));
  const auto births_near_losses = [&](bool circular_mask) {
    FrontendConfig config;
    config.forward_backward = true;
    config.unpredicted_pyramid_levels = 1;  // no far false matches for RANSAC to find,
    config.ransac_threshold_px = 20.0;      // so that features are lost by KLT alone,
    config.min_distance_px = 1;             // and not to older ones that come too close
    config.circular_mask = circular_mask;
    FeatureTracker tracker(config, test_camera());
    const TrackedFrame before = tracker.track(first, {}, kDetect);
    const TrackedFrame after = tracker.track(second, {}, kDetect);
    int births = 0;
    for (const TrackedFeature& born : after.features) {
      if (born.age > 1) continue;
      births += static_cast<int>(
          std::count_if(before.features.begin(), before.features.end(), [&](const auto& old) {
            const bool gone = std::none_of(after.features.begin(), after.features.end(),
                                           [&](const auto& feature) { return feature.id == old.id; });
            return gone && (old.pixel - born.pixel).norm() < 28.5;
          }));
    }
    return births;
  };
  EXPECT_EQ(births_near_losses(true), 0);
  EXPECT_GT(births_near_losses(false), 5);
}

TEST(FeatureTracker, DepthComesFromThePictureAndIsNotInvented) {
  Frame frame = test_plane().frame_at(Pose{}, 0);
  frame.depth(cv::Rect(0, 0, 320, 480)).setTo(0);  // left half: not measured
  FeatureTracker tracker({}, test_camera());
  for (const TrackedFeature& feature : tracker.track(frame, {}, kDetect).features) {
    EXPECT_EQ(feature.depth, feature.pixel.x() < 319.5 ? 0.0 : kDistance);
  }
  frame.depth = cv::Mat();
  FeatureTracker without_depth({}, test_camera());
  for (const TrackedFeature& feature : without_depth.track(frame, {}, kDetect).features) {
    EXPECT_EQ(feature.depth, 0.0);
  }
}

TEST(FeatureTracker, ResetForgetsFeaturesButNotTheirIds) {
  const Frame frame = test_plane().frame_at(Pose{}, 0);
  FeatureTracker tracker({}, test_camera());
  const std::int64_t last_id = tracker.track(frame, {}, kDetect).features.back().id;
  tracker.reset();
  const TrackedFrame anew = tracker.track(test_plane().frame_at(Pose{}, 1), {}, kDetect);
  ASSERT_FALSE(anew.features.empty());
  EXPECT_EQ(anew.features.front().id, last_id + 1);
  EXPECT_EQ(anew.features.front().age, 1);
}

TEST(FeatureTracker, RefusesPicturesOfAnotherSize) {
  FeatureTracker tracker({}, test_camera());
  Frame frame = test_plane().frame_at(Pose{}, 3);
  frame.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(1000));
  try {
    static_cast<void>(tracker.track(frame, {}, kDetect));
    FAIL() << "accepted a depth picture of another size";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "frame 3: depth picture is 320x240 CV_16UC1, not 640x480 CV_16UC1; "
                 "register it to the colour picture");
  }
  frame.gray = cv::Mat();
  EXPECT_THROW(static_cast<void>(tracker.track(frame, {}, kDetect)), InputError);
}

TEST(FeatureTracker, CountsEachModuleOncePerPicture) {
  const TrackedFrame last = track_four_pictures({}).back();
  for (const Module module : {Module::kFeatureTracking, Module::kFeatureDetection, Module::kOutlierRejection,
                              Module::kFeatureMask, Module::kTrackingThread}) {
    EXPECT_EQ(last.timings[module].calls, 1) << module_name(module);
    EXPECT_GT(last.timings[module].ns, 0) << module_name(module);
  }
}

/// How many features of the right third, which stands still, are left when the rest of the picture goes 9 px
/// to the side. Its features are known to move.
int count_still_behind_a_mover(bool reject_among_still) {
  constexpr int kEdge = 430;
  FrontendConfig config;
  config.outlier_model = OutlierModel::kRigid;
  config.reject_among_still = reject_among_still;
  const TexturedPlane plane = test_plane();
  const Frame standing = plane.frame_at(Pose{}, 0);
  Frame later =
      plane.frame_at(Pose{Eigen::Quaterniond::Identity(), {0.036, 0.0, 0.0}}, 1);  // 500 * 0.036 / 2
  const cv::Rect still(kEdge, 0, standing.gray.cols - kEdge, standing.gray.rows);
  standing.gray(still).copyTo(later.gray(still));
  FeatureTracker tracker(config, test_camera());
  std::vector<std::int64_t> moving, behind;
  for (const TrackedFeature& feature : tracker.track(standing, {}, kDetect).features) {
    (feature.pixel.x() < kEdge ? moving : behind).push_back(feature.id);
  }
  const TrackedFrame found = tracker.track(later, {}, kDetect, moving);
  return static_cast<int>(std::ranges::count_if(found.features, [&](const TrackedFeature& feature) {
    return std::ranges::binary_search(behind, feature.id);
  }));
}

TEST(FeatureTracker, AMoverWhoFillsThePictureWinsUnlessItIsKnown) {
  EXPECT_LT(count_still_behind_a_mover(false), 5);  // those on the edge of the mover
  EXPECT_GT(count_still_behind_a_mover(true), 20);  // a third of some 100, and some that the edge takes away
}

}  // namespace
}  // namespace stillpoint
