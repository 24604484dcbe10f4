// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/batch_state.h"

#include "core/geometry/decompositions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Dense>

namespace stillpoint {
namespace {

constexpr std::ptrdiff_t kMinObservations = 3;
constexpr double kFarthestDepth_m = 8.0;
constexpr double kMaxCosine = 0.99985;  // of rays of a landmark: one degree of parallax

}  // namespace

PoseValues values_of(const Pose& pose) {
  return {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()};
}
Pose pose_of(const PoseValues& v) {
  return Pose{Eigen::Quaterniond(v.data() + 3).normalized(), Eigen::Vector3d(v.data())};
}

SharedValues shared_values(const RigCalibration& calibration) {
  const Camera& camera = calibration.rig.camera;
  const Camera& depth = calibration.depth_camera;
  SharedValues shared{.camera = {camera.fx, camera.fy, camera.cx, camera.cy},
                      .readout_s = calibration.rig.rolling_shutter_s,
                      .depth = {1.0, 0.0},
                      .depth_camera = {depth.fx, depth.fy, depth.cx, depth.cy},
                      .T_b_c = values_of(calibration.rig.T_b_c),
                      .T_c_d = values_of(calibration.T_c_d),
                      .time_offset_s = calibration.rig.time_offset_s,
                      .depth_delay_s = calibration.depth_delay_s,
                      .T_f_b = values_of(Pose{})};
  std::ranges::copy(camera.distortion, shared.camera.begin() + 4);
  return shared;
}

RigCalibration rig_calibration(const SharedValues& shared, const RigCalibration& stated) {
  RigCalibration result = stated;
  Camera& camera = result.rig.camera;
  camera.fx = shared.camera[0];
  camera.fy = shared.camera[1];
  camera.cx = shared.camera[2];
  camera.cy = shared.camera[3];
  std::copy_n(shared.camera.begin() + 4, camera.distortion.size(), camera.distortion.begin());
  result.rig.rolling_shutter_s = shared.readout_s;
  result.rig.depth_units_per_m = stated.rig.depth_units_per_m * shared.depth[0];
  result.rig.T_b_c = pose_of(shared.T_b_c);
  result.rig.time_offset_s = shared.time_offset_s;
  const ImuAxes axes = axes_of(shared.imu_axes);
  result.rig.imu_axes = {stated.rig.imu_axes.gyro * axes.gyro, stated.rig.imu_axes.accel * axes.accel};
  // 1/z = (rho - o_stated - o) s, of the measured inverse depth rho in stated units.
  result.rig.depth_offset = shared.depth[0] * (stated.rig.depth_offset + shared.depth[1]);
  result.depth_camera.fx = shared.depth_camera[0];
  result.depth_camera.fy = shared.depth_camera[1];
  result.depth_camera.cx = shared.depth_camera[2];
  result.depth_camera.cy = shared.depth_camera[3];
  result.T_c_d = pose_of(shared.T_c_d);
  result.depth_delay_s = shared.depth_delay_s;
  return result;
}

bool BatchLandmark::is_usable() const {
  return std::ranges::count_if(observations, &BatchObservation::pixel_is_inlier) >= kMinObservations;
}

namespace {

/// Positions of landmarks by the poses of the odometry and the stated calibration.
class LandmarkPositions {
 public:
  LandmarkPositions(const BatchState& state, const RigCalibration& stated) : camera_(stated.rig.camera) {
    for (const BatchKeyframe& keyframe : state.keyframes)
      T_w_c_.push_back(pose_of(keyframe.pose) * stated.rig.T_b_c);
  }

  /// By measured depth, else by triangulation; nullopt if neither determines it.
  [[nodiscard]] std::optional<Eigen::Vector3d> position(const BatchLandmark& landmark) const {
    std::vector<Eigen::Vector3d> measured;
    for (const BatchObservation& seen : landmark.observations) {
      if (seen.feature.depth_m > 0.0) measured.push_back(T_w_c(seen) * (seen.feature.depth_m * ray(seen)));
    }
    if (!measured.empty()) return measured[measured.size() / 2];
    return triangulated(landmark);
  }

 private:
  [[nodiscard]] const Pose& T_w_c(const BatchObservation& seen) const {
    return T_w_c_[static_cast<std::size_t>(seen.keyframe)];
  }
  [[nodiscard]] Eigen::Vector3d ray(const BatchObservation& seen) const {
    return camera_.unproject(seen.feature.pixel).homogeneous();
  }

  /// The point with the smallest squared distance to all rays.
  [[nodiscard]] std::optional<Eigen::Vector3d> triangulated(const BatchLandmark& landmark) const {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> directions;
    for (const BatchObservation& seen : landmark.observations) {
      directions.emplace_back(T_w_c(seen).q * ray(seen).normalized());
      const Eigen::Matrix3d P =
          Eigen::Matrix3d::Identity() - directions.back() * directions.back().transpose();
      A += P;
      b += P * T_w_c(seen).p;
    }
    if (directions.front().dot(directions.back()) > kMaxCosine) return std::nullopt;
    const Eigen::Vector3d point = solve_symmetric(A, b);
    for (const BatchObservation& seen : landmark.observations) {
      if ((T_w_c(seen).inverse() * point).z() < kNearestPoint_m) return std::nullopt;
    }
    return point;
  }

  const Camera& camera_;
  std::vector<Pose> T_w_c_;
};

SpeedBiasValues speed_bias_of(const NavState& state) {
  SpeedBiasValues values{};
  Eigen::Map<Eigen::Matrix<double, 9, 1>>{values.data()} << state.v_w, state.gyro_bias, state.accel_bias;
  return values;
}

/// Features that are finite, with depths in range.
CalibrationFeature checked(CalibrationFeature feature) {
  if (!(feature.depth_m > 0.0 && feature.depth_m <= kFarthestDepth_m)) feature.depth_m = 0.0;
  return feature;
}

/// Each world of the ground truth by the first keyframe of the section at which it is known.
void align_truth(const CalibrationTruth& truth, BatchState& state) {
  if (truth.trajectory.poses.empty()) return;
  state.shared.T_f_b = values_of(truth.T_f_b);
  state.shared.truth_delay_s = truth.delay_s;
  state.T_w_g.assign(state.gravity_w.size(), values_of(Pose{}));
  int aligned = -1;
  for (const BatchKeyframe& keyframe : state.keyframes) {
    const std::optional<Pose> T_g_f = truth_at(truth.trajectory, after(keyframe.t, truth.delay_s));
    if (keyframe.section == aligned || !T_g_f) continue;
    aligned = keyframe.section;
    state.T_w_g[static_cast<std::size_t>(aligned)] =
        values_of(pose_of(keyframe.pose) * (*T_g_f * truth.T_f_b).inverse());
  }
}

}  // namespace

BatchState initial_state(const CalibrationInput& input, double begin, double end) {
  BatchState state{.shared = shared_values(input.stated)};
  std::size_t count = 0, index = 0;
  for (const CalibrationSection& section : input.sections) count += section.keyframes.size();
  std::map<std::pair<int, std::int64_t>, BatchLandmark> landmarks;  // by section and track
  for (const CalibrationSection& section : input.sections) {
    const int number = static_cast<int>(state.gravity_w.size());
    for (const CalibrationKeyframe& keyframe : section.keyframes) {
      const double fraction = static_cast<double>(index++) / static_cast<double>(count);
      if (fraction < begin || fraction >= end) continue;
      for (const CalibrationFeature& feature : keyframe.features) {
        if (!feature.pixel.allFinite() || !feature.velocity_px.allFinite()) continue;
        landmarks[{number, feature.track}].observations.push_back(
            {.keyframe = static_cast<int>(state.keyframes.size()), .feature = checked(feature)});
      }
      state.keyframes.push_back({.t = keyframe.state.t,
                                 .section = number,
                                 .pose = values_of(keyframe.T_w_c * input.stated.rig.T_b_c.inverse()),
                                 .speed_bias = speed_bias_of(keyframe.state),
                                 .depth = keyframe.depth,
                                 .gray = keyframe.gray});
      if (!input.depth_is_registered && !keyframe.gray.empty())
        state.keyframes.back().edges = depth_edges(keyframe.depth, input.stated.rig.depth_units_per_m);
    }
    state.gravity_w.emplace_back(input.gravity * section.gravity_w);
  }
  align_truth(input.truth, state);
  const LandmarkPositions positions(state, input.stated);
  for (auto& [track, landmark] : landmarks) {
    if (!landmark.is_usable()) continue;
    const std::optional<Eigen::Vector3d> position = positions.position(landmark);
    if (!position || !position->allFinite()) continue;
    landmark.p_w = *position;
    state.landmarks.push_back(std::move(landmark));
  }
  return state;
}

}  // namespace stillpoint
