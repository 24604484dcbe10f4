// SPDX-License-Identifier: BSD-3-Clause
/// The patch tracker against cv::calcOpticalFlowPyrLK: same 150 points, same start, pyramids built before;
/// with the median error against the known motion and the share of points kept.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>

#include "bench/micro/leaves_picture.h"
#include "core/frontend/feature_detector.h"
#include "core/frontend/patch_tracker.h"

namespace stillpoint {
namespace {

constexpr int kWindowPx = 21;
constexpr double kWrong_px = 2.0;  // further from the truth a match is a wrong one

/// Two pictures between which the camera has turned by a degree, come nearer by a hundredth, and moved.
struct Pair {
  cv::Mat from;
  cv::Mat to;
  cv::Mat motion;  // 2x3, `from` to `to`

  [[nodiscard]] cv::Point2f moved(const cv::Point2f& p) const {
    const auto m = [this](int row, int column) { return motion.at<double>(row, column); };
    return {static_cast<float>(m(0, 0) * p.x + m(0, 1) * p.y + m(0, 2)),
            static_cast<float>(m(1, 0) * p.x + m(1, 1) * p.y + m(1, 2))};
  }
};

void add_noise(cv::Mat& picture, std::uint64_t seed) {
  constexpr double kSigma = 2.0;  // [grey levels]
  cv::RNG random(seed);
  cv::Mat noise(picture.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, kSigma);
  cv::add(picture, noise, picture, cv::noArray(), CV_8UC1);
}

Pair moved_pair() {
  Pair pair;
  pair.from = leaves_picture();
  pair.motion = cv::getRotationMatrix2D({424.0F, 240.0F}, 1.0, 1.01);
  pair.motion.at<double>(0, 2) += 3.3;
  pair.motion.at<double>(1, 2) -= 2.6;
  cv::warpAffine(pair.from, pair.to, pair.motion, kPictureSize, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  add_noise(pair.from, 7);
  add_noise(pair.to, 8);
  return pair;
}

/// 150 corners as the odometry finds them.
std::vector<cv::Point2f> corners_of(const cv::Mat& gray) {
  FrontendConfig config;
  config.max_features = 150;
  FeatureMask mask;
  mask.clear(gray.size());
  return make_feature_detector(config)->detect(
      {.gray = gray, .mask = mask, .tracked = {}, .wanted = 150, .min_distance_px = 20});
}

/// Starts as far from the truth as a prediction is, in all directions.
std::vector<cv::Point2f> predictions(const Pair& pair, const std::vector<cv::Point2f>& points,
                                     double error_px) {
  std::vector<cv::Point2f> starts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double angle = 2.4 * static_cast<double>(i);  // [rad]
    starts.push_back(pair.moved(points[i]) + cv::Point2f(static_cast<float>(error_px * std::cos(angle)),
                                                         static_cast<float>(error_px * std::sin(angle))));
  }
  return starts;
}

void report_accuracy(benchmark::State& state, const Pair& pair, const std::vector<cv::Point2f>& points,
                     const KltResult& result) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = cv::norm(result.pixels[i] - pair.moved(points[i]));
    if (result.found[i] != 0 && error < kWrong_px) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  state.counters["points"] = static_cast<double>(points.size());
  state.counters["right"] = static_cast<double>(errors.size());
  state.counters["found"] =
      static_cast<double>(std::count(result.found.begin(), result.found.end(), std::uint8_t{1}));
  state.counters["median_px"] = errors.empty() ? -1.0 : errors[errors.size() / 2];
}

/// @param state ranges: levels, error of the start [px]
template <class Follow>
void follow(benchmark::State& state, Follow follow_all) {
  const Pair pair = moved_pair();
  const int levels = static_cast<int>(state.range(0));
  ImagePyramid from;
  ImagePyramid to;
  from.rebuild(pair.from, kWindowPx, levels);
  to.rebuild(pair.to, kWindowPx, levels);
  const std::vector<cv::Point2f> points = corners_of(pair.from);
  const std::vector<cv::Point2f> starts = predictions(pair, points, static_cast<double>(state.range(1)));
  KltResult result;
  for (auto _ : state) {
    result = follow_all(from, to, points, starts, levels);
    benchmark::DoNotOptimize(result);
  }
  report_accuracy(state, pair, points, result);
}

void opencv(benchmark::State& state) {
  cv::setNumThreads(1);  // one thread each, or the ratio depends on how busy the others are
  follow(state, [](const auto& from, const auto& to, const auto& points, const auto& starts, int levels) {
    return follow_points(from, to, points, starts, {.window_px = kWindowPx, .levels = levels});
  });
}

void follow_by_patches(benchmark::State& state, PatchTarget target) {
  follow(state,
         [target](const auto& from, const auto& to, const auto& points, const auto& starts, int levels) {
           return follow_patches(from, to, points, starts, levels, PatchSettings{}, target);
         });
}

void patch(benchmark::State& state) { follow_by_patches(state, PatchTarget::kBest); }
void patch_without_simd(benchmark::State& state) { follow_by_patches(state, PatchTarget::kPortable); }

void starts_of_increasing_difficulty(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"levels", "off_px"})
      ->Args({2, 2})
      ->Args({3, 4})
      ->Args({4, 8})
      ->Unit(benchmark::kMicrosecond);
}
BENCHMARK(opencv)->Apply(starts_of_increasing_difficulty);
BENCHMARK(patch)->Apply(starts_of_increasing_difficulty);
BENCHMARK(patch_without_simd)->Apply(starts_of_increasing_difficulty);

}  // namespace
}  // namespace stillpoint
