// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/home_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/base/error.h"
#include "eval/io/openloris_file.h"

namespace stillpoint::synth {
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

std::filesystem::path home_ground_truth_file() {
  const char* set = std::getenv("STILLPOINT_DATA");
  const std::filesystem::path data = set != nullptr ? set : "../shared/data";
  return data / "openloris" / "groundtruth" / "gt_home_1.txt";
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

}  // namespace stillpoint::synth
