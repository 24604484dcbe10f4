// SPDX-License-Identifier: BSD-3-Clause
/// Reads trajectories in any supported format.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/base/fields.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

enum class TrajectoryFormat { kTum, kEuroc, kKitti, kOpenloris, kSevenScenes, kNmea };
constexpr auto enum_names(TrajectoryFormat) {
  return EnumNames<TrajectoryFormat, 6>{{{TrajectoryFormat::kTum, "tum"},
                                         {TrajectoryFormat::kEuroc, "euroc"},
                                         {TrajectoryFormat::kKitti, "kitti"},
                                         {TrajectoryFormat::kOpenloris, "openloris"},
                                         {TrajectoryFormat::kSevenScenes, "7scenes"},
                                         {TrajectoryFormat::kNmea, "nmea"}}};
}

struct TrajectorySource {
  std::filesystem::path path;
  std::optional<TrajectoryFormat> format = std::nullopt;  ///< nullopt: detected from the content
  std::filesystem::path times = {};                       ///< file with the time stamps, for KITTI
  int sequence = 0;                                       ///< sequence number, for OpenLORIS; 0: the only one
};

/// Reads a trajectory. Format detection: a folder is 7-Scenes; a file that begins with a sentence is NMEA; a
/// file with a "key: value" line is OpenLORIS; rows of 12 numbers are KITTI; rows whose first field is an
/// integer of 16 digits or more are EuRoC; other rows are TUM.
/// @throws InputError for unreadable or malformed input, KITTI without times, or several sequences without a
/// sequence number
[[nodiscard]] LoadedTrajectory read_trajectory(const TrajectorySource& source);

/// The format of a text by the rules of `read_trajectory`.
[[nodiscard]] TrajectoryFormat detect_format(std::string_view text);

}  // namespace stillpoint::eval
