// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/imu/real_rotation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <fstream>
#include <span>
#include <sstream>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kHalfFit = 0.05;                    // [s]
constexpr double kMaxGap = 0.02;                     // [s]
constexpr double kMaxResidual = 0.2 * M_PI / 180.0;  // [rad] RMS

/// Parses e.g. "12.000000034" without rounding to double.
Timestamp parse_seconds(const std::string& text) {
  const std::size_t point = text.find('.');
  const std::int64_t whole = std::stoll(text.substr(0, point));
  return {whole * 1'000'000'000 + std::llround(std::stod(text.substr(point)) * 1e9)};
}

bool has_gap(std::span<const StampedPose> poses) {
  const auto far_apart = [](const StampedPose& a, const StampedPose& b) {
    return seconds_between(a.t, b.t) > kMaxGap;
  };
  return std::adjacent_find(poses.begin(), poses.end(), far_apart) != poses.end();
}

/// Parabola of rotation vectors relative to `q_w_reference`; rows of `coefficients`: 1, x, x^2 with
/// x = (t - t0) / kHalfFit.
struct AttitudeFit {
  Eigen::Matrix3d coefficients;
  double residual_rms;
};
AttitudeFit fit_parabola(std::span<const StampedPose> poses, const Eigen::Quaterniond& q_w_reference,
                         Timestamp t0) {
  const auto basis = [t0](const StampedPose& pose) {
    const double x = seconds_between(t0, pose.t) / kHalfFit;
    return Eigen::Vector3d(1.0, x, x * x);
  };
  const auto value = [&](const StampedPose& pose) -> Eigen::Vector3d {
    return log_so3(q_w_reference.conjugate() * pose.T_w_f.q);
  };
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
  for (const StampedPose& pose : poses) {
    normal += basis(pose) * basis(pose).transpose();
    right += basis(pose) * value(pose).transpose();
  }
  AttitudeFit fit{.coefficients = normal.ldlt().solve(right), .residual_rms = 0.0};
  for (const StampedPose& pose : poses) {
    fit.residual_rms += (value(pose) - fit.coefficients.transpose() * basis(pose)).squaredNorm();
  }
  fit.residual_rms = std::sqrt(fit.residual_rms / static_cast<double>(poses.size()));
  return fit;
}

}  // namespace

ImuBuffer read_imu_csv(const std::filesystem::path& path) {
  ImuBuffer buffer;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    ImuSample sample;
    fields >> sample.t.ns >> sample.gyro_b.x() >> sample.gyro_b.y() >> sample.gyro_b.z();
    fields >> sample.accel_b.x() >> sample.accel_b.y() >> sample.accel_b.z();
    buffer.add(sample);
  }
  return buffer;
}

std::vector<StampedPose> read_tum_poses(const std::filesystem::path& path) {
  std::vector<StampedPose> poses;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream fields(line);
    std::string stamp;
    Pose pose;
    fields >> stamp >> pose.p.x() >> pose.p.y() >> pose.p.z();
    fields >> pose.q.x() >> pose.q.y() >> pose.q.z() >> pose.q.w();
    pose.q.normalize();
    poses.push_back({parse_seconds(stamp), pose});
  }
  return poses;
}

std::optional<Eigen::Quaterniond> reliable_attitude(const std::vector<StampedPose>& truth, Timestamp t) {
  const auto earlier = [](const StampedPose& pose, Timestamp stamp) { return pose.t < stamp; };
  const auto first = std::lower_bound(truth.begin(), truth.end(), after(t, -kHalfFit), earlier);
  const auto last = std::lower_bound(first, truth.end(), after(t, kHalfFit), earlier);
  if (first == truth.begin() || last == truth.end()) return std::nullopt;
  const std::span<const StampedPose> surroundings(first - 1, last + 1);  // includes one pose beyond each end
  if (has_gap(surroundings)) return std::nullopt;

  const Eigen::Quaterniond q_w_reference = surroundings[surroundings.size() / 2].T_w_f.q;
  const AttitudeFit fit = fit_parabola(surroundings, q_w_reference, t);
  if (fit.residual_rms > kMaxResidual) return std::nullopt;
  return q_w_reference * exp_so3(fit.coefficients.row(0).transpose());
}

std::vector<RotationWindow> rotation_windows(ImuBuffer& imu, const std::vector<StampedPose>& truth,
                                             double length_s) {
  std::vector<RotationWindow> windows;
  for (Timestamp begin = truth.front().t; begin < truth.back().t; begin = after(begin, length_s)) {
    const Timestamp end = after(begin, length_s);
    const std::optional<Eigen::Quaterniond> q_w_bi = reliable_attitude(truth, begin);
    const std::optional<Eigen::Quaterniond> q_w_bj = reliable_attitude(truth, end);
    std::vector<ImuSample> samples = imu.samples_between(begin, end);
    if (!q_w_bi || !q_w_bj || samples.empty()) continue;
    windows.push_back({begin, std::move(samples), q_w_bi->conjugate() * *q_w_bj});
  }
  return windows;
}

}  // namespace stillpoint
