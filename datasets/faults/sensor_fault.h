// SPDX-License-Identifier: BSD-3-Clause
/// Sensor faults that can be injected into a sequence: what, when, and how strong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::datasets {

enum class FaultKind {
  // images
  kBlank,
  kFrozen,
  kDropped,
  kExposure,
  kMotionBlur,
  kRollingShutter,
  kLensSmear,
  kOccluder,
  // depth
  kDepthMissing,
  kDepthScaled,
  kDepthHoles,
  kDepthPrevious,
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
enum class FaultTarget { kImages, kDepth, kImu, kDetections, kArrival };

/// One entry of the list of kinds.
struct FaultDescriptor {
  FaultKind kind;
  std::string_view name;  ///< as in `--fault NAME`
  FaultTarget target;
  std::string_view summary;  ///< effect, one phrase
  std::string_view amount;   ///< meaning and unit of `SensorFault::amount`; empty if it has none
  double typical = 0.0;      ///< default amount
  double min = 0.0;          ///< smallest amount
  double max = 0.0;          ///< largest amount
};

/// All kinds, in the order of `FaultKind`.
[[nodiscard]] std::span<const FaultDescriptor> fault_descriptors();
[[nodiscard]] const FaultDescriptor& descriptor_of(FaultKind kind);

/// A fault and its schedule. Active during
///
///   [start + k every, start + k every + duration),   k = 0, 1, ...  (only k = 0 if every = 0),
///
/// relative to the first frame of the sequence.
struct SensorFault {
  FaultKind kind = FaultKind::kBlank;
  double start_s = 2.0;
  double duration_s = 1.0;
  double every_s = 0.0;  ///< period; 0 = once
  double amount = 0.0;   ///< see `FaultDescriptor::amount`
  std::uint64_t seed = 1;

  /// @param elapsed_s time since the first frame
  [[nodiscard]] bool is_active(double elapsed_s) const;
  /// Start of the interval that contains `elapsed_s`, at which the fault must be active [s].
  [[nodiscard]] double onset_s(double elapsed_s) const;
  /// Random numbers that depend on `seed`: the same for the whole fault, or with index > 0 for one frame or
  /// sample.
  [[nodiscard]] synth::RandomSequence random(std::size_t index = 0) const;

  friend bool operator==(const SensorFault&, const SensorFault&) = default;
};

/// Parses "KIND" or "KIND:key=value,..." with the keys start, duration, every [s], amount and seed, e.g.
/// "blank:start=3,duration=0.5".
/// @throws InputError for an unknown kind or key, and values that are not finite or out of range
[[nodiscard]] SensorFault parse_fault(std::string_view text);

/// Canonical text with all keys; inverse of `parse_fault`.
[[nodiscard]] std::string fault_text(const SensorFault& fault);

}  // namespace stillpoint::datasets
