// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of KLT at 848x480 and of the whole tracking thread with 130 features; "items" are points or
/// frames.
#include <benchmark/benchmark.h>

#include "bench/micro/dead_leaves_image.h"
#include "core/frontend/feature_tracker.h"
#include "core/frontend/klt/klt.h"

namespace stillpoint {
namespace {

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
    ->ArgName("rigid")
    ->Arg(static_cast<int>(OutlierModel::kEpipolar))
    ->Arg(static_cast<int>(OutlierModel::kRigid))
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace stillpoint
