// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of detecting 130 features in an image of 848x480 px: grid FAST versus Shi-Tomasi.
#include <benchmark/benchmark.h>

#include "bench/micro/dead_leaves_image.h"
#include "core/frontend/detect/feature_detector.h"
#include "core/frontend/detect/grid_detector.h"

namespace stillpoint {
namespace {

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

}  // namespace
}  // namespace stillpoint
