// SPDX-License-Identifier: BSD-3-Clause
/// Cost of KLT at 848x480, and of the whole tracking thread with 130 features; "items" are points or
/// pictures.
#include <benchmark/benchmark.h>

#include "bench/micro/leaves_picture.h"
#include "core/frontend/feature_tracker.h"
#include "core/frontend/klt.h"

namespace stillpoint {
namespace {

constexpr int kWindowPx = 21;
constexpr int kShiftPx = 4;

void build_pyramid(benchmark::State& state) {
  const cv::Mat gray = leaves_picture();
  ImagePyramid pyramid;
  for (auto _ : state) pyramid.rebuild(gray, kWindowPx, static_cast<int>(state.range(0)));
}
BENCHMARK(build_pyramid)->ArgName("levels")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

/// 13 x 10 points, spread evenly.
std::vector<cv::Point2f> spread_points() {
  std::vector<cv::Point2f> points;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 13; ++x) {
      points.emplace_back(static_cast<float>(40 + 62 * x), static_cast<float>(30 + 46 * y));
    }
  }
  return points;
}

/// @param state ranges: pyramid levels, error of the prediction [px], window [px]
void follow_130_points(benchmark::State& state) {
  const int window_px = static_cast<int>(state.range(2));
  const KltSettings settings{.window_px = window_px, .levels = static_cast<int>(state.range(0))};
  ImagePyramid from;
  ImagePyramid to;
  from.rebuild(leaves_picture(0), window_px, settings.levels);
  to.rebuild(leaves_picture(kShiftPx), window_px, settings.levels);
  const std::vector<cv::Point2f> points = spread_points();
  std::vector<cv::Point2f> guesses = points;
  for (cv::Point2f& guess : guesses) guess.x += static_cast<float>(state.range(1)) - kShiftPx;
  for (auto _ : state) benchmark::DoNotOptimize(follow_points(from, to, points, guesses, settings));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(follow_130_points)
    ->ArgNames({"levels", "off_px", "window_px"})
    ->Args({1, 1, 21})
    ->Args({2, 1, 21})
    ->Args({2, 1, 15})
    ->Args({4, 4, 21})
    ->Unit(benchmark::kMicrosecond);

/// @param state range: model of outlier rejection
void track_picture(benchmark::State& state) {
  const std::vector<cv::Mat> pictures = {leaves_picture(0), leaves_picture(2), leaves_picture(4),
                                         leaves_picture(2)};
  const Camera camera{.width = kPictureSize.width,
                      .height = kPictureSize.height,
                      .fx = 611.0,
                      .fy = 611.0,
                      .cx = 433.0,
                      .cy = 249.0};
  FrontendConfig config;
  config.outlier_model = static_cast<OutlierModel>(state.range(0));
  FeatureTracker tracker(config, camera);
  Frame frame;
  frame.depth = cv::Mat(kPictureSize, CV_16UC1, cv::Scalar(2000));
  const MotionPrior at_rest{.T_ccur_cprev = {}, .has_rotation = true};
  for (auto _ : state) {
    frame.gray = pictures[static_cast<std::size_t>(frame.id) % pictures.size()];
    frame.t = Timestamp{frame.id * 33'333'333};
    benchmark::DoNotOptimize(tracker.track(frame, at_rest, true));
    ++frame.id;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(track_picture)
    ->ArgName("rigid")
    ->Arg(static_cast<int>(OutlierModel::kEpipolar))
    ->Arg(static_cast<int>(OutlierModel::kRigid))
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace stillpoint
