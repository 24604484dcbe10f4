// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/recorded_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/io/imu_file.h"
#include "eval/io/openloris_file.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::synth {
namespace {

Timestamp time_of(const std::string& field, const std::string& place) {
  const std::optional<Timestamp> time = eval::parse_stamp(field);
  if (!time) throw InputError(place, "\"" + field + "\" is not a time; expected seconds");
  constexpr std::int64_t kMicrosecond_ns = 1000;
  return {time->ns / kMicrosecond_ns * kMicrosecond_ns};
}

}  // namespace

FrameTimes load_recorded_times(const std::filesystem::path& file, double seconds, Timestamp from) {
  std::ifstream input(file);
  FrameTimes times;
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    std::istringstream fields(line);
    std::string color, name, depth;
    if (!(fields >> color) || color.starts_with('#')) continue;
    const std::string place = file.string() + ":" + std::to_string(number);
    const Timestamp t = time_of(color, place);
    if (t < from) continue;
    if (!times.color.empty() && seconds_between(times.color.front(), t) >= seconds) break;
    if (!times.color.empty() && t <= times.color.back())
      throw InputError(place, "the time does not increase; sort the file");
    times.color.push_back(t);
    times.depth.push_back(fields >> name >> depth ? time_of(depth, place) : t);
  }
  if (times.color.empty())
    throw InputError(file.string(), "cannot be read or contains no time; pass lines of `TIME [NAME TIME]`");
  return times;
}

namespace {

using Eigen::Vector2d;

/// A part of a sequence of the file.
struct Piece {
  int sequence;
  double from_s;  ///< after the first pose of the sequence
};
constexpr std::array<Piece, 3> kPieces{{{2, 0.0}, {5, 0.0}, {1, 37.0}}};

// Pose of d400_color in base_link, 1 degree from level: robot of office, home, cafe and corridor.
constexpr double kCameraForward_m = 0.23;
constexpr double kCameraHeight_m = 0.92;
// Robot of market.
constexpr double kMarketCameraForward_m = 0.4;
constexpr double kMarketCameraHeight_m = 1.2;

constexpr double kJoinSpeed = 0.25;    // [m/s]
constexpr double kJoinTurnRate = 0.5;  // [rad/s]
constexpr double kMinJoin_s = 0.5;
constexpr double kJoinStep_s = 0.05;

double nearest_turn(double heading, double previous) {
  return previous + std::remainder(heading - previous, 2.0 * std::numbers::pi);
}

PlanarPose planar(const StampedPose& pose, double t_s) {
  const Eigen::Vector3d forward = pose.T_w_f.q * Eigen::Vector3d::UnitX();
  return {t_s, pose.T_w_f.p.head<2>(), std::atan2(forward.y(), forward.x())};
}

Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }

/// Appends a cubic Hermite curve to `to`, whose tangents are the headings at both ends.
void join(std::vector<PlanarPose>& track, const PlanarPose& to) {
  const PlanarPose from = track.back();
  const double distance = (to.position - from.position).norm();
  const double turn = std::remainder(to.heading - from.heading, 2.0 * std::numbers::pi);
  const double duration_s = std::max({kMinJoin_s, distance / kJoinSpeed, std::abs(turn) / kJoinTurnRate});
  for (double t_s = kJoinStep_s; t_s < duration_s; t_s += kJoinStep_s) {
    const double u = t_s / duration_s, v = 1.0 - u;
    const Vector2d position = v * v * (1.0 + 2.0 * u) * from.position +
                              u * u * (1.0 + 2.0 * v) * to.position +
                              distance * u * v * (v * direction(from.heading) - u * direction(to.heading));
    track.push_back({from.t_s + t_s, position, from.heading + u * turn});
  }
  track.push_back({from.t_s + duration_s, to.position, from.heading + turn});
}

void append(std::vector<PlanarPose>& track, const Trajectory& sequence, double from_s) {
  const Timestamp first = after(sequence.poses.front().t, from_s);
  const auto begin = std::find_if(sequence.poses.begin(), sequence.poses.end(),
                                  [&](const StampedPose& pose) { return pose.t >= first; });
  for (auto pose = begin; pose != sequence.poses.end(); ++pose) {
    if (track.empty()) {
      track.push_back(planar(*pose, 0.0));
    } else if (pose == begin) {
      join(track, planar(*pose, 0.0));
    } else {
      const double interval_s = seconds_between((pose - 1)->t, pose->t);
      PlanarPose next = planar(*pose, track.back().t_s + interval_s);
      next.heading = nearest_turn(next.heading, track.back().heading);
      track.push_back(next);
    }
  }
}

}  // namespace

std::filesystem::path recording_file(const std::filesystem::path& relative) {
  const char* set = std::getenv("STILLPOINT_DATA");
  const std::filesystem::path data = set != nullptr ? set : "../shared/data";
  return data / relative;
}

RobotTrack load_home_track(const std::filesystem::path& file) {
  const eval::OpenlorisFile truth = eval::read_openloris(file, eval::RepeatedPoses::kKeep);
  RobotTrack track{.poses = {}, .camera_forward_m = kCameraForward_m, .camera_height_m = kCameraHeight_m};
  for (const auto& [number, from_s] : kPieces) {
    const auto sequence = truth.sequences.find(number);
    if (sequence == truth.sequences.end() || sequence->second.poses.size() < 2 ||
        seconds_between(sequence->second.poses.front().t, sequence->second.poses.back().t) <= from_s) {
      throw InputError(file.string(),
                       "sequence " + std::to_string(number) +
                           " is missing or too short; use gt_home_1.txt of the OpenLORIS tools");
    }
    append(track.poses, sequence->second, from_s);
  }
  return track;
}

RecordedTrack load_track(const std::filesystem::path& file, int sequence) {
  const eval::OpenlorisFile truth = eval::read_openloris(file, eval::RepeatedPoses::kKeep);
  const auto found = truth.sequences.find(sequence);
  if (found == truth.sequences.end() || found->second.poses.size() < 2) {
    throw InputError(file.string(), "sequence " + std::to_string(sequence) +
                                        " is missing or has fewer than two poses; choose another one");
  }
  const bool market = truth.scene == "market";
  RecordedTrack recorded{{.poses = {},
                          .camera_forward_m = market ? kMarketCameraForward_m : kCameraForward_m,
                          .camera_height_m = market ? kMarketCameraHeight_m : kCameraHeight_m},
                         found->second.poses.front().t};
  append(recorded.track.poses, found->second, 0.0);
  return recorded;
}

std::vector<std::vector<Vector2d>> home_walking_routes() {
  return {{{5.0, -3.9}, {6.2, -3.9}, {6.2, -2.8}, {5.0, -2.8}},
          {{5.4, 0.6}, {6.3, 0.6}, {6.3, 2.4}, {5.4, 2.4}}};
}

namespace {

Pose euroc_T_b_c() {  // mav0/cam0/sensor.yaml of the EuRoC data set (Burri et al. 2016)
  Eigen::Matrix4d T_b_c;
  T_b_c << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975, 0.999557249008,
      0.0149672133247, 0.025715529948, -0.064676986768, -0.0257744366974, 0.00375618835797, 0.999660727178,
      0.00981073058949, 0.0, 0.0, 0.0, 1.0;
  return Pose::from_matrix(T_b_c);
}

Pose level_T_b_c() {
  Eigen::Matrix4d T_b_c;  // x right = -x, y down = -z, z forward = -y of the IMU
  T_b_c << -1.0, 0.0, 0.0, 0.05, 0.0, 0.0, -1.0, -0.07, 0.0, -1.0, 0.0, -0.04, 0.0, 0.0, 0.0, 1.0;
  return Pose::from_matrix(T_b_c);
}

template <class Stamped>
std::vector<Stamped> between(const std::vector<Stamped>& all, Timestamp from, Timestamp to) {
  std::vector<Stamped> part;
  std::copy_if(all.begin(), all.end(), std::back_inserter(part),
               [&](const Stamped& one) { return one.t >= from && one.t <= to; });
  return part;
}

ImuRecord to_imu_record(const std::vector<ImuSample>& samples) {
  ImuRecord record;
  for (const ImuSample& sample : samples) {
    record.gyro.push_back({sample.t, sample.gyro_b});
    record.accel.push_back({sample.t, sample.accel_b});
  }
  return record;
}

Eigen::Vector3d mean_force(const std::vector<ImuSample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) sum += sample.accel_b;
  return sum / static_cast<double>(samples.size());
}

}  // namespace

Pose virtual_camera_T_b_c(const Eigen::Vector3d& up_b) {
  const Eigen::Vector3d up = up_b.normalized();
  constexpr double kWithin45Degrees = 0.7071;
  if (up.x() > kWithin45Degrees) return euroc_T_b_c();
  if (up.z() > kWithin45Degrees) return level_T_b_c();
  throw InputError(
      "--imu", fmt::format("the mean specific force points along ({:.2f}, {:.2f}, {:.2f}); expected an IMU "
                           "whose x or z axis points up",
                           up.x(), up.y(), up.z()));
}

namespace {

/// Poses of the body between two times.
std::vector<StampedPose> body_poses(const Trajectory& camera, const Pose& T_b_c, Timestamp from,
                                    Timestamp to) {
  std::vector<StampedPose> poses = between(camera.poses, from, to);
  for (StampedPose& pose : poses) pose.T_w_f = pose.T_w_f * T_b_c.inverse();
  return poses;
}

constexpr double kHandKnot_s = 0.05;

/// Intervals between poses, and those from the ends of the interval that they are to cover [s].
std::vector<double> intervals_s(const std::vector<StampedPose>& poses, Timestamp from, Timestamp to) {
  std::vector<double> intervals;
  Timestamp before = from;
  for (const StampedPose& pose : poses) {
    intervals.push_back(seconds_between(before, pose.t));
    before = pose.t;
  }
  intervals.push_back(seconds_between(before, to));
  return intervals;
}

/// Long enough for poses at any rate: each knot needs some. Motion capture at 100 Hz keeps the default.
/// @throws InputError if there is a gap
double knot_interval_s(const SynthRequest& request, std::vector<double> intervals) {
  constexpr double kGap_s = 0.5, kLeastGap_s = 0.1, kMedians = 3.0, kPosesPerKnot = 1.5;
  const double longest_s = std::ranges::max(intervals);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  const double gap_s = is_mesh(request) ? std::clamp(kMedians * *middle, kLeastGap_s, kGap_s) : kGap_s;
  if (longest_s > gap_s) {
    throw InputError(
        request.trajectory_file.string(),
        fmt::format("has no pose for {:.2f} s, and one every {:.3f} s elsewhere; choose a part without "
                    "gaps with --start and --seconds, or give poses at least every {:.2g} s",
                    longest_s, *middle, gap_s));
  }
  return is_mesh(request) ? std::max(kHandKnot_s, kPosesPerKnot * longest_s) : kHandKnot_s;
}

/// @throws InputError if the camera in a mesh moves beyond the range of inertial sensors, as where its poses
/// jump
void require_measurable(const SynthRequest& request, const HandRecording& recording, double from_s,
                        double to_s) {
  constexpr double kStep_s = 0.005;
  constexpr double kMost_mps2 = 157.0, kMost_radps = 17.5;  // 16 g and 1000 deg/s
  if (!is_mesh(request)) return;
  for (double t_s = from_s; t_s <= to_s; t_s += kStep_s) {
    const BodyMotion motion = recording.body_path.at(t_s);
    const double acceleration = motion.acceleration_w.norm(), rate = motion.rate_b.norm();
    if (acceleration <= kMost_mps2 && rate <= kMost_radps) continue;
    throw InputError(
        request.trajectory_file.string(),
        fmt::format("jumps near {} s: an acceleration of {:.0f} m/s^2 and a rate of {:.0f} rad/s; "
                    "choose a part without jumps with --start and --seconds",
                    eval::format_stamp(after(recording.epoch, t_s)), acceleration, rate));
  }
}

/// Sets the mean position and direction of the camera.
void describe_view(const Trajectory& camera, HandRecording& recording) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box;
  for (const StampedPose& pose : camera.poses) {
    box.extend(pose.T_w_f.p);
    recording.mean_eye_w += pose.T_w_f.p / static_cast<double>(camera.poses.size());
    axis += pose.T_w_f.q * Eigen::Vector3d::UnitZ();
  }
  recording.mean_yaw = std::atan2(axis.y(), axis.x());
  recording.extent_m = box.sizes().maxCoeff();
}

}  // namespace

HandRecording load_hand_recording(const SynthRequest& request, const PathRequest& path,
                                  double first_frame_s) {
  FaultLog faults;
  const Trajectory truth = eval::read_tum_ground_truth(request.trajectory_file, "camera", faults).trajectory;
  const Timestamp earliest = after(truth.poses.front().t, std::max(request.start_s, kRecordingMargin_s));
  const Timestamp first =
      request.times_file.empty()
          ? earliest
          : load_recorded_times(request.times_file, request.seconds, earliest).color.front();
  const Timestamp epoch = after(first, -first_frame_s);
  const double from_s = path.from_s - kRecordingMargin_s / 2.0, to_s = path.to_s + kRecordingMargin_s / 2.0;
  if (truth.poses.back().t < after(epoch, to_s)) {
    throw InputError(
        request.trajectory_file.string(),
        fmt::format(
            "contains poses of {:.1f} s, but {:.1f} s from {:.1f} s on are required; reduce --seconds "
            "or --start",
            seconds_between(truth.poses.front().t, truth.poses.back().t), request.seconds,
            seconds_between(truth.poses.front().t, first)));
  }
  const Timestamp from = after(epoch, from_s), to = after(epoch, to_s);
  const std::vector<StampedPose> poses = body_poses(truth, path.T_b_c, from, to);
  const SmootherConfig poses_only{.knot_interval_s = knot_interval_s(request, intervals_s(poses, from, to))};
  HandRecording recording{smooth_motion({poses, {}, epoch, from_s, to_s}, poses_only).path};
  recording.epoch = epoch;
  require_measurable(request, recording, from_s, to_s);
  describe_view(truth, recording);
  return recording;
}

RecordedMotion load_recorded_motion(const SynthRequest& request) {
  FaultLog faults;
  const Trajectory truth = eval::read_tum_ground_truth(request.trajectory_file, "imu", faults).trajectory;
  const std::vector<ImuSample> imu =
      datasets::read_imu_file(request.imu_file, eval::TimeUnit::kNanoseconds, faults);
  const Timestamp common = std::max(truth.poses.front().t, imu.front().t);
  const Timestamp epoch = after(common, std::max(request.start_s, kRecordingMargin_s));
  const Timestamp from = after(epoch, -kRecordingMargin_s),
                  to = after(epoch, request.seconds + kRecordingMargin_s);
  if (std::min(truth.poses.back().t, imu.back().t) < to) {
    throw InputError(
        request.trajectory_file.string(),
        fmt::format(
            "trajectory and IMU samples overlap for {:.1f} s, but {:.1f} s from {:.1f} s on are required; "
            "reduce --seconds or --start",
            seconds_between(common, std::min(truth.poses.back().t, imu.back().t)), request.seconds,
            request.start_s));
  }
  const std::vector<StampedPose> poses = between(truth.poses, from, to);
  const std::vector<ImuSample> readings = between(imu, from, to);
  return {smooth_motion({poses, readings, epoch, -kRecordingMargin_s, request.seconds + kRecordingMargin_s}),
          epoch, to_imu_record(readings), virtual_camera_T_b_c(mean_force(readings))};
}

}  // namespace stillpoint::synth
