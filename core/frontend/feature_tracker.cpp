// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/feature_tracker.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/frontend/depth_sampling.h"
#include "core/frontend/feature_detector.h"
#include "core/frontend/feature_mask.h"
#include "core/frontend/feature_prediction.h"
#include "core/frontend/outlier_rejection.h"
#include "core/frontend/point_follower.h"
#include "core/frontend/track.h"

namespace stillpoint {
namespace {

constexpr double kClaheClip = 3.0;  // as VINS-Mono has it
const cv::Size kClaheTiles(8, 8);

using MovingIds = std::span<const std::int64_t>;

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void check_frame(const Frame& frame, const Camera& camera) {
  const std::string place = "frame " + std::to_string(frame.id);
  const cv::Size expected(camera.width, camera.height);
  if (frame.gray.type() != CV_8UC1 || frame.gray.size() != expected) {
    throw InputError(place, "gray picture is " + size_text(frame.gray.size()) + " " +
                                cv::typeToString(frame.gray.type()) + ", the camera gives " +
                                size_text(expected) + " CV_8UC1; check the calibration");
  }
  if (frame.depth.empty()) return;
  if (frame.depth.type() != CV_16UC1 || frame.depth.size() != expected) {
    throw InputError(place, "depth picture is " + size_text(frame.depth.size()) + " " +
                                cv::typeToString(frame.depth.type()) + ", not " + size_text(expected) +
                                " CV_16UC1; register it to the colour picture");
  }
}

Eigen::Vector2d to_vector(const cv::Point2f& point) {
  return {static_cast<double>(point.x), static_cast<double>(point.y)};
}

std::vector<cv::Point2f> pixels_of(const std::vector<Track>& tracks, std::vector<cv::Point2f> memory) {
  std::vector<cv::Point2f> pixels = std::move(memory);
  pixels.clear();
  for (const Track& track : tracks) {
    pixels.emplace_back(static_cast<float>(track.feature.pixel.x()),
                        static_cast<float>(track.feature.pixel.y()));
  }
  return pixels;
}

}  // namespace

/// Tracks are in order of their id, so also from the oldest to the youngest.
struct FeatureTracker::State {
  State(const FrontendConfig& frontend_config, const Camera& frontend_camera)
      : config(frontend_config), camera(frontend_camera), detector(make_feature_detector(frontend_config)) {
    if (config.equalize) equalizer = cv::createCLAHE(kClaheClip, kClaheTiles);
  }

  void advance(const Frame& frame, const MotionPrior& prior, bool detect, MovingIds moving);
  void follow_tracks(const MotionPrior& prior, double interval_s);
  void match(TrackerPrediction kind);
  void accept(double interval_s);
  void reject_outliers(MovingIds moving);
  void apply_mask();
  void find_new(const cv::Mat& gray);
  void measure_depth(const Frame& frame);
  void remember_references();

  FrontendConfig config;
  Camera camera;
  std::unique_ptr<FeatureDetector> detector;
  cv::Ptr<cv::CLAHE> equalizer;  // null unless config.equalize
  cv::Mat equalized;
  ImagePyramid previous;
  ImagePyramid current;
  Timestamp current_t;
  std::vector<Track> tracks;
  // Where features were lost since the last detection: the predicted pixel where KLT failed, the present one
  // where the motion did not fit. The paper's "failed to be tracked" may not mean the latter, the published
  // code leaves them out; with them, features on movers are not born again at every detection.
  std::vector<cv::Point2f> unstable;
  FeatureMask mask;
  OutlierSearch outliers;
  std::int64_t next_id = 0;

  // Memory of what one step hands to the next.
  std::vector<cv::Point2f> pixels;
  std::vector<cv::Point2f> predicted;
  KltResult matches;
  KltResult back;
  std::vector<Match> pairs;

  // Of the present picture.
  int lost = 0;
  int detected = 0;
  ModuleTimings timings;
};

void FeatureTracker::State::advance(const Frame& frame, const MotionPrior& prior, bool detect,
                                    MovingIds moving) {
  lost = 0;
  detected = 0;
  if (equalizer) equalizer->apply(frame.gray, equalized);
  const cv::Mat& gray = equalizer ? equalized : frame.gray;
  {
    const ScopedTimer timer(timings, Module::kFeatureTracking);
    std::swap(previous, current);
    rebuild_pyramid(config, gray, current);
    if (!tracks.empty()) follow_tracks(prior, seconds_between(current_t, frame.t));
    current_t = frame.t;
  }
  if (detect) {
    reject_outliers(moving);
    apply_mask();
    find_new(gray);
  }
  measure_depth(frame);
  if (detect) remember_references();
}

void FeatureTracker::State::follow_tracks(const MotionPrior& prior, double interval_s) {
  const TrackerPrediction kind = usable_prediction(config.prediction, prior);
  predicted = predict_pixels(tracks, prior, kind, camera, std::move(predicted));
  match(kind);
  accept(interval_s);
}

void FeatureTracker::State::match(TrackerPrediction kind) {
  const bool predicts = kind != TrackerPrediction::kNone;
  const int levels = predicts ? config.pyramid_levels : config.unpredicted_pyramid_levels;
  pixels = pixels_of(tracks, std::move(pixels));
  matches = follow(config, previous, current, {.points = pixels, .starts = predicted, .levels = levels},
                   std::move(matches));
  if (!config.forward_backward) return;
  back = follow(config, current, previous, {.points = matches.pixels, .starts = pixels, .levels = 1},
                std::move(back));
  matches = keep_returning(pixels, std::move(matches), back, config.forward_backward_px);
}

void FeatureTracker::State::accept(double interval_s) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Eigen::Vector2d pixel = to_vector(matches.pixels[i]);
    const bool inside = pixel.allFinite() && camera.contains(pixel, config.border_px);
    if (matches.found[i] != 0 && inside) {
      Track& track = tracks[kept++];
      track = tracks[i];
      TrackedFeature& feature = track.feature;
      const Eigen::Vector2d bearing = camera.unproject(pixel);
      feature.velocity.setZero();
      if (interval_s > 0.0) feature.velocity = (bearing - feature.bearing) / interval_s;
      feature.bearing = bearing;
      feature.pixel = pixel;
      ++feature.age;
    } else if (camera.contains(to_vector(predicted[i]), config.border_px)) {
      unstable.push_back(predicted[i]);
      ++lost;
    }
  }
  tracks.resize(kept);
}

void FeatureTracker::State::reject_outliers(MovingIds moving) {
  const ScopedTimer timer(timings, Module::kOutlierRejection);
  const auto is_spared = [&](const Track& track) {
    return config.reject_among_still && std::ranges::binary_search(moving, track.feature.id);
  };
  pixels = pixels_of(tracks, std::move(pixels));
  pairs.clear();
  for (const Track& track : tracks) {
    if (is_spared(track)) continue;
    pairs.push_back({track.reference_bearing, track.reference_depth, track.feature.bearing});
  }
  const Inliers& inliers = outliers.find(pairs, {.model = config.outlier_model,
                                                 .threshold_px = config.ransac_threshold_px,
                                                 .confidence = config.ransac_confidence,
                                                 .min_inlier_share = config.ransac_min_inlier_share,
                                                 .focal_px = camera.focal_px()});
  auto inlier = inliers.begin();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (is_spared(tracks[i]) || *inlier++ != 0) {
      tracks[kept++] = tracks[i];
    } else {
      unstable.push_back(pixels[i]);
      ++lost;
    }
  }
  tracks.resize(kept);
}

void FeatureTracker::State::apply_mask() {
  const ScopedTimer timer(timings, Module::kFeatureMask);
  mask.clear(cv::Size(camera.width, camera.height));
  if (config.circular_mask) {
    pixels = pixels_of(tracks, std::move(pixels));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      if (mask.claim(pixels[i], config.min_distance_px)) tracks[kept++] = tracks[i];
    }
    tracks.resize(kept);
    for (const cv::Point2f& pixel : unstable) mask.take_circle(pixel, config.unstable_radius_px);
  }
  unstable.clear();
}

void FeatureTracker::State::find_new(const cv::Mat& gray) {
  const ScopedTimer timer(timings, Module::kFeatureDetection);
  pixels = pixels_of(tracks, std::move(pixels));
  const std::vector<cv::Point2f>& corners =
      detector->detect({.gray = gray,
                        .mask = mask,
                        .tracked = pixels,
                        .wanted = config.max_features - static_cast<int>(tracks.size()),
                        .min_distance_px = config.circular_mask ? config.min_distance_px : 0});
  for (const cv::Point2f& corner : corners) {
    Track track;
    track.feature.id = next_id++;
    track.feature.pixel = to_vector(corner);
    track.feature.bearing = camera.unproject(track.feature.pixel);
    tracks.push_back(track);
  }
  detected = static_cast<int>(corners.size());
}

void FeatureTracker::State::measure_depth(const Frame& frame) {
  for (Track& track : tracks) {
    track.feature.depth =
        sample_depth(frame.depth, frame.depth_units_per_m, track.feature.pixel, config.depth_max_spread);
    if (track.feature.depth > 0.0) track.known_depth = track.feature.depth;
  }
}

void FeatureTracker::State::remember_references() {
  for (Track& track : tracks) {
    track.reference_bearing = track.feature.bearing;
    track.reference_depth = track.feature.depth;
  }
}

FeatureTracker::FeatureTracker(const FrontendConfig& config, const Camera& camera)
    : state_(std::make_unique<State>(config, camera)) {}

FeatureTracker::~FeatureTracker() = default;

TrackedFrame FeatureTracker::track(const Frame& frame, const MotionPrior& prior, bool detect,
                                   std::span<const std::int64_t> moving, TrackedFrame memory) {
  check_frame(frame, state_->camera);
  TrackedFrame result = std::move(memory);
  state_->timings = std::move(result.timings);
  state_->timings.clear();
  {
    const ScopedTimer timer(state_->timings, Module::kTrackingThread);
    state_->advance(frame, prior, detect, moving);
  }
  result.id = frame.id;
  result.t = frame.t;
  result.depth = frame.depth;
  result.depth_units_per_m = frame.depth_units_per_m;
  result.lost = state_->lost;
  result.detected = state_->detected;
  result.timings = std::move(state_->timings);
  result.features.clear();
  for (const Track& track : state_->tracks) result.features.push_back(track.feature);
  return result;
}

void FeatureTracker::reset() {
  state_->tracks.clear();
  state_->unstable.clear();
  state_->detector->reset();
}

}  // namespace stillpoint
