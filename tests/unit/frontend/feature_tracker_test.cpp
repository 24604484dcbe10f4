// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/feature_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "tests/support/published_config.h"
#include "tests/unit/frontend/textured_image.h"

namespace stillpoint {
namespace {

constexpr double kDistance = 2.0;  // [m] of the plane
constexpr TrackingOptions kDetect{.detect = true};
constexpr TrackingOptions kTrackOnly{.detect = false};

const Pose kSmallMotion{exp_so3({0.002, -0.003, 0.004}), {0.01, -0.005, 0.02}};  // 1 to 4 px
const Pose kLargeRotation{exp_so3({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};    // 500 px * 0.1 rad = 50 px
const Pose kLargeShift{Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}};         // 500 px * 0.2 / 2 = 50 px

MotionPrior exact_prior(const Pose& T_ccur_cprev) {
  return {.T_ccur_cprev = T_ccur_cprev, .has_rotation = true, .has_translation = true};
}

TexturedPlane test_plane() { return {test_camera(), kDistance, 7}; }

/// Number of features of the first frame tracked into the second within half a pixel of the true position.
int count_tracked(const FrontendConfig& config, const Pose& motion, const MotionPrior& prior) {
  const TexturedPlane plane = test_plane();
  FeatureTracker tracker(config, test_camera());
  const TrackedFrame first = tracker.track(plane.frame_at(Pose{}, 0), {}, kDetect);
  const TrackedFrame second = tracker.track(plane.frame_at(motion, 1), prior, kTrackOnly);
  int correct = 0;
  for (const TrackedFeature& feature : second.features) {
    const Eigen::Vector2d expected =
        plane.pixel_in(motion, first.features[static_cast<std::size_t>(feature.id)].pixel);
    if ((feature.pixel - expected).norm() < 0.5) ++correct;
  }
  return correct;
}

FrontendConfig one_level(TrackerPrediction prediction) {
  FrontendConfig config = published_config().frontend;
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

std::vector<TrackedFrame> track_four_frames(const FrontendConfig& config) {
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

TEST(FeatureTracker, DropsFeaturesWhoseUndistortionIsNotFinite) {
  Camera camera = test_camera();
  camera.distortion[0] = std::numeric_limits<double>::quiet_NaN();
  FeatureTracker tracker(FrontendConfig{}, camera);
  const TrackedFrame frame = tracker.track(test_plane().frame_at(Pose{}, 0), {}, kDetect);
  EXPECT_TRUE(frame.features.empty());
}

TEST(FeatureTracker, FirstFrameReturnsNewFeaturesWithoutVelocity) {
  FeatureTracker tracker({}, test_camera());
  const TrackedFrame result = tracker.track(test_plane().frame_at(Pose{}, 0), {}, kDetect);
  ASSERT_GT(result.features.size(),
            80U);  // of 130 wanted; about 150 circles of 30 px fit into 640x480
  EXPECT_LE(result.features.size(), 130U);
  EXPECT_EQ(result.detected, static_cast<int>(result.features.size()));
  EXPECT_EQ(result.lost, 0);
  for (std::size_t i = 0; i < result.features.size(); ++i) {
    EXPECT_EQ(result.features[i].id, static_cast<std::int64_t>(i));
    EXPECT_EQ(result.features[i].age, 1);
    EXPECT_TRUE(result.features[i].velocity.isZero());
  }
}

TEST(FeatureTracker, DetectsNothingWithoutTheDetectFlag) {
  FeatureTracker tracker({}, test_camera());
  EXPECT_TRUE(tracker.track(test_plane().frame_at(Pose{}, 0), {}, kTrackOnly).features.empty());
}

TEST(FeatureTracker, TracksKnownMotionWithSubpixelAccuracy) {
  const TexturedPlane plane = test_plane();
  FeatureTracker tracker({}, test_camera());
  const TrackedFrame first = tracker.track(plane.frame_at(Pose{}, 0), {}, kDetect);
  const TrackedFrame second = tracker.track(plane.frame_at(kSmallMotion, 1), {}, kTrackOnly);
  ASSERT_GT(second.features.size(), first.features.size() * 9 / 10);
  std::vector<double> errors;
  for (const TrackedFeature& feature : second.features) {
    const TrackedFeature& before = first.features[static_cast<std::size_t>(feature.id)];
    errors.push_back((feature.pixel - plane.pixel_in(kSmallMotion, before.pixel)).norm());
    EXPECT_EQ(feature.age, 2);
    // Frames are 0.1 s apart.
    EXPECT_LT((feature.velocity - 10.0 * (feature.bearing - before.bearing)).norm(), 1e-9);
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);  // KLT on noise-free texture: a tenth of a pixel
}

TEST(FeatureTracker, RotationPriorReplacesPyramidLevels) {
  const MotionPrior prior = exact_prior(kLargeRotation);
  EXPECT_GT(count_tracked(one_level(TrackerPrediction::kRotation), kLargeRotation, prior), 70);
  // 50 px is far beyond the 10 px range of a single level.
  EXPECT_LT(count_tracked(one_level(TrackerPrediction::kNone), kLargeRotation, prior), 5);
}

TEST(FeatureTracker, FullPriorPredictsTranslationAtTheFeatureDepth) {
  const MotionPrior prior = exact_prior(kLargeShift);
  EXPECT_GT(count_tracked(one_level(TrackerPrediction::kFull), kLargeShift, prior), 70);
  EXPECT_LT(count_tracked(one_level(TrackerPrediction::kRotation), kLargeShift, prior), 5);
}

TEST(FeatureTracker, WithoutAValidPriorUsesMorePyramidLevels) {
  FrontendConfig config = one_level(TrackerPrediction::kFull);
  config.unpredicted_pyramid_levels = 5;
  const Pose motion{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}};  // 25 px
  MotionPrior broken = exact_prior(motion);
  broken.T_ccur_cprev.q.coeffs()[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(count_tracked(config, motion, broken), 70);
  EXPECT_GT(count_tracked(config, motion, MotionPrior{}), 70);
}

/// Before the inertial start, or while inertial data is wrong.
TEST(FeatureTracker, WithoutTheTranslationOfAFullPriorUsesMorePyramidLevels) {
  FrontendConfig config = one_level(TrackerPrediction::kFull);
  config.unpredicted_pyramid_levels = 5;
  const Pose motion{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}};  // 25 px
  const MotionPrior rotation{.has_rotation = true};
  EXPECT_GT(count_tracked(config, motion, rotation), 70);
  config.prediction = TrackerPrediction::kRotation;
  EXPECT_LT(count_tracked(config, motion, rotation), 20);
}

TEST(FeatureTracker, BlankImagesHaveNoFeatures) {
  FeatureTracker tracker({}, test_camera());
  Frame frame = test_plane().frame_at(Pose{}, 0);
  frame.gray.setTo(90);
  EXPECT_TRUE(tracker.track(frame, {}, kDetect).features.empty());
}

TEST(FeatureTracker, IsDeterministic) {
  const std::vector<TrackedFrame> first_run = track_four_frames({});
  const std::vector<TrackedFrame> second_run = track_four_frames({});
  for (std::size_t i = 0; i < first_run.size(); ++i) EXPECT_TRUE(same_bits(first_run[i], second_run[i])) << i;
}

TEST(FeatureTracker, NumberOfThreadsDoesNotChangeTheResult) {
  FrontendConfig two_threads;
  two_threads.grid.threads = 2;
  const std::vector<TrackedFrame> serial = track_four_frames({});
  const std::vector<TrackedFrame> parallel = track_four_frames(two_threads);
  for (std::size_t i = 0; i < serial.size(); ++i) EXPECT_TRUE(same_bits(serial[i], parallel[i])) << i;
}

TEST(FeatureTracker, FeaturesAreSortedByIdAndFinite) {
  for (const TrackedFrame& result : track_four_frames({})) {
    EXPECT_TRUE(std::is_sorted(result.features.begin(), result.features.end(),
                               [](const auto& a, const auto& b) { return a.id < b.id; }));
    for (const TrackedFeature& feature : result.features) {
      EXPECT_TRUE(feature.pixel.allFinite() && feature.bearing.allFinite() && feature.velocity.allFinite());
    }
  }
}

TEST(FeatureTracker, CircularMaskEnforcesTheMinimumDistance) {
  const TrackedFrame last = track_four_frames(published_config().frontend).back();
  for (const TrackedFeature& a : last.features) {
    for (const TrackedFeature& b : last.features) {
      // Circles are drawn around rounded pixels: 30 px minus the rounding of both centers, 2 * sqrt(0.5).
      EXPECT_TRUE(a.id == b.id || (a.pixel - b.pixel).norm() > 28.5) << a.id << " " << b.id;
    }
  }
}

TEST(FeatureTracker, DetectsNothingNearLostFeatures) {
  const TexturedPlane plane = test_plane();
  const Frame first = plane.frame_at(Pose{}, 0);
  Frame second = plane.frame_at(Pose{}, 1);
  const cv::Rect covered(160, 120, 320, 240);  // an object enters the image: other texture, no match
  const cv::Mat other = random_texture(second.gray.size(), 99);
  other(covered).copyTo(second.gray(covered));
  const auto detections_near_losses = [&](bool circular_mask) {
    FrontendConfig config = published_config().frontend;
    config.tracker = TrackerKind::kPatch;   // it loses features by their correlation
    config.unpredicted_pyramid_levels = 1;  // no distant false matches for RANSAC to reject,
    config.ransac_threshold_px = 20.0;      // so that features are lost by KLT alone,
    config.min_distance_px = 1;             // and not by the minimum distance to older ones
    config.circular_mask = circular_mask;
    FeatureTracker tracker(config, test_camera());
    const TrackedFrame before = tracker.track(first, {}, kDetect);
    const TrackedFrame after = tracker.track(second, {}, kDetect);
    int detections = 0;
    for (const TrackedFeature& detected : after.features) {
      if (detected.age > 1) continue;
      detections += static_cast<int>(
          std::count_if(before.features.begin(), before.features.end(), [&](const auto& old) {
            const bool gone = std::none_of(after.features.begin(), after.features.end(),
                                           [&](const auto& feature) { return feature.id == old.id; });
            return gone && (old.pixel - detected.pixel).norm() < 28.5;
          }));
    }
    return detections;
  };
  EXPECT_EQ(detections_near_losses(true), 0);
  EXPECT_GT(detections_near_losses(false), 5);
}

TEST(FeatureTracker, DepthIsTheMeasuredDepthOrZero) {
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

TEST(FeatureTracker, ResetRemovesFeaturesAndDoesNotReuseIds) {
  const Frame frame = test_plane().frame_at(Pose{}, 0);
  FeatureTracker tracker({}, test_camera());
  const std::int64_t last_id = tracker.track(frame, {}, kDetect).features.back().id;
  tracker.reset();
  const TrackedFrame after_reset = tracker.track(test_plane().frame_at(Pose{}, 1), {}, kDetect);
  ASSERT_FALSE(after_reset.features.empty());
  EXPECT_EQ(after_reset.features.front().id, last_id + 1);
  EXPECT_EQ(after_reset.features.front().age, 1);
}

TEST(FeatureTracker, RejectsImagesOfAnotherSize) {
  FeatureTracker tracker({}, test_camera());
  Frame frame = test_plane().frame_at(Pose{}, 3);
  frame.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(1000));
  try {
    static_cast<void>(tracker.track(frame, {}, kDetect));
    FAIL() << "accepted a depth image of another size";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "frame 3: depth image is 320x240 CV_16UC1, expected 640x480 CV_16UC1; "
                 "register it to the color image");
  }
  frame.gray = cv::Mat();
  EXPECT_THROW(static_cast<void>(tracker.track(frame, {}, kDetect)), InputError);
}

TEST(FeatureTracker, CountsEachModuleOncePerFrame) {
  const TrackedFrame last = track_four_frames(published_config().frontend).back();
  for (const Module module : {Module::kFeatureTracking, Module::kFeatureDetection, Module::kOutlierRejection,
                              Module::kFeatureMask, Module::kTrackingThread}) {
    EXPECT_EQ(last.timings[module].calls, 1) << module_name(module);
    EXPECT_GT(last.timings[module].ns, 0) << module_name(module);
  }
}

/// Number of features left in the static right third of the image when the rest of the image moves sideways
/// by 9 px. The features of the moving part are given as dynamic.
int count_static_features_left(bool reject_static_only) {
  constexpr int kEdge = 430;
  FrontendConfig config = published_config().frontend;
  config.outlier_model = OutlierModel::kRigid;
  config.reject_static_only = reject_static_only;
  const TexturedPlane plane = test_plane();
  const Frame before = plane.frame_at(Pose{}, 0);
  Frame after =
      plane.frame_at(Pose{Eigen::Quaterniond::Identity(), {0.036, 0.0, 0.0}}, 1);  // 500 * 0.036 / 2
  const cv::Rect static_part(kEdge, 0, before.gray.cols - kEdge, before.gray.rows);
  before.gray(static_part).copyTo(after.gray(static_part));
  FeatureTracker tracker(config, test_camera());
  std::vector<std::int64_t> dynamic_ids, static_ids;
  for (const TrackedFeature& feature : tracker.track(before, {}, kDetect).features) {
    (feature.pixel.x() < kEdge ? dynamic_ids : static_ids).push_back(feature.id);
  }
  const TrackedFrame found = tracker.track(after, {}, {.dynamic_ids = dynamic_ids});
  return static_cast<int>(std::ranges::count_if(found.features, [&](const TrackedFeature& feature) {
    return std::ranges::binary_search(static_ids, feature.id);
  }));
}

TEST(FeatureTracker, ADominantDynamicObjectBecomesTheConsensusUnlessExcluded) {
  EXPECT_LT(count_static_features_left(false), 5);  // those at the boundary
  EXPECT_GT(count_static_features_left(true), 20);  // a third of about 100, minus those at the boundary
}

}  // namespace
}  // namespace stillpoint
