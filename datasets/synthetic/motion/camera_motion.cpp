// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/camera_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;

constexpr double kStep_m = 0.02;
constexpr double kStartFraction = 0.15;  // of the first side
constexpr double kTurn = 2.0 * std::numbers::pi;

double angle_between(const Vector2d& a, const Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// Points of the arc that rounds a corner.
std::vector<Vector2d> arc(const Vector2d& corner, const Vector2d& in, const Vector2d& out, double radius) {
  const double angle = angle_between(in, out);
  const double reach = radius * std::tan(0.5 * std::abs(angle));
  const Vector2d side = (angle > 0.0 ? 1.0 : -1.0) * Vector2d(-in.y(), in.x());
  const Vector2d start = corner - reach * in;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(angle) * radius / kStep_m)));
  std::vector<Vector2d> points;
  for (int i = 0; i <= steps; ++i) {
    const double turned = std::abs(angle) * i / steps;
    points.push_back(start + radius * (std::sin(turned) * in + (1.0 - std::cos(turned)) * side));
  }
  return points;
}

void add_straight(std::vector<Vector2d>& points, const Vector2d& to) {
  const Vector2d from = points.back();
  const int steps = static_cast<int>((to - from).norm() / kStep_m);
  for (int i = 1; i < steps; ++i) points.push_back(from + (to - from) * (static_cast<double>(i) / steps));
}

std::vector<Vector2d> rounded(const std::vector<Vector2d>& corners, double radius_m) {
  const std::size_t count = corners.size();
  const auto corner = [&](std::size_t i) { return corners[i % count]; };
  const auto side = [&](std::size_t i) { return Vector2d(corner(i + 1) - corner(i)); };
  std::vector<Vector2d> points{corner(0) + kStartFraction * side(0)};
  for (std::size_t i = 1; i <= count; ++i) {
    const Vector2d in = side(i - 1).normalized(), out = side(i).normalized();
    const double shorter = std::min(side(i - 1).norm(), side(i).norm());
    const double half_angle_tan = std::tan(0.5 * std::abs(angle_between(in, out)));
    // At most half of a side; at the first corner at most the distance from the corner to the start.
    const double reach = (i == count ? 0.9 * kStartFraction : 0.499) * shorter;
    const std::vector<Vector2d> turn =
        arc(corner(i), in, out, std::min(radius_m, reach / std::max(half_angle_tan, 1e-9)));
    add_straight(points, turn.front());
    points.insert(points.end(), turn.begin(), turn.end());
  }
  add_straight(points, points.front());
  points.push_back(points.front());
  return points;
}

}  // namespace

ClosedRoute::ClosedRoute(const std::vector<Vector2d>& corners, double radius_m) {
  STILLPOINT_CHECK(corners.size() >= 3);
  for (const Vector2d& point : rounded(corners, radius_m)) {
    const double step = points_.empty() ? 0.0 : (point - points_.back()).norm();
    if (!points_.empty() && step < 1e-6) continue;
    distances_.push_back(points_.empty() ? 0.0 : distances_.back() + step);
    points_.push_back(point);
  }
  double heading = 0.0;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vector2d step = points_[i + 1] - points_[i];
    heading += std::remainder(std::atan2(step.y(), step.x()) - heading, kTurn);
    headings_.push_back(heading);
  }
  headings_.push_back(heading + std::remainder(headings_.front() - heading, kTurn));
}

ClosedRoute::RoutePoint ClosedRoute::at(double distance_m) const {
  const double lap = std::floor(distance_m / length_m());
  const double along = distance_m - lap * length_m();
  const auto next = std::upper_bound(distances_.begin() + 1, distances_.end() - 1, along);
  const auto i = static_cast<std::size_t>(next - distances_.begin()) - 1;
  const double step = distances_[i + 1] - distances_[i];
  const double fraction = (along - distances_[i]) / step;
  const double turn = headings_[i + 1] - headings_[i];
  return {points_[i] + fraction * (points_[i + 1] - points_[i]),
          headings_[i] + fraction * turn + lap * (headings_.back() - headings_.front()),
          std::abs(turn) / step};
}

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kKnotInterval_s = 0.01;
constexpr double kRampLength_s = 2.0;
constexpr double kRampStart = 0.4;

struct Sine {
  double amplitude, angular_rate, phase;
};

/// One degree of freedom: a slow sinusoid, a faster one, and two of tremor.
using Channel = std::vector<Sine>;

/// Amplitude, base frequency and tremor amplitude of three channels.
struct Swing {
  std::array<double, 3> amplitude;
  std::array<double, 3> frequency_hz;
  double tremor;
};

double value(const Channel& channel, double t_s, double envelope) {
  double sum = 0.0;
  for (const Sine& sine : channel) {
    const bool tremor = sine.angular_rate > 2.0 * kPi * 5.0;
    sum += (tremor ? 1.0 : envelope) * sine.amplitude * std::sin(sine.angular_rate * t_s + sine.phase);
  }
  return sum;
}

Channel make_channel(double amplitude, double frequency_hz, double tremor, RandomSequence& random) {
  const auto sine = [&random](double size, double hz) {
    return Sine{size, 2.0 * kPi * hz * random.uniform(0.9, 1.1), random.uniform(0.0, 2.0 * kPi)};
  };
  // Physiological tremor lies at 6-12 Hz (Stiles and Randall 1967).
  return {sine(0.75 * amplitude, frequency_hz), sine(0.25 * amplitude, 2.3 * frequency_hz), sine(tremor, 6.5),
          sine(0.6 * tremor, 10.0)};
}

std::array<Channel, 3> make_channels(const Swing& swing, RandomSequence& random) {
  std::array<Channel, 3> channels;
  for (std::size_t i = 0; i < 3; ++i) {
    channels[i] = make_channel(swing.amplitude[i], swing.frequency_hz[i], swing.tremor, random);
  }
  return channels;
}

/// Parameters of one motion: translation right, up, forward [m]; yaw, pitch, roll [rad].
struct MotionSize {
  Swing translation;
  Swing rotation;
};

MotionSize size_of(HandMotion motion) {
  constexpr double kTremor_m = 0.0002;
  constexpr double kTremor_rad = 0.04 * kDegree;
  const Swing steady_turn{{3.0 * kDegree, 3.0 * kDegree, 2.0 * kDegree}, {0.23, 0.31, 0.19}, kTremor_rad};
  switch (motion) {
    case HandMotion::kXyz:
      return {{{0.32, 0.22, 0.28}, {0.21, 0.27, 0.17}, kTremor_m}, steady_turn};
    case HandMotion::kStatic:
      return {{{0.006, 0.005, 0.006}, {0.30, 0.37, 0.26}, kTremor_m},
              {{0.6 * kDegree, 0.5 * kDegree, 0.4 * kDegree}, {0.33, 0.41, 0.29}, kTremor_rad}};
    case HandMotion::kRpy:
      return {{{0.05, 0.04, 0.05}, {0.28, 0.33, 0.24}, kTremor_m},
              {{26.0 * kDegree, 16.0 * kDegree, 24.0 * kDegree}, {0.21, 0.27, 0.24}, kTremor_rad}};
    case HandMotion::kHalfsphere:  // translation: azimuth [rad], elevation [rad], radius [m]
      return {{{50.0 * kDegree, 14.0 * kDegree, 0.18}, {0.055, 0.11, 0.16}, kTremor_m}, steady_turn};
  }
  return {};
}

struct ViewAngles {
  double yaw, pitch;
};

ViewAngles look_along(const Eigen::Vector3d& direction_w) {
  return {std::atan2(direction_w.y(), direction_w.x()),
          std::atan2(-direction_w.z(), direction_w.head<2>().norm())};
}

double envelope_at(double seconds_from_start) {
  const double fraction = std::clamp(seconds_from_start / kRampLength_s, 0.0, 1.0);
  const double smooth =
      fraction * fraction * fraction * (10.0 - fraction * (15.0 - 6.0 * fraction));  // C2 at both ends
  return kRampStart + (1.0 - kRampStart) * smooth;
}

/// Camera position of all motions but the half-sphere: the eye, shifted along the mean camera axes.
Eigen::Vector3d shifted_eye(const Viewpoint& view, const Eigen::Vector3d& right_up_forward) {
  const Eigen::Vector3d forward = (view.target_w - view.eye_w).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  return view.eye_w + right_up_forward.x() * right + right_up_forward.y() * right.cross(forward) +
         right_up_forward.z() * forward;
}

/// Camera position of the half-sphere motion: spherical coordinates around the target, relative to the eye.
Eigen::Vector3d circled_eye(const Viewpoint& view, const Eigen::Vector3d& azimuth_elevation_radius) {
  const Eigen::Vector3d from_target = view.eye_w - view.target_w;
  const double azimuth = std::atan2(from_target.y(), from_target.x()) + azimuth_elevation_radius.x();
  const double elevation =
      std::atan2(from_target.z(), from_target.head<2>().norm()) + azimuth_elevation_radius.y();
  const double radius = from_target.norm() + azimuth_elevation_radius.z();
  return view.target_w + radius * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                  std::cos(elevation) * std::sin(azimuth),
                                                  std::sin(elevation));
}

}  // namespace

Eigen::Quaterniond camera_attitude(double yaw, double pitch, double roll) {
  Eigen::Matrix3d R_level_c;  // camera axes in a body with x forward and z up
  R_level_c << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()) * Eigen::Quaterniond(R_level_c);
}

PathSpline hand_path(HandMotion motion, const Viewpoint& view, const PathRequest& request) {
  const Pose& T_b_c = request.T_b_c;
  const double from_s = request.from_s, to_s = request.to_s;
  RandomSequence random(random_key(request.seed, RandomStream::kMotion, static_cast<std::uint64_t>(motion)));
  const MotionSize size = size_of(motion);
  const std::array<Channel, 3> translation = make_channels(size.translation, random);
  const std::array<Channel, 3> rotation = make_channels(size.rotation, random);
  const bool circles = motion == HandMotion::kHalfsphere;

  const auto camera_pose = [&](double t_s) {
    const double envelope = envelope_at(t_s - from_s);
    Eigen::Vector3d shift, turn;
    for (int i = 0; i < 3; ++i) {
      shift[i] = value(translation[static_cast<std::size_t>(i)], t_s, circles ? 1.0 : envelope);
      turn[i] = value(rotation[static_cast<std::size_t>(i)], t_s, envelope);
    }
    const Eigen::Vector3d eye = circles ? circled_eye(view, shift) : shifted_eye(view, shift);
    const ViewAngles look = look_along(view.target_w - (circles ? eye : view.eye_w));
    return Pose{camera_attitude(look.yaw + turn.x(), look.pitch + turn.y(), turn.z()), eye};
  };
  return spline_of([&](double t_s) { return camera_pose(t_s) * T_b_c.inverse(); }, from_s, to_s,
                   kKnotInterval_s);
}

namespace {

constexpr double kStep_s = 0.01;       // integration step of the driven distance
constexpr double kSmoothing_s = 0.15;  // knot interval of the path without vibration
constexpr double kVibration_s = 0.01;  // knot interval of the final path
constexpr double kLookAhead_m = 0.6;   // the robot slows down before turns
constexpr double kVibration_m = 0.0004;
constexpr double kVibration_rad = 0.1 * std::numbers::pi / 180.0;
constexpr double kTrackStep_s = 0.05;  // of the resampled track
constexpr double kKernelReach = 3.0;   // of the Gaussian, in standard deviations

/// Speed allowed by the route's curvature, averaged over +-kLookAhead_m.
double speed_at(const ClosedRoute& closed_route, const RobotRoute& route, double distance_m) {
  constexpr int kSamples = 13;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double distance = distance_m + kLookAhead_m * (2.0 * i / (kSamples - 1) - 1.0);
    sum += std::min(route.speed, route.turn_rate / std::max(closed_route.at(distance).curvature, 1e-6));
  }
  return sum / kSamples;
}

/// Distance driven at each multiple of kStep_s.
std::vector<double> drive(const ClosedRoute& closed_route, const RobotRoute& route, double start_m,
                          double duration_s) {
  std::vector<double> distances{start_m};
  for (int i = 0; i * kStep_s < duration_s; ++i) {
    distances.push_back(distances.back() + kStep_s * speed_at(closed_route, route, distances.back()));
  }
  return distances;
}

/// Vibration relative to the smooth path.
class Vibration {
 public:
  explicit Vibration(RandomSequence& random) {
    for (Wave& wave : waves_) {
      wave = {2.0 * std::numbers::pi * random.uniform(7.0, 17.0),
              random.uniform(0.0, 2.0 * std::numbers::pi)};
    }
  }
  [[nodiscard]] Pose at(double t_s) const {
    const auto wave = [&](std::size_t i) { return std::sin(waves_[i].rate * t_s + waves_[i].phase); };
    return {exp_so3(kVibration_rad * Eigen::Vector3d(wave(0), wave(1), wave(2))),
            kVibration_m * Eigen::Vector3d(wave(3), wave(4), wave(5))};
  }

 private:
  struct Wave {
    double rate, phase;
  };
  std::array<Wave, 6> waves_;
};

/// The path of the body for a camera without vibration: a function of time.
template <class LevelCamera>
PathSpline vibrating_path(const LevelCamera& level_camera, const Vibration& vibration,
                          const PathRequest& request) {
  const Pose& T_b_c = request.T_b_c;
  const double from_s = request.from_s, to_s = request.to_s;
  const PathSpline smooth = spline_of(level_camera, from_s - 0.1, to_s + 0.1, kSmoothing_s);
  return spline_of([&](double t_s) { return smooth.pose_at(t_s) * vibration.at(t_s) * T_b_c.inverse(); },
                   from_s, to_s, kVibration_s);
}

/// A track with uniform intervals, filtered by a Gaussian kernel.
class FilteredTrack {
 public:
  FilteredTrack(std::span<const PlanarPose> poses, double sigma_s)
      : start_s_(poses.front().t_s), sigma_s_(sigma_s) {
    std::size_t i = 0;
    for (int k = 0;; ++k) {
      const double t_s = start_s_ + k * kTrackStep_s;
      while (i + 2 < poses.size() && poses[i + 1].t_s <= t_s) ++i;
      const PlanarPose &low = poses[i], &high = poses[i + 1];
      const double fraction = std::clamp((t_s - low.t_s) / (high.t_s - low.t_s), 0.0, 1.0);
      samples_.push_back({t_s, low.position + fraction * (high.position - low.position),
                          std::lerp(low.heading, high.heading, fraction)});
      if (t_s > poses.back().t_s) return;
    }
  }
  [[nodiscard]] PlanarPose at(double t_s) const {
    const int last = static_cast<int>(samples_.size()) - 1;
    const int reach = static_cast<int>(kKernelReach * sigma_s_ / kTrackStep_s);
    const int middle = static_cast<int>(std::lround((t_s - start_s_) / kTrackStep_s));
    PlanarPose mean{t_s, Eigen::Vector2d::Zero(), 0.0};
    double sum = 0.0;
    for (int k = middle - reach; k <= middle + reach; ++k) {
      const PlanarPose& sample = samples_[static_cast<std::size_t>(std::clamp(k, 0, last))];
      const double distance = (start_s_ + k * kTrackStep_s - t_s) / sigma_s_;
      const double weight = std::exp(-0.5 * distance * distance);
      mean.position += weight * sample.position;
      mean.heading += weight * sample.heading;
      sum += weight;
    }
    return {t_s, mean.position / sum, mean.heading / sum};
  }

 private:
  std::vector<PlanarPose> samples_;
  double start_s_, sigma_s_;
};

}  // namespace

PathSpline robot_path(const RobotRoute& route, const PathRequest& request) {
  const double from_s = request.from_s, to_s = request.to_s;
  RandomSequence random(random_key(request.seed, RandomStream::kMotion, 100));
  const ClosedRoute closed_route(route.corners, route.turn_radius_m);
  const double lead_s = 6.0 * kSmoothing_s;  // margin for the control points beyond both ends
  const std::vector<double> distances =
      drive(closed_route, route, random.uniform(0.0, 2.0), to_s - from_s + 2.0 * lead_s);
  const Vibration vibration(random);
  const auto level_camera = [&](double t_s) {
    const double step =
        std::clamp((t_s - from_s + lead_s) / kStep_s, 0.0, static_cast<double>(distances.size()) - 1.0);
    const ClosedRoute::RoutePoint point =
        closed_route.at(distances[static_cast<std::size_t>(std::lround(step))]);
    return Pose{camera_attitude(point.heading, 0.0, 0.0),
                {point.position.x(), point.position.y(), route.camera_height_m}};
  };
  return vibrating_path(level_camera, vibration, request);
}

PathSpline robot_path(const RobotTrack& track, const PathRequest& request) {
  STILLPOINT_CHECK(track.poses.size() >= 2);
  RandomSequence random(random_key(request.seed, RandomStream::kMotion, 101));
  const Vibration vibration(random);
  const FilteredTrack filtered(track.poses, track.smoothing_s);
  const auto level_camera = [&](double t_s) {
    const PlanarPose base = filtered.at(t_s);
    const Eigen::Vector2d forward(std::cos(base.heading), std::sin(base.heading));
    const Eigen::Vector2d position = base.position + track.camera_forward_m * forward;
    return Pose{camera_attitude(base.heading, 0.0, 0.0), {position.x(), position.y(), track.camera_height_m}};
  };
  return vibrating_path(level_camera, vibration, request);
}

}  // namespace stillpoint::synth
