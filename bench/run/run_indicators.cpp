// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_indicators.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/model/run_notes.h"
#include "bench/run/rig_report.h"

namespace stillpoint::bench {
namespace {

constexpr double kMostNoiseFactor = 5.0;
constexpr double kMostLost = 0.1;
constexpr double kStartup_s = 1.0;

/// Fraction of the frames after the first second without a pose.
double fraction_lost(const OdometryRun& run) {
  double frames = 0.0, lost = 0.0;
  for (const eval::ClaimedPose& claim : run.claims) {
    if (seconds_between(run.claims.front().t, claim.t) < kStartup_s) continue;
    frames += 1.0;
    lost += claim.claim == eval::PoseClaim::kLocated ? 0.0 : 1.0;
  }
  return frames > 0.0 ? lost / frames : 0.0;
}

}  // namespace

std::vector<std::string> run_indicators(const RunResult& result) {
  const RunCounts counts = measurements_of(result).counts.value_or(RunCounts{});
  std::vector<std::string> off = innovation_doubts(counts.nis_reprojection, counts.nis_inertial);
  const ImuNoiseFactors& factors = result.run.imu_noise;
  if (std::max(factors.gyro, factors.accel) > kMostNoiseFactor)
    off.push_back(
        fmt::format("errors of gyroscope and accelerometer {:.1f} and {:.1f} times the stated noise",
                    factors.gyro, factors.accel));
  for (const RigFinding& finding : rig_report(result.run.calibration)) {
    if (finding.result == RigResult::kDiffers) off.push_back(finding.parameter + " differs");
  }
  if (const double lost = fraction_lost(result.run); lost > kMostLost)
    off.push_back(fmt::format("{:.0f} % of the frames after the first second have no pose", 100.0 * lost));
  return off;
}

}  // namespace stillpoint::bench
