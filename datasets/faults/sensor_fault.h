// SPDX-License-Identifier: BSD-3-Clause
/// Sensor faults and imperfections that can be injected into a sequence: what, when, and how strong.
///
/// Faults begin during a sequence. Imperfections are what sensors have that their calibration does not state;
/// they last for the whole sequence. Origins of their default amounts:
///
///   focal_error, center_error   OpenNI states 525 px and the image center for every Kinect; calibrated: 517,
///                               521 and 535-539 px, centers 8-16 px lower (Sturm et al. 2012, fr1 to fr3)
///   distortion_error            lenses of the D400 and of webcams, whose images are used as if rectified
///   rotation_error, lever_error mounting tolerance: values from a drawing instead of a calibration (Furgale
///                               et al. 2013)
///   depth_bias, depth_noise     disparity error of 0.1 px at f b = 30 px m (Keselman et al. 2017); Kinect:
///                               0.0014/m (Khoshelham and Elberink 2012)
///   depth_shift                 registration of Kinect images by factory values (Herrera et al. 2012)
///   exposure_steps, vignetting  automatic exposure; fall-off of lenses (Engel et al. 2016)
///   exposure_blur, jpeg         1/50 s indoors; image_transport compresses with quality 80
///   gyro_scale, accel_scale, imu_misalignment, g_sensitivity
///                               tolerances of the Bosch BMI055: 1 %, cross-axis 1 % (0.6 degrees), 0.1
///                               (deg/s)/g
///   imu_vibration               rotors and wheels; residuals of EuRoC samples along a smooth path, 0.15
///   m/s^2
///                               and 0.01 rad/s (`SmootherConfig`)
///   imu_noise                   ratios by which VINS systems increase stated densities, 4 to 40 (real
///   sensors) clock_drift                 tolerance of a quartz crystal, 20 ppm
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {

enum class FaultKind {
  // all imperfections at once
  kRig,
  // stated calibration
  kFocalError,
  kCenterError,
  kDistortionError,
  kRotationError,
  kLeverError,
  // images
  kBlank,
  kFrozen,
  kDropped,
  kExposure,
  kMotionBlur,
  kRollingShutter,
  kLensSmear,
  kOccluder,
  kExposureSteps,
  kVignetting,
  kExposureBlur,
  kJpeg,
  // depth
  kDepthMissing,
  kDepthScaled,
  kDepthHoles,
  kDepthPrevious,
  kDepthBias,
  kDepthShift,
  kDepthNoise,
  // IMU
  kImuGap,
  kImuRate,
  kGyroSaturated,
  kAccelSaturated,
  kGyroBias,
  kAccelBias,
  kShock,
  kImuJitter,
  kTimeOffset,
  kClockJump,
  kGyroScale,
  kAccelScale,
  kImuMisalignment,
  kGSensitivity,
  kImuVibration,
  kImuNoise,
  kClockDrift,
  // recorded boxes
  kDetectorSilent,
  kDetectorLate,
  kDetectorHallucinating,
  // arrival of frames
  kFrameLate,
  kFrameReordered,
  kFrameDuplicated,
};

/// The data that a fault changes.
enum class FaultTarget { kCalibration, kImages, kDepth, kImu, kDetections, kArrival };

/// One entry of the list of kinds.
struct FaultDescriptor {
  FaultKind kind;
  std::string_view name;  ///< as in `--fault NAME`
  FaultTarget target;
  std::string_view summary;   ///< effect, one phrase
  std::string_view amount;    ///< meaning and unit of `SensorFault::amount`; empty if it has none
  double typical = 0.0;       ///< default amount
  double min = 0.0;           ///< smallest amount
  double max = 0.0;           ///< largest amount
  bool imperfection = false;  ///< by default active for the whole sequence
};

/// All kinds, in the order of `FaultKind`.
[[nodiscard]] std::span<const FaultDescriptor> fault_descriptors();
[[nodiscard]] const FaultDescriptor& descriptor_of(FaultKind kind);

/// A fault and its schedule. Active during
///
///   [start + k every, start + k every + duration),   k = 0, 1, ...  (only k = 0 if every = 0),
///
/// relative to the first frame of the sequence. A fault that starts at 0 and is not repeated is also active
/// before the first frame, where inertial samples begin.
struct SensorFault {
  FaultKind kind = FaultKind::kBlank;
  double start_s = 2.0;
  double duration_s = 1.0;
  double every_s = 0.0;  ///< period; 0 = once
  double amount = 0.0;   ///< see `FaultDescriptor::amount`
  std::uint64_t seed = 1;

  /// Whether it is active for the whole sequence.
  [[nodiscard]] bool is_permanent() const;
  /// @param elapsed_s time since the first frame
  [[nodiscard]] bool is_active(double elapsed_s) const;
  /// Start of the interval that contains `elapsed_s`, at which the fault must be active [s].
  [[nodiscard]] double onset_s(double elapsed_s) const;
  /// Random numbers that depend on `seed`: the same for the whole fault, or with index > 0 for one frame or
  /// sample.
  [[nodiscard]] synth::RandomSequence random(std::size_t index = 0) const;

  friend bool operator==(const SensorFault&, const SensorFault&) = default;
};

/// Duration of a fault that is active for the whole sequence.
inline constexpr double kWholeSequence_s = 1e6;

/// Parses "KIND" or "KIND:key=value,..." with the keys start, duration, every [s], amount and seed, e.g.
/// "blank:start=3,duration=0.5". Errors of the stated calibration have amount and seed only. Without start
/// and duration, an imperfection is active for the whole sequence, a fault from 2 s to 3 s.
/// @throws InputError for an unknown kind or key, and values that are not finite or out of range
[[nodiscard]] SensorFault parse_fault(std::string_view text);

/// Canonical text with all keys; inverse of `parse_fault`.
[[nodiscard]] std::string fault_text(const SensorFault& fault);

}  // namespace stillpoint::datasets
