// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/time_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::eval {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMinOffsetMatches = 10;
constexpr std::size_t kSearchPoses = 2000;  // limits the run time; sufficient for a constant offset
constexpr std::size_t kGridPoints = 3000;
constexpr double kMinGridStep = 0.05;    // [s]
constexpr double kMinCommonRatio = 0.4;  // of the shorter signal
constexpr double kMinCorrelation = 0.5;  // correlation of different motions stays below
constexpr double kCoarseSteps = 4.0;     // of a coarse grid
constexpr double kMinCoarseCorrelation = 0.7;
constexpr std::size_t kCandidates = 4;
constexpr double kSearchStep = 0.02;  // [s]
constexpr double kPrecision = 1e-5;   // [s]
constexpr double kGoldenSection = 0.6180339887498949;
constexpr double kFlatRatio = 1.05;       // of the ATE beside the minimum
constexpr double kFlatDistance = 0.25;    // [s]
constexpr double kAmbiguousRatio = 1.15;  // of the ATE of another candidate

Trajectory every(const Trajectory& path, std::size_t step) {
  Trajectory result{.frame = path.frame, .poses = {}};
  for (std::size_t i = 0; i < path.poses.size(); i += step) result.poses.push_back(path.poses[i]);
  return result;
}

double path_seconds(const Trajectory& path) {
  return seconds_between(path.poses.front().t, path.poses.back().t);
}

/// Speed [m/s] and rotation rate [rad/s] between grid points; NaN in gaps.
using Signals = std::array<std::vector<double>, 2>;

Signals signals_of(const Trajectory& path, double step_s) {
  const auto count = static_cast<std::size_t>(path_seconds(path) / step_s);
  Signals signals;
  for (std::vector<double>& signal : signals) signal.assign(count, std::numeric_limits<double>::quiet_NaN());
  Trajectory grid;
  for (std::size_t k = 0; k <= count; ++k)
    grid.poses.push_back({after(path.poses.front().t, step_s * static_cast<double>(k)), {}});
  const std::vector<InterpolatedPair> pairs = associate_interpolated(path, grid, std::max(0.5, 3.0 * step_s));
  const std::vector<MatchedPose> matches = matched_poses(path, grid, pairs);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (pairs[i].est != pairs[i - 1].est + 1) continue;
    const Pose motion = matches[i - 1].gt.inverse() * matches[i].gt;
    signals[0][pairs[i - 1].est] = motion.p.norm() / step_s;
    signals[1][pairs[i - 1].est] = rotation_angle(motion.q) / step_s;
  }
  return signals;
}

/// r(lag) as defined in the header; nullopt with too few common points, or without variation.
std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b, long lag) {
  constexpr double kMinVariation = 1e-3;  // [m/s or rad/s], standard deviation
  const long begin = std::max(0L, lag);
  const long end = std::min(static_cast<long>(a.size()), static_cast<long>(b.size()) + lag);
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (long k = begin; k < end; ++k) {
    const double x = a[static_cast<std::size_t>(k)];
    const double y = b[static_cast<std::size_t>(k - lag)];
    if (std::isnan(x) || std::isnan(y)) continue;
    n += 1.0;
    sum_a += x;
    sum_b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  if (n < std::max(10.0, kMinCommonRatio * static_cast<double>(std::min(a.size(), b.size()))))
    return std::nullopt;
  const double variance_a = aa / n - sum_a * sum_a / (n * n);
  const double variance_b = bb / n - sum_b * sum_b / (n * n);
  if (std::min(variance_a, variance_b) < kMinVariation * kMinVariation) return std::nullopt;
  return (ab / n - sum_a * sum_b / (n * n)) / std::sqrt(variance_a * variance_b);
}

std::optional<double> lag_score(const Signals& gt, const Signals& est, long lag) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < gt.size(); ++i) {
    const std::optional<double> r = correlation(gt[i], est[i], lag);
    if (!r) continue;
    sum += *r;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

/// Lags with the largest scores that are local maxima, best first, as offsets of the estimate [s].
std::vector<double> candidates(const Trajectory& gt, const Trajectory& est, double step_s,
                               double min_correlation) {
  const Signals of_gt = signals_of(gt, step_s);
  const Signals of_est = signals_of(est, step_s);
  const long first = -static_cast<long>(of_est[0].size());
  std::vector<double> scores;
  for (long lag = first; lag <= static_cast<long>(of_gt[0].size()); ++lag)
    scores.push_back(lag_score(of_gt, of_est, lag).value_or(-1.0));
  const double at_equal_starts = seconds_between(est.poses.front().t, gt.poses.front().t);
  std::vector<std::pair<double, double>> peaks;  // score, offset
  for (std::size_t i = 1; i + 1 < scores.size(); ++i) {
    if (scores[i] < min_correlation || scores[i] < scores[i - 1] || scores[i] <= scores[i + 1]) continue;
    peaks.emplace_back(scores[i],
                       at_equal_starts + step_s * static_cast<double>(first + static_cast<long>(i)));
  }
  std::sort(peaks.rbegin(), peaks.rend());
  std::vector<double> offsets;
  for (std::size_t i = 0; i < std::min(kCandidates, peaks.size()); ++i) offsets.push_back(peaks[i].second);
  return offsets;
}

/// ATE as a function of the offset.
class OffsetError {
 public:
  OffsetError(const Trajectory& gt, const Trajectory& est)
      : gt_(gt), est_(est), max_gap_s_(std::max(0.11, 1.1 * median_pose_interval_s(gt))) {}

  /// Infinite with fewer than the required matches, which rejects offsets that move the estimate beyond the
  /// ground truth.
  [[nodiscard]] double at(double offset_s, Alignment kind = Alignment::kSim3) const {
    const PoseMatches matches = matches_at(offset_s);
    if (matches.size() < min_matches_) return kInfinity;
    return position_rmse(matches, align(matches, kind).S_w_v);
  }

  /// From now on, half of the largest number of matches at these offsets is required.
  void require_matches(const std::vector<double>& offsets) {
    for (const double offset_s : offsets)
      min_matches_ = std::max(min_matches_, matches_at(offset_s).size() / 2);
  }

 private:
  [[nodiscard]] PoseMatches matches_at(double offset_s) const {
    return {gt_, est_, associate_interpolated(gt_, est_, max_gap_s_, offset_s)};
  }

  const Trajectory& gt_;
  const Trajectory& est_;
  double max_gap_s_;
  std::size_t min_matches_ = kMinOffsetMatches;
};

struct Minimum {
  double offset_s = 0.0;
  double error_m = kInfinity;
  bool at_border = false;
};

/// The minimum within `radius_s` of an offset.
Minimum minimum_near(const OffsetError& error, double center_s, double radius_s) {
  const int steps = static_cast<int>(std::ceil(radius_s / kSearchStep));
  int best = 0;
  Minimum minimum;
  for (int i = -steps; i <= steps; ++i) {
    const double error_m = error.at(center_s + i * kSearchStep);
    if (error_m < minimum.error_m) {
      minimum = {center_s + i * kSearchStep, error_m};
      best = i;
    }
  }
  minimum.at_border = std::abs(best) == steps;
  double low = minimum.offset_s - kSearchStep;
  double high = minimum.offset_s + kSearchStep;
  while (high - low > kPrecision) {
    const double a = high - kGoldenSection * (high - low);
    const double b = low + kGoldenSection * (high - low);
    if (error.at(a) < error.at(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  const double refined_s = 0.5 * (low + high);
  if (const double refined_m = error.at(refined_s); refined_m < minimum.error_m)
    minimum = {refined_s, refined_m, minimum.at_border};
  return minimum;
}

/// Why the best minimum is no offset; empty if it is one.
std::string doubt(const OffsetError& error, const Minimum& best, const std::vector<Minimum>& all) {
  char text[200];
  if (best.at_border) return "the error has no minimum near the offset at which the motion agrees best";
  const double beside_m =
      std::min(error.at(best.offset_s - kFlatDistance), error.at(best.offset_s + kFlatDistance));
  if (beside_m < kFlatRatio * best.error_m + 1e-9) {
    std::snprintf(text, sizeof text,
                  "the error hardly depends on it: ATE %.6f m at %+.5f s, %.6f m %.2f s beside", best.error_m,
                  best.offset_s, beside_m, kFlatDistance);
    return text;
  }
  for (const Minimum& other : all) {
    if (std::abs(other.offset_s - best.offset_s) < kFlatDistance) continue;
    if (other.error_m > kAmbiguousRatio * best.error_m + 1e-6) continue;
    std::snprintf(text, sizeof text, "%+.5f s and %+.5f s are equally good: ATE %.6f and %.6f m",
                  best.offset_s, other.offset_s, best.error_m, other.error_m);
    return text;
  }
  return "";
}

}  // namespace

std::optional<TimeOffset> find_time_offset(const Trajectory& gt, const Trajectory& est) {
  if (std::min(gt.poses.size(), est.poses.size()) < kMinOffsetMatches) return std::nullopt;
  const double interval_s = std::max(median_pose_interval_s(gt), median_pose_interval_s(est));
  const double longest_s = std::max(path_seconds(gt), path_seconds(est));
  double step_s = std::max({kMinGridStep, interval_s, longest_s / static_cast<double>(kGridPoints)});
  const Trajectory sampled = every(est, est.poses.size() / kSearchPoses + 1);
  OffsetError error(gt, sampled);
  TimeOffset result{.ate_rmse_at_zero_m = error.at(0.0, Alignment::kSe3)};
  result.ate_rmse_m = result.ate_rmse_at_zero_m;
  std::vector<double> offsets = candidates(gt, est, step_s, kMinCorrelation);
  if (offsets.empty()) {
    step_s *= kCoarseSteps;
    offsets = candidates(gt, est, step_s, kMinCoarseCorrelation);
  }
  if (offsets.empty()) {
    result.undetermined = "the speeds and rotation rates of both files agree at no offset";
    return result;
  }
  error.require_matches(offsets);
  std::vector<Minimum> minima;
  minima.reserve(offsets.size());
  for (const double offset_s : offsets)
    minima.push_back(minimum_near(error, offset_s, std::max(0.2, 1.5 * step_s)));
  const Minimum best = *std::min_element(
      minima.begin(), minima.end(), [](const Minimum& a, const Minimum& b) { return a.error_m < b.error_m; });
  if (best.error_m == kInfinity) {
    result.undetermined = "too few poses have a ground-truth pose close enough in time";
    return result;
  }
  result.offset_s = best.offset_s;
  result.ate_rmse_m = error.at(best.offset_s, Alignment::kSe3);
  result.undetermined = doubt(error, best, minima);
  return result;
}

}  // namespace stillpoint::eval
