// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare/time_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/metrics/ate.h"
#include "eval/metrics/strict_rpe.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMinOffsetMatches = 10;
constexpr double kGoldenSection = 0.6180339887498949;
constexpr std::size_t kSearchPoses = 2000;  // limits the run time; sufficient for a constant offset

Trajectory subsampled(const Trajectory& est) {
  const std::size_t step = est.poses.size() / kSearchPoses + 1;
  Trajectory result{.frame = est.frame, .poses = {}};
  for (std::size_t i = 0; i < est.poses.size(); i += step) result.poses.push_back(est.poses[i]);
  return result;
}

/// Infinite with too few matches, which rejects offsets that move the estimate beyond the ground truth.
double ate_at(const Trajectory& gt, const Trajectory& est, double offset_s, std::size_t min_matches) {
  const std::vector<MatchedPose> matches = strict_matches(gt, est, offset_s);
  if (matches.size() < min_matches) return std::numeric_limits<double>::infinity();
  return statistics(ate_errors(matches, align(matches, Alignment::kSe3).S_w_v).translation_m)->rmse;
}

}  // namespace

std::optional<TimeOffset> find_time_offset(const Trajectory& gt, const Trajectory& est,
                                           const TimeOffsetOptions& options) {
  const Trajectory sampled = subsampled(est);
  const std::size_t matches_at_zero = strict_matches(gt, sampled).size();
  if (matches_at_zero < kMinOffsetMatches) return std::nullopt;
  const std::size_t min_matches = std::max(kMinOffsetMatches, matches_at_zero / 2);
  const auto error = [&](double offset_s) { return ate_at(gt, sampled, offset_s, min_matches); };
  TimeOffset best{0.0, error(0.0), error(0.0)};
  const int steps = static_cast<int>(std::ceil(options.max_offset_s / options.coarse_step_s));
  for (int i = -steps; i <= steps; ++i) {
    const double offset_s = i * options.coarse_step_s;
    const double ate_rmse_m = error(offset_s);
    if (ate_rmse_m < best.ate_rmse_m) best = {offset_s, ate_rmse_m, best.ate_rmse_at_zero_m};
  }
  double low = best.offset_s - options.coarse_step_s;
  double high = best.offset_s + options.coarse_step_s;
  while (high - low > options.precision_s) {
    const double a = high - kGoldenSection * (high - low);
    const double b = low + kGoldenSection * (high - low);
    if (error(a) < error(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  const double refined_s = 0.5 * (low + high);
  const double refined = error(refined_s);
  if (refined < best.ate_rmse_m) best = {refined_s, refined, best.ate_rmse_at_zero_m};
  return best;
}

}  // namespace stillpoint::eval
