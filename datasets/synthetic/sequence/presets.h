// SPDX-License-Identifier: BSD-3-Clause
/// Description of a sequence to render: a named preset and its adjustable parameters, and their text, which
/// is written beside the sequence and hashed for the cache key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"
#include "core/types/rig.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/sensors/sensor_models.h"

namespace stillpoint {

/// In the namespace of `ImuNoise`, so that argument-dependent lookup finds it.
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuNoise>
void visit_fields(Visitor&& field, Config& noise) {
  field("gyro_noise", noise.gyro_noise);
  field("accel_noise", noise.accel_noise);
  field("gyro_walk", noise.gyro_walk);
  field("accel_walk", noise.accel_walk);
}

}  // namespace stillpoint

namespace stillpoint::synth {

enum class SequenceLayout { kOpenLoris, kTum };
constexpr auto enum_names(SequenceLayout) {
  return EnumNames<SequenceLayout, 2>{
      {{SequenceLayout::kOpenLoris, "openloris"}, {SequenceLayout::kTum, "tum"}}};
}

/// A sequence to render. Equal requests give bit-identical sequences. Created by `preset_request`.
struct SynthRequest {
  std::string preset = "walking_xyz";
  std::uint64_t seed = 1;
  double seconds = 20.0;
  double frames_per_s = 30.0;
  int width = 640;
  int height = 480;
  double focal_px = 535.0;  ///< for `width`; both axes
  int walkers = 0;          ///< walking people, with random stops
  int seated = 0;           ///< seated people, with small movements
  int unknown_movers = 0;   ///< carts and chairs: moving objects of classes that the detector does not report
  double rolling_shutter_s =
      0.0;  ///< read-out time from the first to the last row; timestamps refer to the middle row
  double dropped_fraction = 0.0;  ///< fraction of frames lost, singly or in short runs
  SequenceLayout layout = SequenceLayout::kOpenLoris;
  bool labels = false;  ///< also write an instance mask for each frame
  ColorSensor color;
  DepthSensor depth;
  ImuSensor imu;
  DetectorModel detector;
  double start_s = 5.0;  ///< preset `flight`: offset from the first time that both files cover; `fr3`: from
                         ///< the first pose; `mesh`: likewise
  /// Preset `flight`: poses T_w_b of the IMU (TUM text); `fr3`, `mesh`: of the camera, likewise; `home_tour`:
  /// ground truth of OpenLORIS home; `track`: ground truth of any scene of OpenLORIS.
  std::filesystem::path trajectory_file;
  std::filesystem::path imu_file;  ///< preset `flight`: IMU samples (EuRoC CSV)
  int track_sequence = 0;          ///< preset `track`: number of the sequence in `trajectory_file`, from 1
  /// Recorded frame times, see `load_recorded_times`; they replace equal intervals. Not for the preset
  /// `flight`.
  std::filesystem::path times_file;
  std::filesystem::path mesh_file;  ///< preset `mesh`: the scene, see `read_mesh`
  std::filesystem::path rig_file;   ///< intrinsics, distortion and T_b_c of the camera, see `use_rig`
};

/// Visits every field in a fixed order, for printing, hashing and setting by key. The keys are part of the
/// cache key of a sequence; those added later are visited only if they are set, so that the keys of other
/// sequences do not change. File names are passed as temporary strings.
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ColorSensor>
void visit_fields(Visitor&& field, Config& sensor) {
  field("exposure_s", sensor.exposure_s);
  field("read_noise", sensor.read_noise);
  field("shot_noise", sensor.shot_noise);
  field("vignetting", sensor.vignetting);
  field("exposure_swing", sensor.exposure_swing);
  field("exposure_period_s", sensor.exposure_period_s);
}
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DepthSensor>
void visit_fields(Visitor&& field, Config& sensor) {
  field("noise_per_m", sensor.noise_per_m);
  field("correlated_share", sensor.correlated_fraction);
  field("correlation_px", sensor.correlation_px);
  field("focal_baseline_px_m", sensor.focal_baseline_px_m);
  field("disparity_step_px", sensor.disparity_step_px);
  field("min_m", sensor.min_m);
  field("max_m", sensor.max_m);
  field("edge_dropout", sensor.edge_dropout);
  field("units_per_m", sensor.units_per_m);
}
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuSensor>
void visit_fields(Visitor&& field, Config& sensor) {
  field("gyro_rate_hz", sensor.gyro_rate_hz);
  field("accel_rate_hz", sensor.accel_rate_hz);
  field("noise", sensor.noise);
  field("gyro_bias", sensor.gyro_bias);
  field("accel_bias", sensor.accel_bias);
  field("time_offset_s", sensor.time_offset_s);
}
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DetectorModel>
void visit_fields(Visitor&& field, Config& model) {
  field("miss_share", model.miss_rate);
  field("burst_frames", model.burst_frames);
  field("jitter_share", model.jitter_ratio);
  field("false_share", model.false_positive_rate);
  field("min_height_px", model.min_height_px);
}
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, SynthRequest>
void visit_fields(Visitor&& field, Config& request) {
  field("preset", request.preset);
  field("seed", request.seed);
  field("seconds", request.seconds);
  field("frames_per_s", request.frames_per_s);
  field("width", request.width);
  field("height", request.height);
  field("focal_px", request.focal_px);
  field("walkers", request.walkers);
  field("seated", request.seated);
  field("unknown_movers", request.unknown_movers);
  field("rolling_shutter_s", request.rolling_shutter_s);
  field("dropped_share", request.dropped_fraction);
  field("layout", request.layout);
  field("labels", request.labels);
  field("color", request.color);
  field("depth", request.depth);
  field("imu", request.imu);
  field("detector", request.detector);
  field("start_s", request.start_s);
  field("trajectory_file", request.trajectory_file.string());
  field("imu_file", request.imu_file.string());
  if (request.track_sequence > 0) field("track_sequence", request.track_sequence);
  if (!request.times_file.empty()) field("times_file", request.times_file.string());
  if (!request.mesh_file.empty()) field("mesh_file", request.mesh_file.string());
  if (!request.rig_file.empty()) field("rig_file", request.rig_file.string());
}

/// Names of all presets: walking_{xyz,static,rpy,halfsphere}, market, corridor, each also with the suffix
/// `_empty` (static scene); `flight` (recorded trajectory and IMU samples, static scene); `track` (recorded
/// trajectory of a robot, static scene); `fr3` (recorded trajectory of a hand-held camera, IMU samples of a
/// spline of it), fr3_walking_{xyz,static,rpy,halfsphere} and fr3_sitting_static, which have the trajectory
/// and the frame times of that sequence of TUM RGB-D (tum_fr3_groundtruth and tum_fr3_times of the data); and
/// those that return to places, for loop closure: {office,corridor,market}_laps, twin_aisles, changed_room,
/// each also with the suffix `_short`, and `home_tour` (recorded trajectory of a robot). These have small
/// images, because they are long: 1 GB at most.
[[nodiscard]] std::vector<std::string> preset_names();

/// Whether the preset, or the one with the suffix `_short`, is `name`.
[[nodiscard]] bool is_preset(const SynthRequest& request, const std::string& name);

/// Whether the preset returns to places.
[[nodiscard]] bool is_loop_preset(const SynthRequest& request);

/// Whether the preset is `fr3`, or one of its sequences.
[[nodiscard]] bool is_hand_recording(const SynthRequest& request);

/// Whether the scene is that of a file: the preset `mesh`.
[[nodiscard]] bool is_mesh(const SynthRequest& request);

/// Whether the preset has the suffix `_short`.
[[nodiscard]] bool is_short(const SynthRequest& request);

/// The request of a preset with its defaults.
/// @throws InputError if there is no preset of that name
[[nodiscard]] SynthRequest preset_request(const std::string& name);

/// Checks ranges and that the files of the preset exist.
/// @throws InputError naming the first field that is out of range, or the file that is missing
void check_request(const SynthRequest& request);

/// Incremented whenever the output for an unchanged request changes.
inline constexpr int kRendererVersion = 12;

/// The renderer version and every field of the request, one TOML line each.
[[nodiscard]] std::string request_text(const SynthRequest& request);

/// Cache key: 64-bit FNV-1a hash of the text and of the contents of the referenced files, as 16 hexadecimal
/// digits.
/// @throws InputError if one of those files cannot be read
[[nodiscard]] std::string request_key(const SynthRequest& request);

/// Identity of the sequence in records of runs: "synth-" and the key. @throws InputError as `request_key`
[[nodiscard]] std::string sequence_id(const SynthRequest& request);

}  // namespace stillpoint::synth
