// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the patch tracker versus cv::calcOpticalFlowPyrLK with the same 150 points and initial
/// guesses, without building the pyramids. Reports the median error and the number of correct matches.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>

#include "bench/micro/dead_leaves_image.h"
#include "core/frontend/detect/feature_detector.h"
#include "core/frontend/patch/patch_tracker.h"

namespace stillpoint {
namespace {

constexpr int kWindowPx = 21;
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
