// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/loop_cost_plot.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reports/drawing/cost_trend.h"
#include "reports/drawing/style.h"

namespace stillpoint::report {
namespace {

constexpr double kLoopPlotHeight = 320.0;

double megabytes(const MapKeyframe& keyframe) {
  return 1e-6 * static_cast<double>(keyframe.cost.memory_bytes);
}

std::vector<FrameCost> times_of(std::span<const MapKeyframe> keyframes) {
  std::vector<FrameCost> times;
  for (const MapKeyframe& keyframe : keyframes)
    times.push_back({seconds_between(keyframes.front().t, keyframe.t), keyframe.cost.processing_ms});
  return times;
}

/// [MB] after the last keyframe up to `t_s` >= 0.
double memory_at(std::span<const MapKeyframe> keyframes, double t_s) {
  const Timestamp t = after(keyframes.front().t, t_s);
  return megabytes(*(std::ranges::upper_bound(keyframes, t, {}, &MapKeyframe::t) - 1));
}

std::vector<Mark> texts(std::span<const MapKeyframe> keyframes, double highest_ms, double window_s) {
  const auto longest = std::ranges::max_element(
      keyframes, {}, [](const MapKeyframe& keyframe) { return keyframe.cost.processing_ms; });
  const double added_kb = 1e3 * (megabytes(keyframes.back()) - megabytes(keyframes.front()));
  const auto text = [](double y, std::string content, Color color) {
    return Label{{kPlotMargin, y}, std::move(content), 16.0, Anchor::kLeft, color};
  };
  return {text(28.0,
               fmt::format("loop closure per keyframe, medians of {:g} s: 0 to {:.1f} ms; longest {:.0f} ms",
                           window_s, highest_ms, longest->cost.processing_ms),
               kBlue),
          text(50.0,
               fmt::format("its memory: 0 to {:.1f} MB; {:.1f} kB per keyframe", megabytes(keyframes.back()),
                           added_kb / static_cast<double>(keyframes.size() - 1)),
               kRed),
          text(kLoopPlotHeight - kPlotMargin + 24.0,
               fmt::format("{} keyframes over {:.0f} s", keyframes.size(),
                           seconds_between(keyframes.front().t, keyframes.back().t)),
               kBlack)};
}

}  // namespace

Drawing loop_cost_plot(std::span<const MapKeyframe> keyframes, double window_s) {
  const std::vector<FrameCost> medians = cost_trend(times_of(keyframes), window_s).medians;
  const double bottom = kLoopPlotHeight - kPlotMargin;
  const double end_s = medians.back().t_s;
  const double highest_ms = std::ranges::max(medians, {}, &FrameCost::ms).ms;
  const double highest_mb = megabytes(keyframes.back());
  const auto place = [&](double t_s, double value, double highest) {
    return Point2{kPlotMargin + (kPlotWidth - 2.0 * kPlotMargin) * t_s / end_s,
                  bottom - (bottom - kPlotMargin) * value / std::max(highest, 1e-6)};
  };
  Drawing drawing{kPlotWidth, kLoopPlotHeight, texts(keyframes, highest_ms, window_s)};
  drawing.marks.push_back(Polyline{{place(0.0, 0.0, 1.0), place(end_s, 0.0, 1.0)}, kGray, 1.5});
  Polyline memory{{}, kRed, 2.0};
  for (const FrameCost& one : medians) {
    drawing.marks.push_back(Disc{place(one.t_s, one.ms, highest_ms), 3.0, kBlue});
    memory.points.push_back(place(one.t_s, memory_at(keyframes, one.t_s), highest_mb));
  }
  drawing.marks.push_back(std::move(memory));
  return drawing;
}

}  // namespace stillpoint::report
