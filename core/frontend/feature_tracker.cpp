// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/feature_tracker.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/frontend/detect/feature_detector.h"
#include "core/frontend/drift_correction.h"
#include "core/frontend/outliers/outlier_rejection.h"
#include "core/frontend/point_tracker.h"
#include "core/frontend/track.h"
#include "core/frontend/view_recovery.h"

namespace stillpoint {
namespace {

using DynamicIds = std::span<const std::int64_t>;

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// @throws InputError unless the gray image is CV_8UC1 of the camera's size, and depth empty or CV_16UC1 of
/// that size
void check_frame(const Frame& frame, const Camera& camera) {
  const std::string location = "frame " + std::to_string(frame.id);
  const cv::Size expected(camera.width, camera.height);
  if (frame.gray.type() != CV_8UC1 || frame.gray.size() != expected) {
    throw InputError(location, "gray image is " + size_text(frame.gray.size()) + " " +
                                   cv::typeToString(frame.gray.type()) + ", expected " + size_text(expected) +
                                   " CV_8UC1; check the calibration");
  }
  if (frame.depth.empty()) return;
  if (frame.depth.type() != CV_16UC1 || frame.depth.size() != expected) {
    throw InputError(location, "depth image is " + size_text(frame.depth.size()) + " " +
                                   cv::typeToString(frame.depth.type()) + ", expected " +
                                   size_text(expected) + " CV_16UC1; register it to the color image");
  }
}

constexpr std::size_t kMinStatic = 20;  // with fewer static tracks nothing can break down
/// Smallest ratio of static tracks that continue. 0.5 to 0.8 give the same errors on recorded frames of 2.5
/// to 10 Hz (7-Scenes kitchen); at 30 Hz 0.8 of the tracks continue in every frame of it.
constexpr double kMinContinued = 0.5;

}  // namespace

/// Tracks are sorted by id, and therefore from the oldest to the newest.
struct FeatureTracker::State {
  State(const FrontendConfig& frontend_config, const Camera& frontend_camera)
      : config(frontend_config),
        camera(frontend_camera),
        detector(make_feature_detector(frontend_config)),
        drift_corrector(frontend_config, frontend_camera),
        view_recovery(frontend_config, frontend_camera) {}

  void advance(const Frame& frame, const MotionPrior& prior, const TrackingOptions& options);
  void track_features(const Frame& frame, const MotionPrior& prior, TrackerPrediction kind);
  void match_features(TrackerPrediction kind);
  void correct_drift(const Frame& frame, const MotionPrior& prior);
  void update_tracks(double interval_s);
  void reject_outliers(DynamicIds dynamic_ids, bool is_large);
  void rotate_views();
  [[nodiscard]] static std::size_t count_static(std::span<const Track> of, DynamicIds dynamic_ids);
  [[nodiscard]] bool breaks_down(DynamicIds dynamic_ids) const;
  bool track_again(const Frame& frame, double interval_s, DynamicIds dynamic_ids);
  void apply_mask();
  void detect_features(const cv::Mat& gray);
  void measure_depth(const Frame& frame);
  void update_references();

  FrontendConfig config;
  Camera camera;
  std::unique_ptr<FeatureDetector> detector;
  ImagePyramid previous;
  ImagePyramid current;
  Timestamp current_t;
  std::vector<Track> tracks;
  // Pixels of features lost since the last detection: the predicted pixel of a KLT failure, the current pixel
  // of a RANSAC outlier. The published code omits the outliers and the paper's "failed to be tracked" may
  // not include them; with them, features on dynamic objects are not redetected at every detection.
  std::vector<cv::Point2f> unstable;
  FeatureMask mask;
  OutlierRejector outlier_rejector;
  DriftCorrector drift_corrector;
  bool inertial_rotation = false;  // of a frame since the last detection
  ViewRecovery view_recovery;
  std::int64_t next_id = 0;

  // Buffers reused between calls.
  std::vector<cv::Point2f> pixels;
  std::vector<cv::Point2f> predicted;
  KltResult forward;
  std::vector<Match> correspondences;

  // Statistics of the current frame.
  int lost = 0;
  int detected = 0;
  ModuleTimings timings;
};

void FeatureTracker::State::advance(const Frame& frame, const MotionPrior& prior,
                                    const TrackingOptions& options) {
  lost = 0;
  detected = 0;
  const double interval_s = seconds_between(current_t, frame.t);
  {
    const ScopedTimer timer(timings, Module::kFeatureTracking);
    std::swap(previous, current);
    current = build_pyramid(config, frame.gray, std::move(current));
    if (!tracks.empty()) {
      track_features(frame, prior, usable_prediction(config.prediction, prior));
      update_tracks(interval_s);
    }
    current_t = frame.t;
  }
  if (options.detect) reject_outliers(options.dynamic_ids, false);
  if (config.recover_view) {
    const ScopedTimer timer(timings, Module::kFeatureTracking);
    const bool broken = options.detect && breaks_down(options.dynamic_ids) &&
                        !track_again(frame, interval_s, options.dynamic_ids);
    view_recovery.process(frame.gray, current, options.dynamic_ids, tracks);
    if (broken) view_recovery.break_down(options.dynamic_ids);
  }
  if (options.detect) {
    apply_mask();
    detect_features(frame.gray);
  }
  measure_depth(frame);
  if (config.drift_min_correlation > 0.0) DriftCorrector::begin_views(current, tracks);
  if (options.detect) update_references();
  if (config.recover_view) view_recovery.remember(frame, tracks);
}

void FeatureTracker::State::track_features(const Frame& frame, const MotionPrior& prior,
                                           TrackerPrediction kind) {
  predicted = predict_pixels(tracks, {prior, kind}, camera, std::move(predicted));
  match_features(kind);
  if (config.drift_min_correlation > 0.0) correct_drift(frame, prior);
}

void FeatureTracker::State::match_features(TrackerPrediction kind) {
  const bool predicts = kind != TrackerPrediction::kNone && kind == config.prediction;
  const int levels = predicts ? config.pyramid_levels : config.unpredicted_pyramid_levels;
  pixels = pixels_of(tracks, std::move(pixels));
  forward = track_points(
      config,
      {.from = previous, .to = current, .points = pixels, .initial_guesses = predicted, .levels = levels},
      std::move(forward));
}

void FeatureTracker::State::correct_drift(const Frame& frame, const MotionPrior& prior) {
  if (prior.has_rotation) DriftCorrector::rotate(prior.T_ccur_cprev.R(), tracks);
  inertial_rotation |= prior.has_rotation;
  drift_corrector.correct(frame, current, tracks, forward);
}

void FeatureTracker::State::update_tracks(double interval_s) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Eigen::Vector2d pixel = to_vector(forward.pixels[i]);
    const bool inside = pixel.allFinite() && camera.contains(pixel, kImageBorder_px);
    const Eigen::Vector2d bearing =
        camera.unproject(pixel);  // not finite where the distortion has no inverse
    if (forward.found[i] != 0 && inside && bearing.allFinite()) {
      Track& track = tracks[kept++];
      track = tracks[i];
      TrackedFeature& feature = track.feature;
      feature.velocity.setZero();
      if (interval_s > 0.0) feature.velocity = (bearing - feature.bearing) / interval_s;
      feature.bearing = bearing;
      feature.pixel = pixel;
      ++feature.age;
    } else if (camera.contains(to_vector(predicted[i]), kImageBorder_px)) {
      unstable.push_back(predicted[i]);
      ++lost;
    }
  }
  tracks.resize(kept);
}

void FeatureTracker::State::reject_outliers(DynamicIds dynamic_ids, bool is_large) {
  const ScopedTimer timer(timings, Module::kOutlierRejection);
  const auto is_exempt = [&](const Track& track) {
    return config.reject_static_only && std::ranges::binary_search(dynamic_ids, track.feature.id);
  };
  pixels = pixels_of(tracks, std::move(pixels));
  correspondences.clear();
  for (const Track& track : tracks) {
    if (is_exempt(track)) continue;
    correspondences.push_back({track.reference_bearing, track.reference_depth, track.feature.bearing});
  }
  const InlierMask& inliers =
      outlier_rejector.find(correspondences, {.model = config.outlier_model,
                                              .threshold_px = config.ransac_threshold_px,
                                              .min_inlier_ratio = config.ransac_min_inlier_ratio,
                                              .focal_px = camera.focal_px(),
                                              .is_large = is_large});
  auto inlier = inliers.begin();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (is_exempt(tracks[i]) || *inlier++ != 0) {
      tracks[kept++] = tracks[i];
    } else {
      unstable.push_back(pixels[i]);
      ++lost;
    }
  }
  tracks.resize(kept);
  if (config.drift_min_correlation > 0.0) rotate_views();
}

/// Without a gyroscope the rotation of a frame is known after its tracking only: its patches are warped by
/// that up to the last detection.
void FeatureTracker::State::rotate_views() {
  const std::optional<Pose>& motion = outlier_rejector.motion();
  if (motion && !inertial_rotation) DriftCorrector::rotate(motion->R(), tracks);
  inertial_rotation = false;
}

std::size_t FeatureTracker::State::count_static(std::span<const Track> of, DynamicIds dynamic_ids) {
  return static_cast<std::size_t>(std::ranges::count_if(
      of, [&](const Track& track) { return !std::ranges::binary_search(dynamic_ids, track.feature.id); }));
}

/// Whether few static tracks of the last image continue, or have no common motion.
bool FeatureTracker::State::breaks_down(DynamicIds dynamic_ids) const {
  const std::size_t before = count_static(view_recovery.last().tracks, dynamic_ids);
  if (before < kMinStatic) return false;
  return !outlier_rejector.has_model() ||
         static_cast<double>(count_static(tracks, dynamic_ids)) < kMinContinued * static_cast<double>(before);
}

/// Tracks the features of the last image again, predicted by the motion of matched descriptors, and keeps the
/// result with more of them. @return whether there is such a motion
bool FeatureTracker::State::track_again(const Frame& frame, double interval_s, DynamicIds dynamic_ids) {
  const std::optional<Pose> motion = view_recovery.motion_since_last(frame.gray, dynamic_ids);
  if (!motion) return false;
  const bool had_model = outlier_rejector.has_model();
  std::vector<Track> first = view_recovery.last().tracks;
  first.swap(tracks);
  std::vector<cv::Point2f> first_unstable = std::exchange(unstable, {});
  const int first_lost = std::exchange(lost, 0);
  const MotionPrior prior{*motion, true, true};
  predicted = predict_pixels(tracks, {prior, TrackerPrediction::kFull}, camera, std::move(predicted));
  forward = track_large_motion(config, camera,
                               {.gray = view_recovery.last().gray,
                                .tracks = tracks,
                                .T_now_before = *motion,
                                .now = current,
                                .predicted = predicted});
  if (config.drift_min_correlation > 0.0) correct_drift(frame, prior);
  update_tracks(interval_s);
  reject_outliers(dynamic_ids, true);
  const bool better = outlier_rejector.has_model() &&
                      (!had_model || count_static(tracks, dynamic_ids) > count_static(first, dynamic_ids));
  if (!better) {
    tracks = std::move(first);
    unstable = std::move(first_unstable);
    lost = first_lost;
  }
  return true;
}

void FeatureTracker::State::apply_mask() {
  const ScopedTimer timer(timings, Module::kFeatureMask);
  mask.clear(cv::Size(camera.width, camera.height));
  if (config.circular_mask) {
    pixels = pixels_of(tracks, std::move(pixels));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      if (mask.try_occupy(pixels[i], config.min_distance_px)) tracks[kept++] = tracks[i];
    }
    tracks.resize(kept);
    for (const cv::Point2f& pixel : unstable) mask.occupy_circle(pixel, config.unstable_radius_px);
  }
  unstable.clear();
}

void FeatureTracker::State::detect_features(const cv::Mat& gray) {
  const ScopedTimer timer(timings, Module::kFeatureDetection);
  pixels = pixels_of(tracks, std::move(pixels));
  const std::vector<cv::Point2f>& corners =
      detector->detect({.gray = gray,
                        .mask = mask,
                        .tracked = pixels,
                        .wanted = config.max_features - static_cast<int>(tracks.size()),
                        .min_distance_px = config.circular_mask ? config.min_distance_px : 0});
  for (const cv::Point2f& corner : corners) {
    if (!camera.unproject(to_vector(corner)).allFinite()) continue;
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

void FeatureTracker::State::update_references() {
  for (Track& track : tracks) {
    track.reference_bearing = track.feature.bearing;
    track.reference_depth = track.feature.depth;
  }
}

FeatureTracker::FeatureTracker(const FrontendConfig& config, const Camera& camera)
    : state_(std::make_unique<State>(config, camera)) {}

FeatureTracker::~FeatureTracker() = default;

TrackedFrame FeatureTracker::track(const Frame& frame, const MotionPrior& prior,
                                   const TrackingOptions& options, TrackedFrame recycled) {
  check_frame(frame, state_->camera);
  TrackedFrame result = std::move(recycled);
  state_->timings = std::move(result.timings);
  state_->timings.clear();
  {
    const ScopedTimer timer(state_->timings, Module::kTrackingThread);
    state_->advance(frame, prior, options);
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
  state_->view_recovery.reset();
  state_->detector->reset();
}

}  // namespace stillpoint
