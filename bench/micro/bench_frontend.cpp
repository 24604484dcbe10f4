// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the front end in synthetic images of 848x480 px: detection of 130 features by grid FAST and
/// Shi-Tomasi; KLT, and the whole tracking thread with 130 features ("items" are points or frames); and the
/// patch tracker versus cv::calcOpticalFlowPyrLK with the same 150 points and initial guesses, without
/// building the pyramids, for which the median error and the number of correct matches are reported.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/frontend/detect/feature_detector.h"
#include "core/frontend/detect/grid_detector.h"
#include "core/frontend/feature_tracker.h"
#include "core/frontend/klt/klt.h"
#include "core/frontend/patch/patch_tracker.h"

namespace stillpoint {
namespace {

/// Image size of OpenLORIS, as used in the paper.
const cv::Size kImageSize(848, 480);

/// "Dead leaves" image (overlapping rectangles with a power-law size distribution, which reproduces the
/// statistics of edges, flat areas and corners in natural images; Lee, Mumford and Huang 2001) with sensor
/// noise. `shift_px` moves the view to the right.
cv::Mat dead_leaves_image(int shift_px = 0) {
  constexpr int kMaxShiftPx = 64;
  constexpr int kLeaves = 3000;
  cv::Mat leaves(kImageSize.height, kImageSize.width + kMaxShiftPx, CV_8UC1, cv::Scalar(128));
  cv::RNG random(1);
  for (int i = 0; i < kLeaves; ++i) {
    const double side_px = 6.0 / (0.03 + random.uniform(0.0, 1.0));  // 6 to 200
    const int y = random.uniform(-100, leaves.rows), x = random.uniform(-100, leaves.cols);
    const cv::Size size(cvRound(side_px), cvRound(side_px * random.uniform(0.5, 2.0)));
    cv::rectangle(leaves, cv::Rect({x, y}, size), random.uniform(20, 236), cv::FILLED);
  }
  cv::GaussianBlur(leaves, leaves, cv::Size(), 1.0);
  cv::Mat image = leaves(cv::Rect({shift_px, 0}, kImageSize)).clone();
  cv::Mat noise(image.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::add(image, noise, image, cv::noArray(), CV_8UC1);
  return image;
}

constexpr int kMinDistancePx = 30;

FeatureMask mask_around(const std::vector<cv::Point2f>& tracked) {
  FeatureMask mask;
  mask.clear(kImageSize);
  for (const cv::Point2f& pixel : tracked) mask.occupy_circle(pixel, kMinDistancePx);
  return mask;
}

/// Detects the features missing after a part of the features of a first detection was kept.
/// @param tracked_percent percentage kept, in order of detection
void detect_missing(benchmark::State& state, FrontendConfig config, std::size_t tracked_percent) {
  const cv::Mat gray = dead_leaves_image();
  const std::unique_ptr<FeatureDetector> detector = make_feature_detector(config);
  const FeatureMask empty = mask_around({});
  std::vector<cv::Point2f> tracked = detector->detect({.gray = gray,
                                                       .mask = empty,
                                                       .tracked = {},
                                                       .wanted = config.max_features,
                                                       .min_distance_px = kMinDistancePx});
  tracked.resize(tracked.size() * tracked_percent / 100);
  const FeatureMask mask = mask_around(tracked);
  for (auto _ : state) {
    detector->reset();
    benchmark::DoNotOptimize(
        detector->detect({.gray = gray,
                          .mask = mask,
                          .tracked = tracked,
                          .wanted = config.max_features - static_cast<int>(tracked.size()),
                          .min_distance_px = kMinDistancePx}));
  }
}

/// @param state ranges: threads, percentage of features already tracked
void grid_fast(benchmark::State& state) {
  FrontendConfig config;
  config.grid.threads = static_cast<int>(state.range(0));
  detect_missing(state, config, static_cast<std::size_t>(state.range(1)));
}
BENCHMARK(grid_fast)
    ->ArgNames({"threads", "tracked_percent"})
    ->ArgsProduct({{1, 2}, {0, 75, 90}})
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

/// @param state range: percentage of features already tracked
void shi_tomasi(benchmark::State& state) {
  FrontendConfig config;
  config.detector = FeatureDetectorKind::kShiTomasi;
  detect_missing(state, config, static_cast<std::size_t>(state.range(0)));
}
BENCHMARK(shi_tomasi)
    ->ArgName("tracked_percent")
    ->Arg(0)
    ->Arg(75)
    ->Arg(90)
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

constexpr int kWindowPx = 21;
constexpr int kShiftPx = 4;

void build_pyramid(benchmark::State& state) {
  const cv::Mat gray = dead_leaves_image();
  ImagePyramid pyramid;
  for (auto _ : state) pyramid.rebuild(gray, kWindowPx, static_cast<int>(state.range(0)));
}
BENCHMARK(build_pyramid)->ArgName("levels")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

/// A regular grid of 13 x 10 points.
std::vector<cv::Point2f> grid_points() {
  std::vector<cv::Point2f> points;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 13; ++x) {
      points.emplace_back(static_cast<float>(40 + 62 * x), static_cast<float>(30 + 46 * y));
    }
  }
  return points;
}

/// @param state ranges: pyramid levels, error of the prediction [px], window [px]
void track_130_points(benchmark::State& state) {
  const int window_px = static_cast<int>(state.range(2));
  const int levels = static_cast<int>(state.range(0));
  ImagePyramid from;
  ImagePyramid to;
  from.rebuild(dead_leaves_image(0), window_px, levels);
  to.rebuild(dead_leaves_image(kShiftPx), window_px, levels);
  const std::vector<cv::Point2f> points = grid_points();
  std::vector<cv::Point2f> initial_guesses = points;
  for (cv::Point2f& initial_guess : initial_guesses)
    initial_guess.x += static_cast<float>(state.range(1)) - kShiftPx;
  const TrackingRequest request{
      .from = from, .to = to, .points = points, .initial_guesses = initial_guesses, .levels = levels};
  for (auto _ : state) benchmark::DoNotOptimize(track_points_klt(request, {.window_px = window_px}));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(track_130_points)
    ->ArgNames({"levels", "error_px", "window_px"})
    ->Args({1, 1, 21})
    ->Args({2, 1, 21})
    ->Args({2, 1, 15})
    ->Args({4, 4, 21})
    ->Unit(benchmark::kMicrosecond);

/// @param state range: outlier model
void track_frame(benchmark::State& state) {
  const std::vector<cv::Mat> images = {dead_leaves_image(0), dead_leaves_image(2), dead_leaves_image(4),
                                       dead_leaves_image(2)};
  const Camera camera{.width = kImageSize.width,
                      .height = kImageSize.height,
                      .fx = 611.0,
                      .fy = 611.0,
                      .cx = 433.0,
                      .cy = 249.0};
  FrontendConfig config;
  config.outlier_model = static_cast<OutlierModel>(state.range(0));
  FeatureTracker tracker(config, camera);
  Frame frame;
  frame.depth = cv::Mat(kImageSize, CV_16UC1, cv::Scalar(2000));
  const MotionPrior no_motion{.T_ccur_cprev = {}, .has_rotation = true};
  for (auto _ : state) {
    frame.gray = images[static_cast<std::size_t>(frame.id) % images.size()];
    frame.t = Timestamp{frame.id * 33'333'333};
    benchmark::DoNotOptimize(tracker.track(frame, no_motion, {}));
    ++frame.id;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(track_frame)
    ->ArgName("model")
    ->Arg(static_cast<int>(OutlierModel::kEpipolar))
    ->Arg(static_cast<int>(OutlierModel::kRigid))
    ->Arg(static_cast<int>(OutlierModel::kMajority))
    ->Unit(benchmark::kMicrosecond);

constexpr double kMismatch_px = 2.0;  // matches farther from the true position are wrong

/// Two images related by a known rotation of 1 degree, scale of 1.01 and translation.
struct ImagePair {
  cv::Mat from;
  cv::Mat to;
  cv::Mat motion;  // 2x3, `from` to `to`

  [[nodiscard]] cv::Point2f true_position(const cv::Point2f& p) const {
    const auto m = [this](int row, int column) { return motion.at<double>(row, column); };
    return {static_cast<float>(m(0, 0) * p.x + m(0, 1) * p.y + m(0, 2)),
            static_cast<float>(m(1, 0) * p.x + m(1, 1) * p.y + m(1, 2))};
  }
};

void add_noise(cv::Mat& image, std::uint64_t seed) {
  constexpr double kSigma = 2.0;  // [grey levels]
  cv::RNG random(seed);
  cv::Mat noise(image.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, kSigma);
  cv::add(image, noise, image, cv::noArray(), CV_8UC1);
}

ImagePair make_image_pair() {
  ImagePair pair;
  pair.from = dead_leaves_image();
  pair.motion = cv::getRotationMatrix2D({424.0F, 240.0F}, 1.0, 1.01);
  pair.motion.at<double>(0, 2) += 3.3;
  pair.motion.at<double>(1, 2) -= 2.6;
  cv::warpAffine(pair.from, pair.to, pair.motion, kImageSize, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  add_noise(pair.from, 7);
  add_noise(pair.to, 8);
  return pair;
}

/// 150 corners, by the detector of the odometry.
std::vector<cv::Point2f> corners_of(const cv::Mat& gray) {
  FrontendConfig config;
  config.max_features = 150;
  FeatureMask mask;
  mask.clear(gray.size());
  return make_feature_detector(config)->detect(
      {.gray = gray, .mask = mask, .tracked = {}, .wanted = 150, .min_distance_px = 20});
}

/// Initial guesses with an error of `error_px` in varying directions, as from a motion prediction.
std::vector<cv::Point2f> predictions(const ImagePair& pair, const std::vector<cv::Point2f>& points,
                                     double error_px) {
  std::vector<cv::Point2f> initial_guesses;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double angle = 2.4 * static_cast<double>(i);  // [rad]
    initial_guesses.push_back(pair.true_position(points[i]) +
                              cv::Point2f(static_cast<float>(error_px * std::cos(angle)),
                                          static_cast<float>(error_px * std::sin(angle))));
  }
  return initial_guesses;
}

void report_accuracy(benchmark::State& state, const ImagePair& pair, const std::vector<cv::Point2f>& points,
                     const KltResult& result) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = cv::norm(result.pixels[i] - pair.true_position(points[i]));
    if (result.found[i] != 0 && error < kMismatch_px) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  state.counters["points"] = static_cast<double>(points.size());
  state.counters["correct"] = static_cast<double>(errors.size());
  state.counters["found"] =
      static_cast<double>(std::count(result.found.begin(), result.found.end(), std::uint8_t{1}));
  state.counters["median_px"] = errors.empty() ? -1.0 : errors[errors.size() / 2];
}

/// @param state ranges: levels, error of the initial guesses [px]
template <class Tracker>
void run_tracker(benchmark::State& state, Tracker track) {
  const ImagePair pair = make_image_pair();
  const int levels = static_cast<int>(state.range(0));
  ImagePyramid from;
  ImagePyramid to;
  from.rebuild(pair.from, kWindowPx, levels);
  to.rebuild(pair.to, kWindowPx, levels);
  const std::vector<cv::Point2f> points = corners_of(pair.from);
  const std::vector<cv::Point2f> initial_guesses =
      predictions(pair, points, static_cast<double>(state.range(1)));
  KltResult result;
  for (auto _ : state) {
    result = track(
        {.from = from, .to = to, .points = points, .initial_guesses = initial_guesses, .levels = levels});
    benchmark::DoNotOptimize(result);
  }
  report_accuracy(state, pair, points, result);
}

void opencv(benchmark::State& state) {
  cv::setNumThreads(1);  // single-threaded, for comparison with the patch tracker
  run_tracker(state, [](const TrackingRequest& request) {
    return track_points_klt(request, {.window_px = kWindowPx});
  });
}

void run_patch_tracker(benchmark::State& state, PatchTarget target) {
  run_tracker(state, [target](const TrackingRequest& request) {
    return track_points_patch(request, PatchSettings{}, target);
  });
}

void patch(benchmark::State& state) { run_patch_tracker(state, PatchTarget::kBest); }
void patch_portable(benchmark::State& state) { run_patch_tracker(state, PatchTarget::kPortable); }

void cases_of_increasing_difficulty(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"levels", "error_px"})
      ->Args({2, 2})
      ->Args({3, 4})
      ->Args({4, 8})
      ->Unit(benchmark::kMicrosecond);
}
BENCHMARK(opencv)->Apply(cases_of_increasing_difficulty);
BENCHMARK(patch)->Apply(cases_of_increasing_difficulty);
BENCHMARK(patch_portable)->Apply(cases_of_increasing_difficulty);

}  // namespace
}  // namespace stillpoint
