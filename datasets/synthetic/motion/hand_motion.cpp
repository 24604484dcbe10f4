// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/hand_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
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

}  // namespace stillpoint::synth
