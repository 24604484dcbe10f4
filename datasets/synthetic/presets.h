// SPDX-License-Identifier: BSD-3-Clause
/// What to render: a named preset, and everything about it that may be changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/fields.h"
#include "core/types/rig.h"
#include "datasets/synthetic/color_sensor.h"
#include "datasets/synthetic/depth_sensor.h"
#include "datasets/synthetic/imu_model.h"

namespace stillpoint {

enum class SequenceLayout { kOpenLoris, kTum };
constexpr auto enum_names(SequenceLayout) {
  return EnumNames<SequenceLayout, 2>{
      {{SequenceLayout::kOpenLoris, "openloris"}, {SequenceLayout::kTum, "tum"}}};
}

/// A sequence to render. Equal requests give equal bits. Make one with `preset_request`.
struct SynthRequest {
  std::string preset = "walking_xyz";
  std::uint64_t seed = 1;
  double seconds = 20.0;
  double frames_per_s = 30.0;
  int width = 640;
  int height = 480;
  double focal_px = 535.0;  ///< for `width`; both axes
  int walkers = 0;          ///< people who walk, some of whom stop and go
  int seated = 0;           ///< people who sit and move a little
  int unknown_movers = 0;   ///< carts and chairs that no detector knows
  double rolling_shutter_s =
      0.0;                     ///< read-out time from the first to the last row; stamps are of the middle row
  double dropped_share = 0.0;  ///< of the frames, lost singly or in short runs
  SequenceLayout layout = SequenceLayout::kOpenLoris;
  bool labels = false;  ///< also write a picture of instance numbers for each frame
  ColorSensor color;
  DepthSensor depth;
  ImuSensor imu;
  std::filesystem::path trajectory_file;  ///< preset flight: poses of the IMU (TUM text)
  std::filesystem::path imu_file;         ///< preset flight: its readings (EuRoC csv)
};

/// Names of all presets: walking_{xyz,static,rpy,halfsphere}, market, corridor, each also with the ending
/// `_empty` (nobody moves), and `flight` (a given path and its real IMU readings, nobody moves).
[[nodiscard]] std::vector<std::string> preset_names();

/// The request of a preset with its defaults.
/// @throws InputError if there is no preset of that name
[[nodiscard]] SynthRequest preset_request(const std::string& name);

/// Checks ranges. @throws InputError naming the first field that is out of range
void check_request(const SynthRequest& request);

/// Pinhole camera of the request, its axis through the middle of the picture.
[[nodiscard]] Camera camera_of(const SynthRequest& request);

/// Camera in the body of presets that have no real body: RealSense D435i, colour camera to IMU.
[[nodiscard]] Pose realsense_T_b_c();

}  // namespace stillpoint
