// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/rig_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {
namespace {

using enum FaultKind;

Eigen::Vector3d random_unit_vector(synth::RandomSequence random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

}  // namespace

Rig rig_with_fault(Rig rig, const SensorFault& fault) {
  const Eigen::Vector3d direction = random_unit_vector(fault.random());
  switch (fault.kind) {
    case kFocalError:
      rig.camera.fx *= 1.0 + fault.amount / 100.0;
      rig.camera.fy *= 1.0 + fault.amount / 100.0;
      break;
    case kCenterError: {
      const Eigen::Vector2d shift_px = fault.amount * direction.head<2>().normalized();
      rig.camera.cx += shift_px.x();
      rig.camera.cy += shift_px.y();
      break;
    }
    case kDistortionError:
      rig.camera.distortion[0] -= fault.amount;
      break;
    case kRotationError: {
      const double angle = fault.amount * std::numbers::pi / 180.0;
      rig.T_b_c.q = (rig.T_b_c.q * exp_so3(angle * direction)).normalized();
      break;
    }
    case kLeverError:
      rig.T_b_c.p += fault.amount * direction;
      break;
    default:
      STILLPOINT_CHECK(false);
  }
  return rig;
}

namespace {

double rounded_to_four_digits(double value) {
  if (value == 0.0) return 0.0;
  const double per_unit = std::pow(10.0, 3.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * per_unit) / per_unit;
}

/// Imperfections with amounts drawn one after the other.
class RigDraw {
 public:
  explicit RigDraw(const SensorFault& rig) : rig_(rig), random_(rig.random()) {}

  double normal(double sigma) { return rig_.amount * sigma * random_.normal(); }
  double uniform(double low, double high) { return rig_.amount * random_.uniform(low, high); }
  bool chance(double probability) { return random_.chance(probability); }

  /// Appends an imperfection with a seed of its own.
  void add(FaultKind kind, double amount) {
    const FaultDescriptor& descriptor = descriptor_of(kind);
    constexpr std::uint64_t kMaxRigKinds = 100;
    faults_.push_back({.kind = kind,
                       .start_s = 0.0,
                       .duration_s = kWholeSequence_s,
                       .amount = std::clamp(rounded_to_four_digits(amount), descriptor.min, descriptor.max),
                       .seed = (rig_.seed * kMaxRigKinds + faults_.size()) % kSeeds});
  }

  [[nodiscard]] std::vector<SensorFault> take() && { return std::move(faults_); }

 private:
  static constexpr std::uint64_t kSeeds = 1'000'000'000;
  SensorFault rig_;
  synth::RandomSequence random_;
  std::vector<SensorFault> faults_;
};

void add_calibration(RigDraw& draw) {
  draw.add(kFocalError, draw.normal(1.0));
  draw.add(kCenterError, std::abs(draw.normal(3.0)));
  draw.add(kDistortionError, draw.normal(0.02));
  draw.add(kRotationError, std::abs(draw.normal(1.0)));
  draw.add(kLeverError, std::abs(draw.normal(0.01)));
}

void add_depth(RigDraw& draw) {
  constexpr double kShortDepthChance = 0.1;
  const bool is_short = draw.chance(kShortDepthChance);
  draw.add(kDepthScaled, 1.0 + (is_short ? -draw.uniform(0.05, 0.1) : draw.normal(0.02)));
  draw.add(kDepthBias, draw.normal(0.003));
  draw.add(kDepthNoise, draw.uniform(0.001, 0.004));
  draw.add(kDepthShift, std::abs(draw.normal(2.0)));
}

void add_images(RigDraw& draw) {
  draw.add(kExposureSteps, draw.uniform(0.1, 0.5));
  draw.add(kVignetting, draw.uniform(0.1, 0.4));
  draw.add(kExposureBlur, draw.uniform(0.005, 0.015));
  draw.add(kJpeg, 100.0 - draw.uniform(5.0, 25.0));
  draw.add(kDropped, draw.uniform(0.0, 0.05));
}

void add_imu(RigDraw& draw) {
  draw.add(kTimeOffset, draw.normal(0.005));
  draw.add(kClockDrift, draw.normal(20.0));
  draw.add(kImuNoise, 1.0 + draw.uniform(1.0, 3.0));
  draw.add(kGyroScale, draw.uniform(0.2, 0.8));
  draw.add(kAccelScale, draw.uniform(0.5, 1.0));
  draw.add(kImuMisalignment, draw.uniform(0.1, 0.5));
  draw.add(kGSensitivity, draw.uniform(0.0, 0.1));
  draw.add(kImuVibration, draw.uniform(0.0, 0.3));
}

}  // namespace

std::vector<SensorFault> expanded_rigs(const std::vector<SensorFault>& faults) {
  std::vector<SensorFault> expanded;
  for (const SensorFault& fault : faults) {
    if (fault.kind != kRig) {
      expanded.push_back(fault);
      continue;
    }
    RigDraw draw(fault);
    add_calibration(draw);
    add_depth(draw);
    add_images(draw);
    add_imu(draw);
    for (const SensorFault& single : std::move(draw).take()) expanded.push_back(single);
  }
  return expanded;
}

}  // namespace stillpoint::datasets
