// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/sensor_fault.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

using enum FaultKind;
using enum FaultTarget;

constexpr FaultDescriptor kDescriptors[] = {
    {kRig, "rig", kCalibration, "all imperfections of a consumer rig at once, drawn by the seed",
     "ratio of the magnitudes", 1.0, 0.0, 10.0, true},
    {kFocalError, "focal_error", kCalibration, "the stated focal length is wrong", "error [%]", 1.0, -50.0,
     50.0, true},
    {kCenterError, "center_error", kCalibration, "the stated principal point is wrong, in a random direction",
     "distance [px]", 3.0, 0.0, 1000.0, true},
    {kDistortionError, "distortion_error", kCalibration, "the stated k1 is smaller than that of the lens",
     "difference", 0.02, -1.0, 1.0, true},
    {kRotationError, "rotation_error", kCalibration,
     "the stated camera pose on the body is rotated about a random axis", "angle [deg]", 1.0, -180.0, 180.0,
     true},
    {kLeverError, "lever_error", kCalibration,
     "the stated camera position on the body is wrong, in a random direction", "distance [m]", 0.01, 0.0,
     10.0, true},
    {kBlank, "blank", kImages, "all pixels have one gray level", "gray level", 0.0, 0.0, 255.0},
    {kFrozen, "frozen", kImages, "the pixels of the last frame before the fault, with new stamps", ""},
    {kDropped, "dropped", kImages, "frames are missing", "fraction of frames", 1.0, 0.0, 1.0},
    {kExposure, "exposure", kImages, "brightness is multiplied and clipped", "factor", 0.3, 0.01, 100.0},
    {kMotionBlur, "motion_blur", kImages, "pixels are averaged along a line", "length [px]", 15.0, 1.0,
     201.0},
    {kRollingShutter, "rolling_shutter", kImages,
     "rows are displaced horizontally in proportion to their index", "displacement of the last row [px]", 8.0,
     -200.0, 200.0},
    {kLensSmear, "lens_smear", kImages, "spots of the lens are smeared", "fraction of the image", 0.2, 0.0,
     1.0},
    {kOccluder, "occluder", kImages, "a person directly in front of the camera, not in the boxes",
     "fraction of the image", 0.8, 0.0, 1.0},
    {kExposureSteps, "exposure_steps", kImages, "the exposure changes every 20 frames",
     "largest change [stops]", 0.5, 0.0, 5.0, true},
    {kVignetting, "vignetting", kImages, "brightness decreases towards the corners",
     "fraction of light lost in the corners", 0.3, 0.0, 1.0, true},
    {kExposureBlur, "exposure_blur", kImages, "pixels are averaged along the motion by the angular rate",
     "exposure time [s]", 0.02, 0.0, 0.2, true},
    {kJpeg, "jpeg", kImages, "images are compressed with loss", "quality", 80.0, 1.0, 100.0, true},
    {kDepthMissing, "depth_missing", kDepth, "no pixel has depth", ""},
    {kDepthScaled, "depth_scaled", kDepth, "depth is multiplied", "factor", 0.85, 0.1, 10.0},
    {kDepthHoles, "depth_holes", kDepth, "blocks of 16x16 pixels have no depth", "fraction of blocks", 0.5,
     0.0, 1.0},
    {kDepthPrevious, "depth_previous", kDepth, "the depth of the previous frame", ""},
    {kDepthBias, "depth_bias", kDepth, "depth has an error that grows with its square", "error / z^2 [1/m]",
     0.003, -0.1, 0.1, true},
    {kDepthShift, "depth_shift", kDepth, "depth is displaced in a random direction", "distance [px]", 2.0,
     0.0, 100.0, true},
    {kDepthNoise, "depth_noise", kDepth, "depth has noise that is correlated over 8 pixels",
     "standard deviation / z^2 [1/m]", 0.003, 0.0, 0.1, true},
    {kImuGap, "imu_gap", kImu, "samples are missing", ""},
    {kImuRate, "imu_rate", kImu, "only some samples arrive", "rate [Hz]", 30.0, 1.0, 10000.0},
    {kGyroSaturated, "gyro_saturated", kImu, "angular rates are clipped", "limit [rad/s]", 0.5, 0.0, 100.0},
    {kAccelSaturated, "accel_saturated", kImu, "specific forces are clipped", "limit [m/s^2]", 10.0, 0.0,
     1000.0},
    {kGyroBias, "gyro_bias", kImu, "the gyro bias changes on each axis", "change [rad/s]", 0.02, -10.0, 10.0},
    {kAccelBias, "accel_bias", kImu, "the accelerometer bias changes on each axis", "change [m/s^2]", 0.3,
     -100.0, 100.0},
    {kShock, "shock", kImu, "a constant acceleration in a random direction is added", "acceleration [m/s^2]",
     8.0, 0.0, 1000.0},
    {kImuJitter, "imu_jitter", kImu, "stamps are noisy, their order is kept", "standard deviation [s]", 0.001,
     0.0, 0.1},
    {kTimeOffset, "time_offset", kImu, "stamps are shifted", "shift [s]", 0.02, -1.0, 1.0},
    {kClockJump, "clock_jump", kImu, "stamps are shifted from the start of the fault on", "shift [s]", 0.1,
     0.0, 10.0},
    {kGyroScale, "gyro_scale", kImu, "angular rates are scaled, per axis with a random sign", "error [%]",
     0.5, 0.0, 50.0, true},
    {kAccelScale, "accel_scale", kImu, "specific forces are scaled, per axis with a random sign", "error [%]",
     1.0, 0.0, 50.0, true},
    {kImuMisalignment, "imu_misalignment", kImu, "the axes of both sensors are not orthogonal",
     "angle between axes [deg]", 0.3, 0.0, 20.0, true},
    {kGSensitivity, "g_sensitivity", kImu, "the gyro bias depends on the specific force",
     "sensitivity [(deg/s)/g]", 0.1, 0.0, 10.0, true},
    {kImuVibration, "imu_vibration", kImu, "sinusoids of one frequency between 40 and 120 Hz are added",
     "amplitude [m/s^2]", 0.2, 0.0, 100.0, true},
    {kImuNoise, "imu_noise", kImu, "white noise exceeds the stated densities",
     "ratio to the stated densities", 3.0, 1.0, 100.0, true},
    {kClockDrift, "clock_drift", kImu, "stamps drift", "drift [ppm]", 20.0, -1e5, 1e5, true},
    {kDetectorSilent, "detector_silent", kDetections, "frames are not processed by the detector", ""},
    {kDetectorLate, "detector_late", kDetections, "boxes arrive too late to be used", ""},
    {kDetectorHallucinating, "detector_hallucinating", kDetections, "boxes of persons where there are none",
     "additional boxes per frame", 2.0, 0.0, 100.0},
    {kFrameLate, "frame_late", kArrival, "frames arrive late; in real time, and overtaken by later ones",
     "delay [s]", 0.1, 0.0, 10.0},
    {kFrameReordered, "frame_reordered", kArrival, "frames arrive after their successor",
     "fraction of frames", 0.3, 0.0, 1.0},
    {kFrameDuplicated, "frame_duplicated", kArrival, "frames arrive again, with their successor",
     "fraction of frames", 0.3, 0.0, 1.0},
};

std::string kind_names() {
  std::vector<std::string_view> names;
  for (const FaultDescriptor& descriptor : kDescriptors) names.push_back(descriptor.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const FaultDescriptor& descriptor_named(std::string_view name, const std::string& place) {
  const auto* found =
      std::find_if(std::begin(kDescriptors), std::end(kDescriptors),
                   [&](const FaultDescriptor& descriptor) { return descriptor.name == name; });
  if (found == std::end(kDescriptors)) {
    throw InputError(place, fmt::format("\"{}\" is no kind of fault; use one of {}", name, kind_names()));
  }
  return *found;
}

double number_in(std::string_view value, double min, double max, const std::string& place) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc{} || end != value.data() + value.size() || !(number >= min && number <= max)) {
    throw InputError(place, fmt::format("\"{}\" is not a number from {} to {}", value, min, max));
  }
  return number;
}

constexpr double kMaxTime_s = kWholeSequence_s;

/// Errors of the stated calibration have no schedule.
bool has_schedule(const FaultDescriptor& descriptor) { return descriptor.target != kCalibration; }

/// Sets the field named by `key`.
void assign(std::string_view key, std::string_view value, SensorFault& fault, const std::string& place) {
  const FaultDescriptor& descriptor = descriptor_of(fault.kind);
  const bool is_time = key == "start" || key == "duration" || key == "every";
  if (is_time && !has_schedule(descriptor)) {
    throw InputError(place,
                     fmt::format("\"{}\" lasts for the whole sequence; remove \"{}\"", descriptor.name, key));
  }
  if (key == "start") {
    fault.start_s = number_in(value, 0.0, kMaxTime_s, place);
  } else if (key == "duration") {
    fault.duration_s = number_in(value, 0.0, kMaxTime_s, place);
  } else if (key == "every") {
    fault.every_s = number_in(value, 0.0, kMaxTime_s, place);
  } else if (key == "amount" && !descriptor.amount.empty()) {
    fault.amount = number_in(value, descriptor.min, descriptor.max, place);
  } else if (key == "amount") {
    throw InputError(place, fmt::format("\"{}\" has no amount", descriptor.name));
  } else if (key == "seed") {
    const double seed = number_in(value, 0.0, 1e9, place);
    if (seed != std::floor(seed))
      throw InputError(place, fmt::format("seed \"{}\" is not an integer", value));
    fault.seed = static_cast<std::uint64_t>(seed);
  } else {
    throw InputError(place,
                     fmt::format("unknown key \"{}\"; use start, duration, every, amount or seed", key));
  }
}

/// Sets the fields of a list "key=value,key=value,...", in which a key occurs once.
void assign_all(std::string_view list, SensorFault& fault, const std::string& place) {
  std::set<std::string_view> keys;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string_view item = list.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos)
      throw InputError(place, fmt::format("\"{}\" is not key=value", item));
    const std::string_view key = item.substr(0, equals);
    if (!keys.insert(key).second) throw InputError(place, fmt::format("\"{}\" is given twice", key));
    assign(key, item.substr(equals + 1), fault, place);
  }
}

}  // namespace

std::span<const FaultDescriptor> fault_descriptors() { return kDescriptors; }

const FaultDescriptor& descriptor_of(FaultKind kind) {
  const FaultDescriptor& descriptor = kDescriptors[static_cast<std::size_t>(kind)];
  STILLPOINT_CHECK(descriptor.kind == kind);
  return descriptor;
}

bool SensorFault::is_permanent() const { return start_s == 0.0 && duration_s >= kWholeSequence_s; }

bool SensorFault::is_active(double elapsed_s) const {
  if (start_s == 0.0 && every_s <= 0.0) return elapsed_s < duration_s;
  return elapsed_s >= start_s && elapsed_s - onset_s(elapsed_s) < duration_s;
}

double SensorFault::onset_s(double elapsed_s) const {
  return every_s <= 0.0 ? start_s : start_s + std::floor((elapsed_s - start_s) / every_s) * every_s;
}

synth::RandomSequence SensorFault::random(std::size_t index) const {
  return synth::RandomSequence(synth::random_key(seed, synth::RandomStream::kFaults, index));
}

SensorFault parse_fault(std::string_view text) {
  const std::string place = fmt::format("fault \"{}\"", text);
  const std::size_t colon = text.find(':');
  const FaultDescriptor& descriptor = descriptor_named(text.substr(0, colon), place);
  SensorFault fault{.kind = descriptor.kind, .amount = descriptor.typical};
  if (descriptor.imperfection) fault.start_s = 0.0, fault.duration_s = kWholeSequence_s;
  if (colon != std::string_view::npos) assign_all(text.substr(colon + 1), fault, place);
  if (fault.every_s > 0.0 && fault.every_s <= fault.duration_s) {
    throw InputError(place, "the period \"every\" must exceed the duration");
  }
  return fault;
}

std::string fault_text(const SensorFault& fault) {
  const FaultDescriptor& descriptor = descriptor_of(fault.kind);
  if (!has_schedule(descriptor))
    return fmt::format("{}:amount={},seed={}", descriptor.name, fault.amount, fault.seed);
  std::string text = fmt::format("{}:start={},duration={}", descriptor.name, fault.start_s, fault.duration_s);
  if (fault.every_s > 0.0) text += fmt::format(",every={}", fault.every_s);
  if (!descriptor.amount.empty()) text += fmt::format(",amount={}", fault.amount);
  return text + fmt::format(",seed={}", fault.seed);
}

}  // namespace stillpoint::datasets
