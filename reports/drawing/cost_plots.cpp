// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/cost_plots.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "reports/drawing/theme.h"

namespace stillpoint::report {
namespace {

constexpr double kNormal975 = 1.959964;     // 97.5 % quantile of the normal distribution
constexpr std::size_t kMinForInterval = 5;  // below, the expansion of `student_quantile` is inaccurate
constexpr double kSecondsPerMinute = 60.0;
constexpr double kHeight = 320.0;

/// 97.5 % quantile of Student's t: Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 26.7.5.
/// The error is 0.1 % for 3 degrees of freedom, and smaller for more.
double student_quantile(double degrees) {
  const double z = kNormal975;
  const auto power = [&](int exponent) { return std::pow(z, exponent); };
  const double terms[] = {
      (power(3) + z) / 4.0, (5.0 * power(5) + 16.0 * power(3) + 3.0 * z) / 96.0,
      (3.0 * power(7) + 19.0 * power(5) + 17.0 * power(3) - 15.0 * z) / 384.0,
      (79.0 * power(9) + 776.0 * power(7) + 1482.0 * power(5) - 1920.0 * power(3) - 945.0 * z) / 92160.0};
  double quantile = z;
  double scale = 1.0;
  for (const double term : terms) quantile += term * (scale /= degrees);
  return quantile;
}

std::string interval_line(const std::optional<eval::Interval>& interval) {
  return interval ? fmt::format("95 %: {:+.4f} to {:+.4f}", interval->low, interval->high) : "no interval";
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<FrameCost> window_medians(std::span<const FrameCost> costs, double window_s) {
  std::vector<FrameCost> medians;
  for (std::size_t i = 0; i < costs.size();) {
    const double number = std::floor(costs[i].t_s / window_s);
    std::vector<double> values;
    for (; i < costs.size() && std::floor(costs[i].t_s / window_s) == number; ++i) {
      values.push_back(costs[i].ms);
    }
    medians.push_back({(number + 0.5) * window_s, median_of(std::move(values))});
  }
  return medians;
}

Label label(double x, double y, const std::string& text, Anchor anchor) {
  return {{x, y}, text, 16.0, anchor, theme::kBlack};
}

}  // namespace

std::vector<FrameCost> frame_costs(const bench::OdometryRun& run) {
  std::vector<FrameCost> costs;
  for (std::size_t i = 0; i < run.frame_timings.size(); ++i) {
    const ModuleTimings& timings = run.frame_timings[i];
    const std::int64_t ns = timings[Module::kTrackingThread].ns + timings[Module::kOptimizationThread].ns;
    const Timestamp first{run.frame_counters.front().t_ns};
    costs.push_back({seconds_between(first, {run.frame_counters[i].t_ns}), 1e-6 * static_cast<double>(ns)});
  }
  return costs;
}

CostTrend cost_trend(std::span<const FrameCost> costs, double window_s) {
  CostTrend trend{.medians = window_medians(costs, window_s)};
  const auto count = static_cast<double>(trend.medians.size());
  if (count < 3.0) {
    throw InputError("--dump cost",
                     fmt::format("needs a run of {:g} s or more; add --passes", 3.0 * window_s));
  }
  FrameCost mean;
  for (const FrameCost& one : trend.medians) mean = {mean.t_s + one.t_s / count, mean.ms + one.ms / count};
  double s_tt = 0.0;
  double s_ty = 0.0;
  for (const FrameCost& one : trend.medians) {
    s_tt += (one.t_s - mean.t_s) * (one.t_s - mean.t_s);
    s_ty += (one.t_s - mean.t_s) * (one.ms - mean.ms);
  }
  const double slope = s_ty / s_tt;
  trend.start_ms = mean.ms - slope * mean.t_s;
  double squared_residuals = 0.0;
  for (const FrameCost& one : trend.medians) {
    squared_residuals += std::pow(one.ms - trend.start_ms - slope * one.t_s, 2);
  }
  trend.slope_ms_per_min = kSecondsPerMinute * slope;
  if (trend.medians.size() < kMinForInterval) return trend;
  const double half_width =
      student_quantile(count - 2.0) * std::sqrt(squared_residuals / (count - 2.0) / s_tt);
  trend.slope_interval = {kSecondsPerMinute * (slope - half_width), kSecondsPerMinute * (slope + half_width)};
  return trend;
}

Drawing cost_plot(const CostTrend& trend) {
  Drawing drawing{theme::kPlotWidth, kHeight, {}};
  const double bottom = kHeight - theme::kPlotMargin;
  const double end_s = trend.medians.back().t_s;
  double highest_ms = 0.0;
  for (const FrameCost& one : trend.medians) highest_ms = std::max(highest_ms, one.ms);
  const auto place = [&](double t_s, double ms) {
    return Point2{theme::kPlotMargin + (theme::kPlotWidth - 2.0 * theme::kPlotMargin) * t_s / end_s,
                  bottom - (bottom - theme::kPlotMargin) * ms / std::max(highest_ms, 1e-6)};
  };
  drawing.marks.push_back(Polyline{{place(0.0, 0.0), place(end_s, 0.0)}, theme::kGray, 1.5});
  for (const FrameCost& one : trend.medians) {
    drawing.marks.push_back(Disc{place(one.t_s, one.ms), 3.0, theme::kBlue});
  }
  const double end_ms = trend.start_ms + trend.slope_ms_per_min * end_s / kSecondsPerMinute;
  drawing.marks.push_back(Polyline{{place(0.0, trend.start_ms), place(end_s, end_ms)}, theme::kRed, 2.0});
  drawing.marks.push_back(label(
      theme::kPlotMargin, bottom + 24.0,
      fmt::format("tracking and optimization time per frame over {:.0f} s, medians of 10 s, 0 to {:.2f} ms",
                  end_s, highest_ms),
      Anchor::kLeft));
  drawing.marks.push_back(label(theme::kPlotMargin, 30.0,
                                fmt::format("slope {:+.4f} ms per minute, n = {}, {}", trend.slope_ms_per_min,
                                            trend.medians.size(), interval_line(trend.slope_interval)),
                                Anchor::kLeft));
  return drawing;
}

namespace {

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
    return Label{{theme::kPlotMargin, y}, std::move(content), 16.0, Anchor::kLeft, color};
  };
  return {text(28.0,
               fmt::format("loop closure per keyframe, medians of {:g} s: 0 to {:.1f} ms; longest {:.0f} ms",
                           window_s, highest_ms, longest->cost.processing_ms),
               theme::kBlue),
          text(50.0,
               fmt::format("its memory: 0 to {:.1f} MB; {:.1f} kB per keyframe", megabytes(keyframes.back()),
                           added_kb / static_cast<double>(keyframes.size() - 1)),
               theme::kRed),
          text(kHeight - theme::kPlotMargin + 24.0,
               fmt::format("{} keyframes over {:.0f} s", keyframes.size(),
                           seconds_between(keyframes.front().t, keyframes.back().t)),
               theme::kBlack)};
}

}  // namespace

Drawing loop_cost_plot(std::span<const MapKeyframe> keyframes, double window_s) {
  const std::vector<FrameCost> medians = cost_trend(times_of(keyframes), window_s).medians;
  const double bottom = kHeight - theme::kPlotMargin;
  const double end_s = medians.back().t_s;
  const double highest_ms = std::ranges::max(medians, {}, &FrameCost::ms).ms;
  const double highest_mb = megabytes(keyframes.back());
  const auto place = [&](double t_s, double value, double highest) {
    return Point2{theme::kPlotMargin + (theme::kPlotWidth - 2.0 * theme::kPlotMargin) * t_s / end_s,
                  bottom - (bottom - theme::kPlotMargin) * value / std::max(highest, 1e-6)};
  };
  Drawing drawing{theme::kPlotWidth, kHeight, texts(keyframes, highest_ms, window_s)};
  drawing.marks.push_back(Polyline{{place(0.0, 0.0, 1.0), place(end_s, 0.0, 1.0)}, theme::kGray, 1.5});
  Polyline memory{{}, theme::kRed, 2.0};
  for (const FrameCost& one : medians) {
    drawing.marks.push_back(Disc{place(one.t_s, one.ms, highest_ms), 3.0, theme::kBlue});
    memory.points.push_back(place(one.t_s, memory_at(keyframes, one.t_s), highest_mb));
  }
  drawing.marks.push_back(std::move(memory));
  return drawing;
}

}  // namespace stillpoint::report
