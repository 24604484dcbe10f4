// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/simulated/nees_simulation.h"

#include <Eigen/Cholesky>

#include "core/backend/estimator.h"
#include "core/backend/factors/gravity_direction.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kRate_hz = 30.0;
constexpr double kGyroBiasSigma = 0.01;   // [rad/s]
constexpr double kAccelBiasSigma = 0.05;  // [m/s^2]

Eigen::Vector3d draw_vector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

SimulatedMotion draw_motion(const NeesDraw& draw) {
  Random random(77 + 13 * draw.seed);
  const Eigen::Vector3d gyro_bias = kGyroBiasSigma * draw_vector(random);
  return {.pixel_noise_px = draw.pixel_noise_px,
          .depth_noise = draw.depth_noise,
          .depth_factor = draw.depth_factor,
          .noisy_imu = true,
          .time_offset_s = draw.time_offset_s,
          .track_length_s = draw.track_length_s,
          .seed = draw.seed,
          .gyro_bias = gyro_bias,
          .accel_bias = kAccelBiasSigma * draw_vector(random),
          .bias_walk = true};
}

Rig draw_rig(const NeesDraw& draw) {
  Random random(99 + 17 * draw.seed);
  Rig rig = SimulatedMotion::rig();
  rig.T_b_c.p += draw.extrinsics_m * draw_vector(random).normalized();
  rig.T_b_c.q = rig.T_b_c.q * exp_so3(draw.extrinsics_rad * draw_vector(random).normalized());
  return rig;
}

/// The truth at the IMU time at which the state of a frame is defined: that of the exposure, or what the
/// estimator held for it when the frame was added.
NavState truth_at(const Window& window, const WindowFrame& frame, const SimulatedMotion& motion) {
  const bool at_exposure = window.time_offset_model == TimeOffsetModel::kInertial;
  return SimulatedMotion::state(to_seconds(frame.state.t) +
                                (at_exposure ? motion.time_offset_s : frame.time_offset_s));
}

class Comparison {
 public:
  Comparison(const Estimator& estimator, const Pose& T_we_wt) : estimator_(estimator), T_we_wt_(T_we_wt) {}

  std::vector<NeesTerm> terms(const StateCovariance& covariance, const SimulatedMotion& motion) {
    const Window& window = estimator_.window();
    const NavState& state = window.frames.back().state;
    const NavState truth = truth_at(window, window.frames.back(), motion);
    const Pose true_pose = T_we_wt_ * truth.T_w_b;
    add("position", state.T_w_b.p - true_pose.p, covariance.position());
    add("orientation", log_so3(true_pose.q.conjugate() * state.T_w_b.q), covariance.rotation());
    if (!covariance.inertial) return terms_;
    add("velocity", state.v_w - T_we_wt_.q * truth.v_w, covariance.velocity());
    const Eigen::Vector3d gravity = T_we_wt_.q * Eigen::Vector3d(0.0, 0.0, -9.81);
    add("gravity", gravity_difference(window.gravity_w, gravity), covariance.gravity);
    add("time offset", Eigen::Matrix<double, 1, 1>(window.time_offset_s - motion.time_offset_s),
        Eigen::Matrix<double, 1, 1>(covariance.time_offset));
    add("depth scale", Eigen::Matrix<double, 1, 1>(window.depth_scale - motion.depth_factor),
        Eigen::Matrix<double, 1, 1>(covariance.depth_scale));
    const Pose T_b_c = SimulatedMotion::rig().T_b_c;
    add("extrinsic position", window.T_b_c.p - T_b_c.p, covariance.extrinsics.topLeftCorner<3, 3>());
    add("extrinsic rotation", log_so3(T_b_c.q.conjugate() * window.T_b_c.q),
        covariance.extrinsics.bottomRightCorner<3, 3>());
    return terms_;
  }

 private:
  void add(const char* quantity, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    if (covariance.isZero(0.0)) return;
    terms_.push_back(
        {quantity, static_cast<int>(error.size()), error.dot(covariance.llt().solve(error)), error.norm()});
  }

  const Estimator& estimator_;
  Pose T_we_wt_;
  std::vector<NeesTerm> terms_;
};

}  // namespace

std::vector<std::vector<NeesTerm>> simulate_nees(const OdometryConfig& config, const NeesDraw& draw,
                                                 const std::vector<double>& checkpoints) {
  const SimulatedMotion motion = draw_motion(draw);
  const std::vector<ImuSample> imu = motion.imu(checkpoints.back() + 1.0);
  Estimator estimator(config.backend, config.imu, draw_rig(draw), 1);
  std::vector<std::vector<NeesTerm>> result;
  std::optional<Pose> T_we_wt;
  std::size_t sample = 0;
  for (int i = 0; result.size() < checkpoints.size(); ++i) {
    const double t = 0.1 + i / kRate_hz;
    for (; sample < imu.size() && to_seconds(imu[sample].t) < t + 0.15; ++sample)
      estimator.add_imu(imu[sample]);
    const OdometryUpdate& update = estimator.process(motion.frame(i, t));
    const bool valid = update.status == OdometryStatus::kTracking && update.covariance;
    if (valid && !T_we_wt) {
      const WindowFrame& first = estimator.window().frames.front();
      T_we_wt = first.state.T_w_b * truth_at(estimator.window(), first, motion).T_w_b.inverse();
    }
    if (t < checkpoints[result.size()]) continue;
    result.emplace_back();
    if (valid) result.back() = Comparison(estimator, *T_we_wt).terms(*update.covariance, motion);
    if (update.nis.reprojection)
      result.back().push_back({"NIS reprojection", 1, *update.nis.reprojection, 0.0});
    if (update.nis.inertial) result.back().push_back({"NIS inertial", 1, *update.nis.inertial, 0.0});
  }
  return result;
}

}  // namespace stillpoint
