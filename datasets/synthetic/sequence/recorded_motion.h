// SPDX-License-Identifier: BSD-3-Clause
/// What a rendered sequence takes from recordings: the frame times with the frames that were lost, the motion
/// of the OpenLORIS robots (ground truth of the data set, Shi et al. 2020), that of the hand-held camera of
/// TUM RGB-D (Sturm et al. 2012), and a motion with its original IMU samples, smoothed to render along.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/motion/inertial_smoother.h"
#include "datasets/synthetic/motion/path_spline.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

/// Timestamps of the images, at equal intervals or as recorded: one entry per frame; the depth image of a
/// frame shows the scene at the time of its color image.
struct FrameTimes {
  std::vector<Timestamp> color;  ///< increasing
  std::vector<Timestamp> depth;  ///< equal to `color` unless recorded
};

/// Times of a recording with the frames that it lost. A line has the time of the color image [s], and may
/// have that of the depth image in its third field, as written by the association script of TUM RGB-D; the
/// other fields are names of files. Lines that begin with # are skipped.
/// @param file the recording @param seconds duration from the first frame on
/// @param from frames before this time are skipped
/// @return in whole microseconds
/// @throws InputError with file:line if a time cannot be read or does not increase, and if there is no frame
[[nodiscard]] FrameTimes load_recorded_times(const std::filesystem::path& file, double seconds,
                                             Timestamp from = {std::numeric_limits<std::int64_t>::min()});

/// Default location of a recording: below $STILLPOINT_DATA, else below ../shared/data. It may not exist.
[[nodiscard]] std::filesystem::path recording_file(const std::filesystem::path& relative);

/// Motion of a hand-held camera.
struct HandRecording {
  PathSpline body_path;  ///< in the frame of the motion capture system, gravity along -z
  Eigen::Vector3d mean_eye_w = Eigen::Vector3d::Zero();  ///< camera position, over the whole recording
  double extent_m = 0.0;  ///< largest side of the box around the camera positions, likewise
  double mean_yaw = 0.0;  ///< of the optical axis, likewise [rad]
  Timestamp epoch;        ///< timestamp of path time 0
};

/// Loads and smooths the ground truth of a sequence of TUM RGB-D, poses T_w_c of the color camera at 100 Hz.
/// The first frame is the first one at least `start_s` and 0.5 s after the first pose; it is at path time
/// `first_frame_s`. Knots are 50 ms apart: motion above 10 Hz, where the noise of motion capture exceeds hand
/// tremor, is removed. For the preset `mesh` they are as far apart as the poses need that are at less than 30
/// Hz.
/// @param request with its trajectory, and frame times if there are recorded ones
/// @param path    pose of the camera in the body frame; interval of the result
/// @throws InputError if a file cannot be read, does not cover the interval, or has a gap in it: 0.5 s; for
/// `mesh` three times the median interval, at least 0.1 s, or a jump: more than 16 g or 1000 deg/s
[[nodiscard]] HandRecording load_hand_recording(const SynthRequest& request, const PathRequest& path,
                                                double first_frame_s);

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

/// Smoothed trajectory and original IMU samples.
struct RecordedMotion {
  SmoothedMotion smoothed;
  Timestamp epoch;     ///< timestamp of path time 0, the first frame
  ImuRecord readings;  ///< as recorded
  Pose T_b_c;
};

inline constexpr double kRecordingMargin_s = 0.5;  ///< data used beyond the first and last frame

/// Loads and smooths the recording of `request`, from `start_s` after the first time that both files cover.
/// @throws InputError if a file cannot be read or the files do not cover the requested interval
[[nodiscard]] RecordedMotion load_recorded_motion(const SynthRequest& request);

/// Extrinsics of a virtual camera that looks approximately horizontally: EuRoC's left camera if the x axis of
/// the IMU points up; looking along -y (as on the TUM-VI rig) if its z axis points up.
/// @param up_b mean specific force in the body frame, which points up
/// @throws InputError if neither axis is within 45 degrees of it
[[nodiscard]] Pose virtual_camera_T_b_c(const Eigen::Vector3d& up_b);

}  // namespace stillpoint::synth
