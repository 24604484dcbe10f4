// SPDX-License-Identifier: BSD-3-Clause
/// Cost of finding 130 features in a picture of 848x480: grid FAST against Shi-Tomasi.
#include <benchmark/benchmark.h>

#include "bench/micro/leaves_picture.h"
#include "core/frontend/feature_detector.h"
#include "core/frontend/grid_detector.h"

namespace stillpoint {
namespace {

constexpr int kMinDistancePx = 30;

FeatureMask mask_around(const std::vector<cv::Point2f>& tracked) {
  FeatureMask mask;
  mask.clear(kPictureSize);
  for (const cv::Point2f& pixel : tracked) mask.take_circle(pixel, kMinDistancePx);
  return mask;
}

/// Looks for what is missing beside a share of the features that a first detection gave.
/// @param kept_percent of them, those detected first
void detect_missing(benchmark::State& state, FrontendConfig config, std::size_t kept_percent) {
  const cv::Mat gray = leaves_picture();
  const std::unique_ptr<FeatureDetector> detector = make_feature_detector(config);
  const FeatureMask empty = mask_around({});
  std::vector<cv::Point2f> tracked = detector->detect({.gray = gray,
                                                       .mask = empty,
                                                       .tracked = {},
                                                       .wanted = config.max_features,
                                                       .min_distance_px = kMinDistancePx});
  tracked.resize(tracked.size() * kept_percent / 100);
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

/// @param state ranges: threads, percent of features that are there already
void grid_fast(benchmark::State& state) {
  FrontendConfig config;
  config.grid.threads = static_cast<int>(state.range(0));
  detect_missing(state, config, static_cast<std::size_t>(state.range(1)));
}
BENCHMARK(grid_fast)
    ->ArgNames({"threads", "kept_percent"})
    ->ArgsProduct({{1, 2}, {0, 75, 90}})
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

/// @param state range: percent of features that are there already
void shi_tomasi(benchmark::State& state) {
  FrontendConfig config;
  config.detector = FeatureDetectorKind::kShiTomasi;
  detect_missing(state, config, static_cast<std::size_t>(state.range(0)));
}
BENCHMARK(shi_tomasi)
    ->ArgName("kept_percent")
    ->Arg(0)
    ->Arg(75)
    ->Arg(90)
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace stillpoint
