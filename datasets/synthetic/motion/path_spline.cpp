// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/path_spline.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

/// Weights of a uniform B-spline of degree n by the recursion of Cox and de Boor; entries beyond n are 0.
std::array<double, 6> uniform_weights(double u, int degree) {
  std::array<double, 6> weights{1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (int n = 1; n <= degree; ++n) {
    std::array<double, 6> next{};
    for (int i = 0; i <= n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double rising = i > 0 ? (u + n - i) / n * weights[at - 1] : 0.0;
      const double falling = i < n ? (i + 1 - u) / n * weights[at] : 0.0;
      next[at] = rising + falling;
    }
    weights = next;
  }
  return weights;
}

/// Derivative of B-spline weights: differences of the weights of the next lower degree.
std::array<double, 6> difference(const std::array<double, 6>& lower) {
  std::array<double, 6> weights{};
  for (std::size_t i = 0; i < 6; ++i) weights[i] = (i > 0 ? lower[i - 1] : 0.0) - lower[i];
  return weights;
}

template <class Vector>
Vector blend(const std::vector<Vector>& points, std::size_t first, const std::array<double, 6>& weights) {
  Vector sum = Vector::Zero();
  for (std::size_t i = 0; i < 6; ++i) sum += weights[i] * points[first + i];
  return sum;
}

}  // namespace

std::array<double, 6> quintic_weights(double u, int derivative) {
  if (derivative == 0) return uniform_weights(u, 5);
  if (derivative == 1) return difference(uniform_weights(u, 4));
  return difference(difference(uniform_weights(u, 3)));
}

Eigen::Vector3d specific_force(const BodyMotion& motion) {
  return motion.T_w_b.q.conjugate() * (motion.acceleration_w + Eigen::Vector3d(0.0, 0.0, kGravity));
}

PathSpline::PathSpline(double start_s, double interval_s, std::vector<Eigen::Vector3d> positions,
                       std::vector<Eigen::Vector4d> attitudes)
    : start_s_(start_s),
      interval_s_(interval_s),
      positions_(std::move(positions)),
      attitudes_(std::move(attitudes)) {
  STILLPOINT_CHECK(positions_.size() >= 6 && attitudes_.size() == positions_.size() && interval_s_ > 0.0);
  for (std::size_t i = 1; i < attitudes_.size(); ++i) {
    if (attitudes_[i].dot(attitudes_[i - 1]) < 0.0) attitudes_[i] *= -1.0;
  }
}

double PathSpline::last_s() const {
  return start_s_ + interval_s_ * (static_cast<double>(positions_.size()) - 3.0);
}

PathSpline PathSpline::shifted(const Eigen::Vector3d& shift_w) const {
  PathSpline path = *this;
  for (Eigen::Vector3d& position : path.positions_) position += shift_w;
  return path;
}

PathSpline PathSpline::transformed(const Pose& T_v_w) const {
  PathSpline path = *this;
  for (Eigen::Vector3d& position : path.positions_) position = T_v_w.q * position + T_v_w.p;
  for (Eigen::Vector4d& attitude : path.attitudes_)
    attitude = (T_v_w.q * Eigen::Quaterniond(attitude)).coeffs();
  return path;
}

BodyMotion PathSpline::at(double t_s) const {
  const double last_span = static_cast<double>(positions_.size()) - 6.0;
  const double knots = std::clamp((t_s - first_s()) / interval_s_, 0.0, last_span + 1.0);
  const double span = std::min(std::floor(knots), last_span);
  const auto first = static_cast<std::size_t>(span);
  const std::array<double, 6> w0 = quintic_weights(knots - span, 0);
  const std::array<double, 6> w1 = quintic_weights(knots - span, 1);
  const std::array<double, 6> w2 = quintic_weights(knots - span, 2);
  const Eigen::Quaterniond raw(blend(attitudes_, first, w0));
  const Eigen::Quaterniond raw_rate(Eigen::Vector4d(blend(attitudes_, first, w1) / interval_s_));
  BodyMotion motion;
  motion.T_w_b = Pose{raw.normalized(), blend(positions_, first, w0)};
  motion.velocity_w = blend(positions_, first, w1) / interval_s_;
  motion.acceleration_w = blend(positions_, first, w2) / (interval_s_ * interval_s_);
  // q = r / |r|: d|r|/dt only affects the real part of conj(r) * dr/dt, so w_b = 2 / |r|^2 vec(conj(r)
  // dr/dt).
  motion.rate_b = 2.0 / raw.squaredNorm() * (raw.conjugate() * raw_rate).vec();
  return motion;
}

namespace {

struct AxisNoise {
  double rate_hz, density, walk, bias, phase;
};

Eigen::Vector3d normal3(RandomSequence& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

struct ReadingTimes {
  Timestamp first_stamp;  ///< of path time `from_s`
  double from_s, to_s;
};

template <class Ideal>
std::vector<datasets::VectorSample> simulate_readings(const Ideal& ideal, const AxisNoise& noise,
                                                      const ReadingTimes& times, RandomSequence random) {
  const auto& [first_stamp, from_s, to_s] = times;
  const double step_s = 1.0 / noise.rate_hz;
  const double white =
      noise.density * std::sqrt(noise.rate_hz);  // per-sample standard deviation: density / sqrt(dt)
  const double walk = noise.walk * std::sqrt(step_s);
  Eigen::Vector3d bias = noise.bias * normal3(random);
  std::vector<datasets::VectorSample> samples;
  for (int i = 0;; ++i) {
    const double since_start_s = (i + noise.phase) * step_s;
    if (from_s + since_start_s > to_s) return samples;
    const Eigen::Vector3d value = ideal(from_s + since_start_s) + bias + white * normal3(random);
    samples.push_back({after(first_stamp, since_start_s), value});
    bias += walk * normal3(random);
  }
}

}  // namespace

ImuRecord simulate_imu(const PathSpline& path, const ImuSensor& sensor, const ImuInterval& interval) {
  const Timestamp first_stamp = after(interval.epoch, interval.from_s + sensor.time_offset_s);
  const ReadingTimes times{first_stamp, interval.from_s, interval.to_s};
  const ImuNoise& noise = sensor.noise;
  const AxisNoise gyro{sensor.gyro_rate_hz, noise.gyro_noise, noise.gyro_walk, sensor.gyro_bias, 0.28};
  const AxisNoise accel{sensor.accel_rate_hz, noise.accel_noise, noise.accel_walk, sensor.accel_bias, 0.325};
  ImuRecord record;
  record.gyro = simulate_readings([&](double t_s) { return path.at(t_s).rate_b; }, gyro, times,
                                  RandomSequence(random_key(interval.seed, RandomStream::kGyro)));
  record.accel = simulate_readings([&](double t_s) { return specific_force(path.at(t_s)); }, accel, times,
                                   RandomSequence(random_key(interval.seed, RandomStream::kAccel)));
  return record;
}

}  // namespace stillpoint::synth
