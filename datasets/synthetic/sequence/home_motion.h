// SPDX-License-Identifier: BSD-3-Clause
/// Motion of the OpenLORIS robots, from the ground truth of the data set (Shi et al. 2020).
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/synthetic/motion/robot_motion.h"

namespace stillpoint::synth {

/// Default location of the ground truth of the scene "home":
/// $STILLPOINT_DATA/openloris/groundtruth/gt_home_1.txt, else below ../shared/data. It may not exist.
[[nodiscard]] std::filesystem::path home_ground_truth_file();

/// Sequences 2, 5 and the last three quarters of 1, each of which begins about where the one before it ends:
/// one tour of 241 s that visits all rooms twice. They are joined by cubic curves along both headings.
/// @param file OpenLORIS text with the sequences 1, 2 and 5, poses of base_link
/// @return times from 0; the camera is mounted as on the robot, but looks exactly forward
/// @throws InputError if the file cannot be read or lacks a sequence
[[nodiscard]] RobotTrack load_home_track(const std::filesystem::path& file);

/// One recorded sequence, and the timestamp of its first pose.
struct RecordedTrack {
  RobotTrack track;  ///< times from 0
  Timestamp first;
};

/// A sequence of any scene. The camera looks exactly forward, at the height of that of the robot of the
/// scene.
/// @param file OpenLORIS text, poses of base_link @param sequence its number
/// @throws InputError if the file cannot be read, or the sequence is missing or has fewer than two poses
[[nodiscard]] RecordedTrack load_track(const std::filesystem::path& file, int sequence);

/// Closed routes of two people on floor that the tour does not cross.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> home_walking_routes();

}  // namespace stillpoint::synth
