// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/rig_report.h"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/types/rig_tolerance.h"

namespace stillpoint::bench {
namespace {

constexpr double kSignificant = 3.0;  // standard deviations
constexpr double kLike = 2.0;         // same: of a value that agrees

/// A parameter with its estimated difference from the rig, in the unit of its name.
struct Estimate {
  std::string name;
  double difference = 0.0;
  double sigma = 0.0;
  double deviations = 0.0;  ///< of the difference, in those of the estimate and of what a calibration leaves
  double observed = 0.0;    ///< largest standard deviation of an observed parameter
};

/// Difference in standard deviations of the estimate and of what a calibration leaves.
double deviations(double difference, double sigma, double tolerance) {
  return std::abs(difference) / std::hypot(sigma, tolerance);
}

/// @param agrees whether the data agrees with the group of parameters that this one is of
RigFinding finding_of(const Estimate& estimate, bool agrees) {
  RigFinding finding{.parameter = estimate.name, .sigma = estimate.sigma};
  if (!agrees && estimate.deviations > kSignificant) {
    finding.result = RigResult::kDiffers;
    finding.difference = estimate.difference;
  } else if (estimate.sigma <= estimate.observed && estimate.deviations <= kLike) {
    finding.result = RigResult::kAgrees;
  }
  return finding;
}

/// Corrections of bearings: a stated value is off by their negative.
void add_lens(const EstimatedCalibration& calibration, std::vector<RigFinding>& findings) {
  if (!calibration.lens_agrees || !calibration.lens_sigma || calibration.lens_sigma->isZero(0.0)) return;
  const bool agrees = *calibration.lens_agrees;
  const Eigen::Vector4d difference = -(calibration.lens + calibration.rig_step.lens);
  const Camera& camera = calibration.rig.camera;
  const auto add = [&](std::string name, int i, double unit, double observed) {
    const double sigma = (*calibration.lens_sigma)[i];
    const double tolerance = rig_tolerance::kLens[static_cast<std::size_t>(i)];
    findings.push_back(finding_of({std::move(name), unit * difference[i], unit * sigma,
                                   deviations(difference[i], sigma, tolerance), unit * observed},
                                  agrees));
  };
  add("focal length [%]", 0, 100.0, 0.01);
  add("k1", 1, 1.0, 0.025);
  add("center x [px]", 2, camera.fx, 0.005);
  add("center y [px]", 3, camera.fy, 0.005);
}

void add_depth_scale(const EstimatedCalibration& calibration, std::vector<RigFinding>& findings) {
  if (!calibration.depth_scale_agrees || !calibration.depth_scale_sigma) return;
  const bool agrees = *calibration.depth_scale_agrees;
  const double difference = calibration.depth_scale - 1.0 - calibration.rig_step.depth_scale;
  const double sigma = *calibration.depth_scale_sigma;
  findings.push_back(finding_of({"depth scale [%]", 100.0 * difference, 100.0 * sigma,
                                 deviations(difference, sigma, rig_tolerance::kDepthScale), 5.0},
                                agrees));
}

void add_time_offset(const EstimatedCalibration& calibration, std::vector<RigFinding>& findings) {
  if (!calibration.time_offset_sigma_s || *calibration.time_offset_sigma_s <= 0.0) return;
  const double difference_s = calibration.time_offset_s - calibration.rig.time_offset_s;
  const double sigma_s = *calibration.time_offset_sigma_s;
  findings.push_back(finding_of({"time offset [ms]", 1e3 * difference_s, 1e3 * sigma_s,
                                 deviations(difference_s, sigma_s, rig_tolerance::kTimeOffset_s), 5.0},
                                false));
}

/// By the extrinsics if they are estimated, else by the alignment at the start, which contradicts the rig
/// also where it is not certain about all axes.
void add_rotation(const EstimatedCalibration& calibration, std::vector<RigFinding>& findings) {
  const auto add = [&](double angle, double sigma, double by_sigma, bool agrees) {
    constexpr double kDegrees = 180.0 / M_PI;
    findings.push_back(finding_of(
        {"camera rotation on the body [deg]", kDegrees * angle, kDegrees * sigma, by_sigma, 0.5}, agrees));
  };
  const std::optional<AlignedRotation>& aligned = calibration.aligned_rotation;
  if (calibration.extrinsics_sigma_rad && *calibration.extrinsics_sigma_rad > 0.0) {
    const double angle = calibration.T_b_c.q.angularDistance(calibration.rig.T_b_c.q);
    const double sigma = *calibration.extrinsics_sigma_rad;
    add(angle, sigma, deviations(angle / std::sqrt(3.0), sigma, rig_tolerance::kRotation_rad),
        calibration.extrinsics_agree.value_or(!aligned || aligned->deviations <= kSignificant));
  } else if (aligned) {
    add(aligned->difference_rad, aligned->sigma_rad, aligned->deviations, false);
  }
}

}  // namespace

std::vector<RigFinding> rig_report(const EstimatedCalibration& calibration) {
  std::vector<RigFinding> findings;
  add_depth_scale(calibration, findings);
  add_lens(calibration, findings);
  add_time_offset(calibration, findings);
  add_rotation(calibration, findings);
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
