// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/rig_report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace stillpoint::bench {
namespace {

constexpr double kSignificant = 3.0;          // standard deviations
constexpr double kOffsetTolerance_s = 0.001;  // what a calibration leaves

/// A parameter with its estimated difference from the rig, in the unit of its name.
struct Estimate {
  std::string name;
  double difference = 0.0;
  double sigma = 0.0;
  double tolerance = 0.0;  ///< what a calibration leaves
  double observed = 0.0;   ///< largest standard deviation of an observed parameter
};

/// @param agrees whether the data agrees with the group of parameters that this one is of
RigFinding finding_of(const Estimate& estimate, bool agrees) {
  RigFinding finding{.parameter = estimate.name, .sigma = estimate.sigma};
  const double doubt = std::hypot(estimate.sigma, estimate.tolerance);
  if (!agrees && std::abs(estimate.difference) > kSignificant * doubt) {
    finding.result = RigResult::kDiffers;
    finding.difference = estimate.difference;
  } else if (estimate.sigma <= estimate.observed) {
    finding.result = RigResult::kAgrees;
  }
  return finding;
}

/// Corrections of bearings: a stated value is off by their negative.
void add_lens(const EstimatedCalibration& calibration, std::vector<RigFinding>& findings) {
  if (!calibration.lens_agrees || !calibration.lens_sigma || calibration.lens_sigma->isZero(0.0)) return;
  const Eigen::Vector4d difference = -calibration.lens, sigma = *calibration.lens_sigma;
  const double fx = calibration.rig.camera.fx, fy = calibration.rig.camera.fy;
  const Estimate estimates[] = {{"focal length [%]", 100.0 * difference[0], 100.0 * sigma[0], 0.2, 1.0},
                                {"k1", difference[1], sigma[1], 0.004, 0.025},
                                {"center x [px]", fx * difference[2], fx * sigma[2], 0.001 * fx, 0.005 * fx},
                                {"center y [px]", fy * difference[3], fy * sigma[3], 0.001 * fy, 0.005 * fy}};
  for (const Estimate& estimate : estimates)
    findings.push_back(finding_of(estimate, *calibration.lens_agrees));
}

}  // namespace

std::vector<RigFinding> rig_report(const EstimatedCalibration& calibration) {
  std::vector<RigFinding> findings;
  if (calibration.depth_scale_agrees && calibration.depth_scale_sigma) {
    const double sigma = 100.0 * *calibration.depth_scale_sigma;
    findings.push_back(
        finding_of({"depth scale [%]", 100.0 * (calibration.depth_scale - 1.0), sigma, 0.6, 5.0},
                   *calibration.depth_scale_agrees));
  }
  add_lens(calibration, findings);
  if (calibration.time_offset_sigma_s && *calibration.time_offset_sigma_s > 0.0) {
    const double difference = calibration.time_offset_s - calibration.rig.time_offset_s;
    findings.push_back(finding_of({"time offset [ms]", 1e3 * difference,
                                   1e3 * *calibration.time_offset_sigma_s, 1e3 * kOffsetTolerance_s, 5.0},
                                  false));
  }
  if (calibration.extrinsics_agree && calibration.extrinsics_sigma_rad) {
    const double to_deg = 180.0 / M_PI;
    const double angle = calibration.T_b_c.q.angularDistance(calibration.rig.T_b_c.q);
    findings.push_back(finding_of({"camera rotation on the body [deg]", to_deg * angle,
                                   to_deg * *calibration.extrinsics_sigma_rad, 0.2, 1.0},
                                  *calibration.extrinsics_agree));
  }
  return findings;
}

std::string_view result_name(RigResult result) {
  switch (result) {
    case RigResult::kAgrees:
      return "agrees";
    case RigResult::kDiffers:
      return "differs";
    case RigResult::kNotObserved:
      break;
  }
  return "not observed";
}

std::string rig_report_line(const std::vector<RigFinding>& findings) {
  std::vector<std::string> parts;
  for (const RigFinding& finding : findings) {
    std::string part = fmt::format("{}: {}", finding.parameter, result_name(finding.result));
    if (finding.result == RigResult::kDiffers) {
      part += fmt::format(" by {:+.3g} ({:.0f} sigma)", finding.difference,
                          std::abs(finding.difference) / finding.sigma);
    } else if (finding.result == RigResult::kAgrees) {
      part += fmt::format(" (to {:.2g})", finding.sigma);
    }
    parts.push_back(std::move(part));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace stillpoint::bench
