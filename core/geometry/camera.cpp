// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr int kMaxNewtonSteps = 20;
constexpr double kNewtonTolerance = 1e-10;  // [normalized plane]

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;  // d point / d (x, y)
};

bool is_rational(const std::array<double, 8>& d) { return d[5] != 0.0 || d[6] != 0.0 || d[7] != 0.0; }

Distorted distort_radial_tangential(const std::array<double, 8>& d, const Eigen::Vector2d& m) {
  const double x = m.x(), y = m.y();
  const double r2 = x * x + y * y;
  double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  double slope = d[0] + r2 * (2.0 * d[1] + r2 * 3.0 * d[4]);  // d radial / d r2
  if (is_rational(d)) {
    const double denominator = 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
    radial /= denominator;
    slope = (slope - radial * (d[5] + r2 * (2.0 * d[6] + r2 * 3.0 * d[7]))) / denominator;
  }
  Distorted out;
  out.point << x * radial + 2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x),
      y * radial + d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y;
  const double mixed = 2.0 * x * y * slope + 2.0 * d[2] * x + 2.0 * d[3] * y;
  out.jacobian << radial + 2.0 * x * x * slope + 2.0 * d[2] * y + 6.0 * d[3] * x, mixed, mixed,
      radial + 2.0 * y * y * slope + 6.0 * d[2] * y + 2.0 * d[3] * x;
  return out;
}

double kannala_brandt_radius(const std::array<double, 8>& d, double theta) {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
}

double kannala_brandt_slope(const std::array<double, 8>& d, double theta) {
  const double t2 = theta * theta;
  return 1.0 + t2 * (3.0 * d[0] + t2 * (5.0 * d[1] + t2 * (7.0 * d[2] + t2 * 9.0 * d[3])));
}

Eigen::Vector2d undistort_radial_tangential(const std::array<double, 8>& d, const Eigen::Vector2d& target) {
  Eigen::Vector2d m = target;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Distorted now = distort_radial_tangential(d, m);
    const Eigen::Vector2d change = now.jacobian.inverse() * (target - now.point);
    m += change;
    if (change.norm() < kNewtonTolerance) break;
  }
  return m;
}

Eigen::Vector2d undistort_kannala_brandt(const std::array<double, 8>& d, const Eigen::Vector2d& target) {
  const double radius = target.norm();
  if (radius < kNewtonTolerance) return target;
  double theta = std::min(radius, 1.5);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const double change = (radius - kannala_brandt_radius(d, theta)) / kannala_brandt_slope(d, theta);
    theta += change;
    if (std::abs(change) < kNewtonTolerance) break;
  }
  return std::tan(theta) / radius * target;
}

}  // namespace

bool Camera::has_distortion() const {
  return model == CameraModel::kKannalaBrandt ||
         std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0.0; });
}

bool Camera::has_denominator() const {
  return model == CameraModel::kRadialTangential && is_rational(distortion);
}

std::span<const double> Camera::coefficients() const {
  return std::span<const double>(distortion).first(has_denominator() ? 8 : 5);
}

Eigen::Vector2d Camera::project(const Eigen::Vector3d& p_c) const {
  Eigen::Vector2d m(p_c.x() / p_c.z(), p_c.y() / p_c.z());
  if (model == CameraModel::kKannalaBrandt) {
    const double radius = m.norm();
    if (radius > kNewtonTolerance) m *= kannala_brandt_radius(distortion, std::atan(radius)) / radius;
  } else if (has_distortion()) {
    m = distort_radial_tangential(distortion, m).point;
  }
  return {fx * m.x() + cx, fy * m.y() + cy};
}

Eigen::Vector2d Camera::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d m((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (model == CameraModel::kKannalaBrandt) return undistort_kannala_brandt(distortion, m);
  return has_distortion() ? undistort_radial_tangential(distortion, m) : m;
}

}  // namespace stillpoint
