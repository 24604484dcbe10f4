// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/batch_problem.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <Eigen/Dense>

#include <ceres/solver.h>

#include "core/calibration/depth_patch.h"
#include "core/geometry/decompositions.h"

namespace stillpoint {
namespace {

constexpr double kLargestResidual = 4.0;  // of an inlier, in standard deviations
// Priors on the first state of a section, and after a gap of the inertial data.
constexpr double kSpeedSigma = 5.0;      // [m/s]
constexpr double kGyroBiasSigma = 0.05;  // [rad/s]
constexpr double kAccelBiasSigma = 0.3;  // [m/s^2]
constexpr double kLeastTruth_m = 5e-4;   // deviations of a ground truth, with the next
constexpr double kLeastTruth_rad = 5e-4;
constexpr double kLeastEdge_px = 0.5;      // deviation of an edge
constexpr double kRateHalfWidth_s = 0.01;  // of the mean rate at an exposure

int index(SharedValue value) { return static_cast<int>(value); }

class Monitor final : public ceres::IterationCallback {
 public:
  explicit Monitor(const std::function<bool(int, double)>& on_iteration) : on_iteration_(on_iteration) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (!on_iteration_ || on_iteration_(summary.iteration, summary.cost)) return ceres::SOLVER_CONTINUE;
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const std::function<bool(int, double)>& on_iteration_;
};

}  // namespace

BatchProblem::BatchProblem(const CalibrationInput& input, const CalibrationPriors& priors,
                           const RoundOptions& options, BatchState& state)
    : input_(input), priors_(priors), options_(options), state_(state), problem_(problem_options()) {
  add_keyframes();
  add_shared();
  for (BatchLandmark& landmark : state_.landmarks) {
    if (landmark.is_usable()) add_landmark(landmark);
  }
  if (options_.edge_radius_px > 0.0) {
    for (int i = 0; i < static_cast<int>(state_.keyframes.size()); ++i) add_edges(i);
  }
  add_priors();
  if (!state_.T_w_g.empty()) add_truth();
}

/// Between the neighboring keyframes of the section; zero without one.
Eigen::Vector3d BatchProblem::mean_velocity_c(int keyframe, const Eigen::Vector3d& p_w) const {
  const int last = static_cast<int>(state_.keyframes.size()) - 1;
  const auto at = [&](int i) -> const BatchKeyframe& {
    return state_.keyframes[static_cast<std::size_t>(i)];
  };
  const auto in_section = [&](int i) {
    return i >= 0 && i <= last && at(i).section == at(keyframe).section ? i : keyframe;
  };
  const int before = in_section(keyframe - 1), next = in_section(keyframe + 1);
  if (before == next) return Eigen::Vector3d::Zero();
  const Pose T_b_c = pose_of(state_.shared.T_b_c);
  const Eigen::Vector3d from = (pose_of(at(before).pose) * T_b_c).inverse() * p_w;
  const Eigen::Vector3d to = (pose_of(at(next).pose) * T_b_c).inverse() * p_w;
  return (to - from) / seconds_between(at(before).t, at(next).t);
}

/// Edges of the depth image with the nearest ones of the color image.
void BatchProblem::add_edges(int index) {
  SharedValues& shared = state_.shared;
  const BatchKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(index)];
  const CameraModel model = input_.stated.rig.camera.model;
  const Pose T_c_d = pose_of(shared.T_c_d);
  const Pose T_w_c = pose_of(keyframe.pose) * pose_of(shared.T_b_c);
  const auto& depth = shared.depth_camera;
  int rows = cluster_ends_.empty() ? 0 : cluster_ends_.back();
  for (const DepthEdge& edge : keyframe.edges) {
    const auto p_c_at = [&](const Eigen::Vector2d& u) -> Eigen::Vector3d {
      return T_c_d * (edge.depth_m *
                      Eigen::Vector3d((u.x() - depth[2]) / depth[0], (u.y() - depth[3]) / depth[1], 1.0));
    };
    const Eigen::Vector3d p_c = p_c_at(edge.pixel);
    const Eigen::Vector3d velocity_c = mean_velocity_c(index, T_w_c * p_c);
    const Eigen::Vector3d shift = -shared.depth_delay_s * velocity_c;
    const Eigen::Vector2d pixel = projected_pixel(model, shared.camera.data(), p_c + shift);
    const Eigen::Vector2d beside =
        projected_pixel(model, shared.camera.data(), p_c_at(edge.pixel + edge.normal) + shift);
    const Eigen::Vector2d normal = (beside - pixel).normalized();
    const std::optional<double> distance = image_edge(keyframe.gray, pixel, normal, options_.edge_radius_px);
    if (!distance) continue;
    edge_factors_.emplace_back(model,
                               EdgeFactor::Measurement{.pixel = edge.pixel,
                                                       .depth_m = edge.depth_m,
                                                       .velocity_c = velocity_c,
                                                       .edge = pixel + *distance * normal,
                                                       .normal = normal},
                               state_.edge_sigma_px);
    cluster_blocks_.push_back(problem_.AddResidualBlock(&edge_factors_.back(), &huber_, shared.T_c_d.data(),
                                                        shared.depth_camera.data(), shared.camera.data(),
                                                        &shared.depth_delay_s));
    ++rows;
  }
  cluster_ends_.push_back(rows);
}

void BatchProblem::add_truth() {
  SharedValues& shared = state_.shared;
  const CalibrationTruth& truth = input_.truth;
  add_pose_block(shared.T_f_b.data(), SharedValue::kTruthPose);
  problem_.AddParameterBlock(&shared.truth_delay_s, 1);
  if (!is_variable(SharedValue::kTruthDelay)) problem_.SetParameterBlockConstant(&shared.truth_delay_s);
  pose_priors_.emplace_back(truth.T_f_b, priors_.truth_position_m, priors_.truth_rotation_rad);
  problem_.AddResidualBlock(&pose_priors_.back(), nullptr, shared.T_f_b.data());
  add_linear_prior(&shared.truth_delay_s, Eigen::VectorXd::Constant(1, truth.delay_s),
                   Eigen::MatrixXd::Constant(1, 1, 1.0 / priors_.truth_delay_s));
  for (int i = 0; i < static_cast<int>(state_.keyframes.size()); ++i) {
    BatchKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(i)];
    if (!truth_at(truth.trajectory, after(keyframe.t, shared.truth_delay_s))) continue;
    double* const world = state_.T_w_g[static_cast<std::size_t>(keyframe.section)].data();
    if (!problem_.HasParameterBlock(world)) problem_.AddParameterBlock(world, 7, &pose_manifold_);
    truth_keyframes_.push_back(i);
    truth_factors_.emplace_back(truth.trajectory, keyframe.t,
                                TruthFactor::Sigmas{state_.truth_sigma_m, state_.truth_sigma_rad});
    problem_.AddResidualBlock(&truth_factors_.back(), &huber_, keyframe.pose.data(), world,
                              shared.T_f_b.data(), &shared.truth_delay_s);
  }
}

void BatchProblem::add_keyframes() {
  const bool inertial = !input_.imu.empty();
  ImuBuffer samples;
  const ImuAxes axes = axes_of(state_.shared.imu_axes);
  for (const ImuSample& sample : input_.imu) samples.add(axes.corrected(sample));
  for (Eigen::Vector3d& gravity : state_.gravity_w) {
    if (inertial) problem_.AddParameterBlock(gravity.data(), 3, &gravity_manifold_);
  }
  int section = -1;
  for (int i = 0; i < static_cast<int>(state_.keyframes.size()); ++i) {
    BatchKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(i)];
    problem_.AddParameterBlock(keyframe.pose.data(), 7, &pose_manifold_);
    const bool is_first = keyframe.section != std::exchange(section, keyframe.section);
    if (is_first) problem_.SetParameterBlockConstant(keyframe.pose.data());
    if (!inertial) continue;
    problem_.AddParameterBlock(keyframe.speed_bias.data(), 9);
    const std::size_t before = inertial_.size();
    if (!is_first) add_inertial(samples, i - 1);
    if (inertial_.size() == before) add_state_prior(i);
  }
}

void BatchProblem::add_state_prior(int keyframe) {
  double* const block = state_.keyframes[static_cast<std::size_t>(keyframe)].speed_bias.data();
  Eigen::VectorXd weights(9);
  weights << Eigen::Vector3d::Constant(1.0 / kSpeedSigma), Eigen::Vector3d::Constant(1.0 / kGyroBiasSigma),
      Eigen::Vector3d::Constant(1.0 / kAccelBiasSigma);
  add_linear_prior(block, Eigen::VectorXd::Zero(9), weights.asDiagonal());
}

/// Nothing without samples over the interval.
void BatchProblem::add_inertial(ImuBuffer& samples, int first) {
  BatchKeyframe& i = state_.keyframes[static_cast<std::size_t>(first)];
  BatchKeyframe& j = state_.keyframes[static_cast<std::size_t>(first) + 1];
  const double offset_s = state_.shared.time_offset_s;
  const Timestamp begin = after(i.t, offset_s), end = after(j.t, offset_s);
  const std::vector<ImuSample>& interval = samples.samples_between(begin, end);
  const std::optional<ImuSample> at_i = samples.mean_around(begin, kRateHalfWidth_s);
  const std::optional<ImuSample> at_j = samples.mean_around(end, kRateHalfWidth_s);
  if (interval.size() < 2 || !at_i || !at_j) return;
  ImuNoise noise = input_.stated.rig.imu_noise;
  noise.gyro_noise *= state_.imu_noise.gyro;
  noise.accel_noise *= state_.imu_noise.accel;
  Preintegration imu(noise, Eigen::Vector3d(i.speed_bias.data() + 3),
                     Eigen::Vector3d(i.speed_bias.data() + 6));
  imu.integrate(interval);
  inertial_.push_back({.first = first,
                       .imu = std::move(imu),
                       .ends = {ImuEnd{offset_s, at_i->gyro_b, at_i->accel_b},
                                ImuEnd{offset_s, at_j->gyro_b, at_j->accel_b}}});
  const Inertial& added = inertial_.back();
  ImuAxesFactor::Linearization at{.values = state_.shared.imu_axes};
  if (estimates_imu_axes()) at.jacobian = imu_axes_jacobian(added.imu, noise, at.values);
  imu_factors_.emplace_back(added.imu, added.ends, at);
  problem_.AddResidualBlock(&imu_factors_.back(), nullptr, i.pose.data(), i.speed_bias.data(), j.pose.data(),
                            j.speed_bias.data(), state_.gravity_w[static_cast<std::size_t>(i.section)].data(),
                            &state_.shared.time_offset_s, state_.shared.imu_axes.data());
}

bool BatchProblem::estimates_imu_axes() const {
  const auto first = options_.is_variable.begin() + index(SharedValue::kImuAxes);
  return std::any_of(first, first + kImuAxesCount, std::identity{});
}

/// Makes some numbers of a block constant.
void BatchProblem::hold(double* block, int size, std::span<const int> constant) {
  if (constant.empty()) return;
  if (static_cast<int>(constant.size()) == size) {
    problem_.SetParameterBlockConstant(block);
  } else {
    subsets_.emplace_back(size, std::vector<int>(constant.begin(), constant.end()));
    problem_.SetManifold(block, &subsets_.back());
  }
}

void BatchProblem::add_pose_block(double* block, SharedValue first) {
  problem_.AddParameterBlock(block, 7, &pose_manifold_);
  if (!is_variable(first)) problem_.SetParameterBlockConstant(block);
}

void BatchProblem::add_shared() {
  SharedValues& shared = state_.shared;
  const auto constant_of = [&](SharedValue first, int size) {
    std::vector<int> constant;
    for (int i = 0; i < size; ++i) {
      if (!is_variable(static_cast<SharedValue>(index(first) + i))) constant.push_back(i);
    }
    return constant;
  };
  problem_.AddParameterBlock(shared.camera.data(), kCameraValues);
  std::vector<int> constant = constant_of(SharedValue::kFx, 6);
  for (int i = 6; i < kCameraValues; ++i) constant.push_back(i);
  hold(shared.camera.data(), kCameraValues, constant);
  problem_.AddParameterBlock(&shared.readout_s, 1);
  hold(&shared.readout_s, 1, constant_of(SharedValue::kReadout, 1));
  problem_.AddParameterBlock(shared.depth.data(), 2);
  hold(shared.depth.data(), 2, constant_of(SharedValue::kDepthScale, 2));
  problem_.AddParameterBlock(shared.depth_camera.data(), 4);
  hold(shared.depth_camera.data(), 4, constant_of(SharedValue::kDepthFx, 4));
  add_pose_block(shared.T_c_d.data(), SharedValue::kDepthPose);
  add_pose_block(shared.T_b_c.data(), SharedValue::kExtrinsics);
  problem_.AddParameterBlock(&shared.time_offset_s, 1);
  hold(&shared.time_offset_s, 1, constant_of(SharedValue::kTimeOffset, 1));
  problem_.AddParameterBlock(shared.imu_axes.data(), kImuAxesCount);
  hold(shared.imu_axes.data(), kImuAxesCount, constant_of(SharedValue::kImuAxes, kImuAxesCount));
  problem_.AddParameterBlock(&shared.depth_delay_s, 1);
  hold(&shared.depth_delay_s, 1, constant_of(SharedValue::kDepthDelay, 1));
}

/// Across the ray by the velocity of the pixel, along it by the neighboring poses.
Eigen::Vector3d BatchProblem::velocity_c(const BatchObservation& seen, const Eigen::Vector3d& p_w) const {
  const SharedValues& shared = state_.shared;
  const Pose& T_w_b = pose_of(state_.keyframes[static_cast<std::size_t>(seen.keyframe)].pose);
  const Eigen::Vector3d p = (T_w_b * pose_of(shared.T_b_c)).inverse() * p_w;
  const double rate = mean_velocity_c(seen.keyframe, p_w).z();
  const Eigen::Vector2d plane_rate(seen.feature.velocity_px.x() / shared.camera[0],
                                   seen.feature.velocity_px.y() / shared.camera[1]);
  return {p.z() * plane_rate.x() + p.x() / p.z() * rate, p.z() * plane_rate.y() + p.y() / p.z() * rate, rate};
}

std::optional<DepthFactor::Measurement> BatchProblem::depth_of(const BatchObservation& seen,
                                                               const Eigen::Vector3d& p_w) const {
  if (!seen.depth_is_inlier) return std::nullopt;
  const double row_fraction = (seen.feature.pixel.y() + 0.5) / input_.stated.rig.camera.height - 0.5;
  const Eigen::Vector3d velocity = velocity_c(seen, p_w);
  std::optional<DepthFactor::Measurement> measurement;
  const BatchKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(seen.keyframe)];
  const SharedValues& shared = state_.shared;
  const double units_per_m = input_.stated.rig.depth_units_per_m;
  if (options_.depth_is_registered) {
    const Camera& stated = input_.stated.depth_camera;
    const Eigen::Vector2d center(stated.cx, stated.cy);
    const Eigen::Vector2d displacement =
        Eigen::Vector2d(shared.depth_camera[2], shared.depth_camera[3]) - center;
    if (!keyframe.depth.empty()) {
      measurement = depth_patch(keyframe.depth, units_per_m, seen.feature.pixel + displacement);
    } else if (seen.feature.depth_m > 0.0) {
      measurement.emplace().inverse_depth = 1.0 / seen.feature.depth_m;
    }
    if (measurement) measurement->registered_px = seen.feature.pixel - center;
  } else {
    const Pose T_w_c = pose_of(keyframe.pose) * pose_of(shared.T_b_c);
    const Eigen::Vector3d p_c =
        T_w_c.inverse() * p_w + (row_fraction * shared.readout_s + shared.depth_delay_s) * velocity;
    const Eigen::Vector3d p_d = pose_of(shared.T_c_d).inverse() * p_c;
    if (p_d.z() < kNearestPoint_m) return std::nullopt;
    const auto& camera = shared.depth_camera;
    const Eigen::Vector2d pixel(camera[0] * p_d.x() / p_d.z() + camera[2],
                                camera[1] * p_d.y() / p_d.z() + camera[3]);
    measurement = depth_patch(keyframe.depth, units_per_m, pixel);
  }
  if (!measurement) return std::nullopt;
  measurement->velocity_c = velocity;
  measurement->row_fraction = row_fraction;
  return measurement;
}

void BatchProblem::add_landmark(BatchLandmark& landmark) {
  SharedValues& shared = state_.shared;
  ceres::LossFunction* loss = &huber_;
  if (options_.is_first) loss = &cauchy_;
  const double height = input_.stated.rig.camera.height;
  int rows = cluster_ends_.empty() ? 0 : cluster_ends_.back();
  ++landmark_count_;
  problem_.AddParameterBlock(landmark.p_w.data(), 3);
  for (BatchObservation& observation : landmark.observations) {
    const CalibrationFeature& feature = observation.feature;
    double* const pose = state_.keyframes[static_cast<std::size_t>(observation.keyframe)].pose.data();
    pixel_factors_.emplace_back(
        input_.stated.rig.camera.model,
        PixelFactor::Measurement{.pixel = feature.pixel,
                                 .velocity_px = feature.velocity_px,
                                 .row_fraction = (feature.pixel.y() + 0.5) / height - 0.5},
        state_.pixel_sigma_px);
    Seen seen{&observation, &landmark.p_w, &pixel_factors_.back(), nullptr};
    if (observation.pixel_is_inlier) {
      cluster_blocks_.push_back(problem_.AddResidualBlock(seen.pixel, loss, pose, shared.T_b_c.data(),
                                                          shared.camera.data(), &shared.readout_s,
                                                          landmark.p_w.data()));
      rows += 2;
    }
    if (const auto measurement = depth_of(observation, landmark.p_w)) {
      depth_factors_.emplace_back(*measurement, state_.inverse_depth_sigma);
      seen.depth = &depth_factors_.back();
      if (observation.pixel_is_inlier) {
        cluster_blocks_.push_back(problem_.AddResidualBlock(
            seen.depth, loss, pose, shared.T_b_c.data(), shared.T_c_d.data(), shared.depth_camera.data(),
            shared.depth.data(), landmark.p_w.data(), &shared.readout_s, &shared.depth_delay_s));
        ++rows;
      }
    }
    seen_.push_back(seen);
  }
  cluster_ends_.push_back(rows);
}

void BatchProblem::add_linear_prior(double* block, const Eigen::VectorXd& mean, const Eigen::MatrixXd& A) {
  linear_priors_.emplace_back(mean, A);
  problem_.AddResidualBlock(&linear_priors_.back(), nullptr, block);
}

void BatchProblem::add_priors() {
  SharedValues& shared = state_.shared;
  const SharedValues stated = shared_values(input_.stated);
  const auto mean = [](const auto& values) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<int>(values.size())));
  };
  // The focal length fx + fy, and the ratio of both; the center; the distortion.
  const auto camera_prior = [](const double* values, double focal, double ratio, double center) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    A.row(0).head<2>() << 0.5 / (focal * values[0]), 0.5 / (focal * values[1]);
    A.row(1).head<2>() << 1.0 / (ratio * values[0]), -1.0 / (ratio * values[1]);
    A(2, 2) = A(3, 3) = 1.0 / center;
    return A;
  };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, kCameraValues);
  A.topLeftCorner<4, 4>() =
      camera_prior(stated.camera.data(), priors_.focal, priors_.focal_ratio, priors_.center_px);
  A(4, 4) = A(5, 5) = 1.0 / priors_.distortion;
  add_linear_prior(shared.camera.data(), mean(stated.camera), A);
  add_linear_prior(shared.depth_camera.data(), mean(stated.depth_camera),
                   camera_prior(stated.depth_camera.data(), priors_.depth_focal, priors_.focal_ratio,
                                priors_.depth_center_px));
  const auto scalar = [&](double* value, double stated_value, double sigma) {
    add_linear_prior(value, Eigen::VectorXd::Constant(1, stated_value),
                     Eigen::MatrixXd::Constant(1, 1, 1.0 / sigma));
  };
  scalar(&shared.readout_s, stated.readout_s, priors_.rolling_shutter_s);
  scalar(&shared.time_offset_s, stated.time_offset_s, priors_.time_offset_s);
  Eigen::VectorXd axes(kImuAxesCount);  // of each sensor, three scales and three angles
  for (int i = 0; i < kImuAxesCount; ++i)
    axes[i] = 1.0 / (i % 6 < 3 ? priors_.imu_scale : priors_.imu_axes_rad);
  add_linear_prior(shared.imu_axes.data(), mean(stated.imu_axes), axes.asDiagonal());
  scalar(&shared.depth_delay_s, stated.depth_delay_s, priors_.depth_delay_s);
  add_linear_prior(shared.depth.data(), mean(stated.depth),
                   Eigen::Vector2d(1.0 / priors_.depth_scale, 1.0 / priors_.depth_offset).asDiagonal());
  for (auto [block, pose] : {std::pair{shared.T_b_c.data(), input_.stated.rig.T_b_c},
                             std::pair{shared.T_c_d.data(), input_.stated.T_c_d}}) {
    pose_priors_.emplace_back(pose, priors_.lever_m, priors_.rotation_rad);
    problem_.AddResidualBlock(&pose_priors_.back(), nullptr, block);
  }
}

bool BatchProblem::solve() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> blocks;
  problem_.GetParameterBlocks(&blocks);
  for (double* block : blocks) options.linear_solver_ordering->AddElementToGroup(block, 1);
  for (const Seen& seen : seen_) options.linear_solver_ordering->AddElementToGroup(seen.point->data(), 0);
  options.max_num_iterations = options_.max_iterations;
  options.function_tolerance = 1e-7;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  Monitor monitor(options_.on_iteration);
  options.callbacks.push_back(&monitor);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  return summary.IsSolutionUsable();
}

std::array<const double*, 8> BatchProblem::depth_blocks(const Seen& seen) const {
  const SharedValues& shared = state_.shared;
  return {state_.keyframes[static_cast<std::size_t>(seen.observation->keyframe)].pose.data(),
          shared.T_b_c.data(),
          shared.T_c_d.data(),
          shared.depth_camera.data(),
          shared.depth.data(),
          seen.point->data(),
          &shared.readout_s,
          &shared.depth_delay_s};
}

namespace {

/// 1.4826 times the median of absolute values: the standard deviation of normal values.
double median_deviation(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 1.4826 * *middle;
}

double rms_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Deviation by the values up to `kLargestResidual` median deviations.
double trimmed_deviation(std::vector<double> values) {
  const double limit = kLargestResidual * median_deviation(values);
  std::erase_if(values, [limit](double value) { return value > limit; });
  return rms_of(values);
}

}  // namespace

RoundStatistics BatchProblem::update_deviations() {
  RoundStatistics statistics{.landmarks = landmark_count_, .inertial_factors = inertial_.size()};
  std::vector<double> pixels, depths;
  std::vector<Eigen::Vector2d> errors(seen_.size());
  std::vector<double> depth_errors(seen_.size(), 0.0);
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Seen& seen = seen_[i];
    const std::array<const double*, 8> blocks = depth_blocks(seen);
    const std::array<const double*, 5> pixel_blocks = {blocks[0], blocks[1], state_.shared.camera.data(),
                                                       &state_.shared.readout_s, blocks[5]};
    Eigen::Vector2d r;
    static_cast<void>(seen.pixel->Evaluate(pixel_blocks.data(), r.data(), nullptr));
    r *= state_.pixel_sigma_px;
    errors[i] = r;
    pixels.insert(pixels.end(), {std::abs(r.x()), std::abs(r.y())});
    if (seen.depth == nullptr) continue;
    static_cast<void>(seen.depth->Evaluate(blocks.data(), &depth_errors[i], nullptr));
    depth_errors[i] = std::abs(depth_errors[i]) * state_.inverse_depth_sigma;
    depths.push_back(depth_errors[i]);
  }
  const double values = static_cast<double>(pixels.size() + depths.size() + 15 * inertial_.size());
  const double estimated = 3.0 * static_cast<double>(landmark_count_) +
                           (inertial_.empty() ? 6.0 : 15.0) * static_cast<double>(state_.keyframes.size());
  const double correction = std::sqrt(values / std::max(1.0, values - estimated));
  statistics.pixel_rms_px = correction * trimmed_deviation(std::move(pixels));
  statistics.inverse_depth_rms = correction * trimmed_deviation(std::move(depths));
  state_.pixel_sigma_px = std::max(0.01, statistics.pixel_rms_px);
  state_.inverse_depth_sigma = std::max(1e-4, statistics.inverse_depth_rms);
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    BatchObservation& observation = *seen_[i].observation;
    observation.pixel_is_inlier = errors[i].norm() <= kLargestResidual * state_.pixel_sigma_px;
    if (observation.pixel_is_inlier) statistics.residuals.push_back({observation.feature.pixel, errors[i]});
    observation.depth_is_inlier = depth_errors[i] <= kLargestResidual * state_.inverse_depth_sigma;
    statistics.observations += observation.pixel_is_inlier;
    statistics.depths +=
        observation.pixel_is_inlier && observation.depth_is_inlier && seen_[i].depth != nullptr;
  }
  if (!inertial_.empty()) update_imu_noise();
  statistics.truth_poses = truth_factors_.size();
  if (!truth_factors_.empty()) update_truth_noise();
  statistics.edges = edge_factors_.size();
  if (!edge_factors_.empty()) update_edge_noise();
  return statistics;
}

void BatchProblem::update_edge_noise() {
  const SharedValues& shared = state_.shared;
  const std::array<const double*, 4> blocks = {shared.T_c_d.data(), shared.depth_camera.data(),
                                               shared.camera.data(), &shared.depth_delay_s};
  std::vector<double> distances;
  for (const EdgeFactor& factor : edge_factors_) {
    double r = 0.0;
    static_cast<void>(factor.Evaluate(blocks.data(), &r, nullptr));
    distances.push_back(std::abs(r) * state_.edge_sigma_px);
  }
  state_.edge_sigma_px = std::max(kLeastEdge_px, rms_of(distances));
}

void BatchProblem::update_truth_noise() {
  std::vector<double> positions, rotations;
  for (std::size_t k = 0; k < truth_factors_.size(); ++k) {
    const BatchKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(truth_keyframes_[k])];
    const std::array<const double*, 4> blocks = {
        keyframe.pose.data(), state_.T_w_g[static_cast<std::size_t>(keyframe.section)].data(),
        state_.shared.T_f_b.data(), &state_.shared.truth_delay_s};
    std::array<double, 6> r{};
    static_cast<void>(truth_factors_[k].Evaluate(blocks.data(), r.data(), nullptr));
    for (std::size_t i = 0; i < 3; ++i) {
      positions.push_back(std::abs(r[i]) * state_.truth_sigma_m);
      rotations.push_back(std::abs(r[i + 3]) * state_.truth_sigma_rad);
    }
  }
  state_.truth_sigma_m = std::max(kLeastTruth_m, trimmed_deviation(std::move(positions)));
  state_.truth_sigma_rad = std::max(kLeastTruth_rad, trimmed_deviation(std::move(rotations)));
}

/// By the residuals of rotation, and of position and velocity: each interval has three of either more than it
/// has unknowns.
void BatchProblem::update_imu_noise() {
  std::vector<double> gyro, accel;
  for (std::size_t k = 0; k < inertial_.size(); ++k) {
    const auto first = static_cast<std::size_t>(inertial_[k].first);
    const BatchKeyframe& i = state_.keyframes[first];
    const BatchKeyframe& j = state_.keyframes[first + 1];
    const std::array<const double*, 7> blocks = {i.pose.data(),
                                                 i.speed_bias.data(),
                                                 j.pose.data(),
                                                 j.speed_bias.data(),
                                                 state_.gravity_w[static_cast<std::size_t>(i.section)].data(),
                                                 &state_.shared.time_offset_s,
                                                 state_.shared.imu_axes.data()};
    Vector15 whitened;
    static_cast<void>(imu_factors_[k].Evaluate(blocks.data(), whitened.data(), nullptr));
    const Matrix15& W = inertial_[k].imu.sqrt_information();
    if (W.isZero(0.0)) continue;
    const Vector15 r = W.triangularView<Eigen::Lower>().solve(whitened);
    const Matrix15& P = inertial_[k].imu.covariance();
    const Eigen::Vector3d rotation = r.segment<3>(ImuErrorIndex::kRotation);
    gyro.push_back(
        std::sqrt(rotation.dot(solve_symmetric<3, 1>(
                      P.block<3, 3>(ImuErrorIndex::kRotation, ImuErrorIndex::kRotation), rotation)) /
                  3.0));
    Eigen::Matrix<double, 6, 1> motion;
    motion << r.segment<3>(ImuErrorIndex::kPosition), r.segment<3>(ImuErrorIndex::kVelocity);
    Eigen::Matrix<double, 6, 6> P_motion;
    P_motion << P.block<3, 3>(0, 0), P.block<3, 3>(0, 6), P.block<3, 3>(6, 0), P.block<3, 3>(6, 6);
    accel.push_back(std::sqrt(motion.dot(solve_symmetric(P_motion, motion)) / 3.0));
  }
  state_.imu_noise.gyro = std::max(1.0, state_.imu_noise.gyro * rms_of(gyro));
  state_.imu_noise.accel = std::max(1.0, state_.imu_noise.accel * rms_of(accel));
}

}  // namespace stillpoint
