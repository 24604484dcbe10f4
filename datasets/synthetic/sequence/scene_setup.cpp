// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/scene_setup.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/scenes/mesh_scene.h"
#include "datasets/synthetic/sequence/populate_scene.h"
#include "datasets/synthetic/sequence/recorded_motion.h"
#include "datasets/synthetic/sequence/request_rig.h"

namespace stillpoint::synth {
namespace {

constexpr std::int64_t kEpoch_ns = 1700000000LL * 1000000000LL;
constexpr double kFirstFrame_s = 0.05;      // IMU samples start this long before the first frame
constexpr double kTail_s = 0.05;            // and end this long after the last frame
constexpr double kTruthInterval_s = 0.005;  // 200 Hz
constexpr int kMaxDropRun = 4;              // longest run of consecutive dropped frames

HandMotion hand_motion_of(const std::string& preset) {
  if (preset.starts_with("walking_static")) return HandMotion::kStatic;
  if (preset.starts_with("walking_rpy")) return HandMotion::kRpy;
  if (preset.starts_with("walking_halfsphere")) return HandMotion::kHalfsphere;
  return HandMotion::kXyz;
}

double last_path_time(const SynthRequest& request) { return kFirstFrame_s + request.seconds + kTail_s; }

Scene scene_of(const SynthRequest& request) {
  constexpr double kLongAisle_m = 8.0, kShortAisle_m = 4.0;
  if (is_preset(request, "office_laps")) return build_large_office(request.seed);
  if (is_preset(request, "twin_aisles"))
    return build_twin_aisles(request.seed, is_short(request) ? kShortAisle_m : kLongAisle_m);
  if (is_preset(request, "changed_room")) return build_changed_room(request.seed);
  if (is_preset(request, "market_laps")) return build_market_laps(request.seed);
  if (is_preset(request, "corridor_laps")) return build_corridor_laps(request.seed);
  if (request.preset.starts_with("market")) return build_market(request.seed);
  if (request.preset.starts_with("corridor")) return build_corridor(request.seed);
  return build_office(request.seed);
}

std::vector<Pose> camera_poses(const PathSpline& path, const Pose& T_b_c) {
  constexpr double kInterval_s = 0.05;
  std::vector<Pose> poses;
  for (double t_s = path.first_s(); t_s < path.last_s(); t_s += kInterval_s)
    poses.push_back(path.pose_at(t_s) * T_b_c);
  return poses;
}

std::vector<Eigen::Vector3d> camera_positions(const PathSpline& path, const Pose& T_b_c) {
  std::vector<Eigen::Vector3d> positions;
  for (const Pose& T_w_c : camera_poses(path, T_b_c)) positions.push_back(T_w_c.p);
  return positions;
}

/// The motion of the body, and the scene through which it moves.
struct MovingBody {
  Scene scene;
  PathSpline path;
  Timestamp epoch{kEpoch_ns};
};

MovingBody simulated_motion(const SynthRequest& request, const PathRequest& path) {
  Scene scene = scene_of(request);
  const bool by_hand = request.preset.starts_with("walking");
  PathSpline spline = by_hand ? hand_path(hand_motion_of(request.preset), scene.viewpoint, path)
                              : robot_path(scene.route, path);
  return {std::move(scene), std::move(spline)};
}

/// The home is built around the whole tour, so that it does not depend on the duration.
MovingBody home_motion(const SynthRequest& request, const PathRequest& path) {
  RobotTrack track = load_home_track(request.trajectory_file);
  const double whole_s = track.poses.back().t_s;
  if (whole_s < request.start_s + path.to_s) {
    throw InputError("preset \"home_tour\"",
                     fmt::format("the tour takes {:.1f} s, but {:.1f} s from {:.1f} s on "
                                 "are required; reduce --seconds or --start",
                                 whole_s, request.seconds, request.start_s));
  }
  PathRequest whole = path;
  whole.to_s = whole_s;
  Scene scene =
      build_home(request.seed, camera_positions(robot_path(track, whole), path.T_b_c), home_walking_routes());
  for (PlanarPose& pose : track.poses) pose.t_s -= request.start_s;
  return {std::move(scene), robot_path(track, path)};
}

/// A hall around the part of a recorded track that is rendered.
MovingBody track_motion(const SynthRequest& request, const PathRequest& path) {
  RecordedTrack recorded = load_track(request.trajectory_file, request.track_sequence);
  const double whole_s = recorded.track.poses.back().t_s;
  if (whole_s < request.start_s + path.to_s) {
    throw InputError("preset \"track\"",
                     fmt::format("the sequence takes {:.1f} s, but {:.1f} s from {:.1f} s on "
                                 "are required; reduce --seconds or --start",
                                 whole_s, request.seconds, request.start_s));
  }
  for (PlanarPose& pose : recorded.track.poses) pose.t_s -= request.start_s;
  PathSpline spline = robot_path(recorded.track, path);
  Scene scene = build_hall(request.seed, camera_positions(spline, path.T_b_c));
  return {std::move(scene), std::move(spline), after(recorded.first, request.start_s)};
}

/// The recorded motion in the office: its mean camera position is that of simulated hand-held cameras, and
/// its mean direction points to their target.
MovingBody hand_recording_motion(const SynthRequest& request, const PathRequest& path) {
  HandRecording recording = load_hand_recording(request, path, kFirstFrame_s);
  Scene scene = scene_of(request);
  const Viewpoint& view = scene.viewpoint;
  const Eigen::Vector3d direction = view.target_w - view.eye_w;
  const double turn = std::atan2(direction.y(), direction.x()) - recording.mean_yaw;
  Pose T_w_m;  // m: frame of the motion capture system
  T_w_m.q = Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  T_w_m.p = view.eye_w - T_w_m.q * recording.mean_eye_w;
  return {std::move(scene), recording.body_path.transformed(T_w_m), recording.epoch};
}

/// The mesh must have the unit of the path: the meter.
/// @throws InputError for a mesh of 100 m or more in which the whole path is shorter than a hundredth of it,
/// as of a room in centimeters
void require_same_unit(const std::filesystem::path& file, const StaticMesh& mesh, double extent_m) {
  constexpr double kLarge_m = 100.0, kMinFraction = 0.01;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  const auto size_m = static_cast<double>(box.sizes().maxCoeff());
  if (size_m < kLarge_m || extent_m >= kMinFraction * size_m) return;
  throw InputError(
      file.string(),
      fmt::format("is {:.0f} m long, but the whole path of the camera {:.2g} m, so that the mesh "
                  "is probably in centimeters or millimeters; scale it to meters",
                  size_m, extent_m));
}

/// A scanned scene with the path of the camera in its frame.
MovingBody mesh_motion(const SynthRequest& request, const PathRequest& path) {
  HandRecording recording = load_hand_recording(request, path, kFirstFrame_s);
  Scene scene = build_mesh_scene(request.mesh_file, camera_poses(recording.body_path, path.T_b_c));
  require_same_unit(request.mesh_file, scene.world.mesh, recording.extent_m);
  return {std::move(scene), std::move(recording.body_path), recording.epoch};
}

MovingBody motion_of(const SynthRequest& request, const PathRequest& path) {
  if (is_mesh(request)) return mesh_motion(request, path);
  if (is_hand_recording(request)) return hand_recording_motion(request, path);
  if (request.preset == "home_tour") return home_motion(request, path);
  if (request.preset == "track") return track_motion(request, path);
  return simulated_motion(request, path);
}

/// Path time at which the camera first enters the part of the floor from which a change is not visible.
double time_of_change(const SceneChange& change, const CameraMotion& camera) {
  constexpr double kInterval_s = 0.05;
  for (double t_s = camera.from_s; t_s < camera.to_s; t_s += kInterval_s) {
    const Eigen::Vector2d at = camera.camera_at(t_s);
    if ((at.array() >= change.away_low.array()).all() && (at.array() <= change.away_high.array()).all())
      return t_s;
  }
  return std::numeric_limits<double>::infinity();
}

SceneSetup simulated_setup(const SynthRequest& request) {
  const Rig rig = rig_of(request);
  const double last_s = last_path_time(request);
  const PathRequest path_request{rig.T_b_c, request.seed, 0.0, last_s};
  auto [scene, path, motion_epoch] = motion_of(request, path_request);
  const Timestamp epoch =
      request.times_file.empty() || is_hand_recording(request) || is_mesh(request)
          ? motion_epoch
          : after(load_recorded_times(request.times_file, request.seconds).color.front(), -kFirstFrame_s);
  ImuRecord imu = simulate_imu(path, request.imu, {epoch, 0.0, last_s, request.seed});
  const CameraMotion camera{[&path = path, &rig](double t_s) {
                              return Eigen::Vector2d((path.pose_at(t_s) * rig.T_b_c).p.head<2>());
                            },
                            0.0, last_s};
  std::vector<Actor> actors = populate_scene(request, scene, camera);
  double change_s = std::numeric_limits<double>::infinity();
  if (scene.change) {
    scene.change->world.textures = scene.world.textures;  // those of the actors included
    change_s = time_of_change(*scene.change, camera);
  }
  return {std::move(scene), std::move(path),   rig,     epoch, kFirstFrame_s,
          std::move(imu),   std::move(actors), change_s};
}

SceneSetup recorded_setup(const SynthRequest& request) {
  RecordedMotion motion = load_recorded_motion(request);
  Rig rig = rig_of(request);
  rig.T_b_c = motion.T_b_c;
  rig.imu_noise = ImuNoise{};  // real sensor on a vibrating body: the conservative defaults of core/types
  const Eigen::Vector3d shift = hall_shift(camera_positions(motion.smoothed.path, rig.T_b_c));
  PathSpline path = motion.smoothed.path.shifted(shift);
  Scene scene = build_hall(request.seed, camera_positions(path, rig.T_b_c));
  return {std::move(scene), std::move(path), rig, motion.epoch, 0.0, std::move(motion.readings), {}};
}

/// File names contain microseconds.
Timestamp whole_microseconds(Timestamp epoch, double since_epoch_s) {
  return {epoch.ns / 1000 * 1000 + std::llround(since_epoch_s * 1e6) * 1000};
}

}  // namespace

SceneSetup make_scene_setup(const SynthRequest& request) {
  return request.preset == "flight" ? recorded_setup(request) : simulated_setup(request);
}

FrameTimes frame_times(const SynthRequest& request, const SceneSetup& setup) {
  const Timestamp first = whole_microseconds(setup.epoch, setup.first_frame_s);
  if (!request.times_file.empty()) return load_recorded_times(request.times_file, request.seconds, first);
  RandomSequence random(random_key(request.seed, RandomStream::kDroppedFrames));
  // A run has (1 + kMaxDropRun) / 2 frames on average.
  const double start_chance =
      request.dropped_fraction / (0.5 * (1 + kMaxDropRun)) / (1.0 - request.dropped_fraction);
  const int count = static_cast<int>(std::floor(request.seconds * request.frames_per_s));
  std::vector<Timestamp> times;
  int to_drop = 0;
  for (int i = 0; i < count; ++i) {
    if (to_drop == 0 && i > 0 && random.chance(start_chance)) to_drop = 1 + random.index(kMaxDropRun);
    if (to_drop > 0) {
      --to_drop;
      continue;
    }
    times.push_back(whole_microseconds(setup.epoch, setup.first_frame_s + i / request.frames_per_s));
  }
  return {times, times};
}

Exposure exposure_at(const SynthRequest& request, const SceneSetup& setup, Timestamp t, double span_s) {
  const double middle_s = seconds_between(setup.epoch, t);
  const int rows = request.rolling_shutter_s > 0.0 ? request.height : 1;
  Exposure exposure;
  exposure.span_s = static_cast<float>(span_s);
  exposure.exposure_fraction_of_span = static_cast<float>(request.color.exposure_s / span_s);
  for (int row = 0; row < rows; ++row) {
    const double delay_s = rows > 1 ? request.rolling_shutter_s * (row / (rows - 1.0) - 0.5) : 0.0;
    std::array<Pose, kLightSamples> poses;
    for (int sample = 0; sample < kLightSamples; ++sample) {
      const double t_s = middle_s + delay_s + sample_time_offset(sample) * request.color.exposure_s;
      poses[static_cast<std::size_t>(sample)] = setup.body_path.pose_at(t_s) * setup.rig.T_b_c;
    }
    exposure.poses.push_back(poses);
    exposure.mid_times.push_back(static_cast<float>(0.5 + delay_s / span_s));
  }
  return exposure;
}

Trajectory camera_ground_truth(const SynthRequest& request, const SceneSetup& setup,
                               const std::vector<Timestamp>& color_times) {
  std::set<Timestamp> times(color_times.begin(), color_times.end());
  const double last_s = setup.first_frame_s + request.seconds + kTail_s;
  for (int i = 0;; ++i) {
    const double t_s = setup.first_frame_s - kFirstFrame_s + i * kTruthInterval_s;
    if (t_s > last_s) break;
    times.insert(whole_microseconds(setup.epoch, t_s));
  }
  Trajectory truth{"camera", {}};
  for (const Timestamp t : times) {
    truth.poses.push_back({t, setup.body_path.pose_at(seconds_between(setup.epoch, t)) * setup.rig.T_b_c});
  }
  return truth;
}

}  // namespace stillpoint::synth
