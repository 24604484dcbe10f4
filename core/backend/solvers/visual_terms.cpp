// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/visual_terms.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {

/// The bearing at the time of the state, with the present time offset and lens.
Eigen::Vector2d VisualTerms::at_state(const TimedBearing& timed) const {
  const Eigen::Vector2d change = corrected_bearing(timed.seen, lens_ - lens_at_read_) - timed.seen;
  return timed.bearing + change - (time_offset_ + timed.exposure_s) * timed.velocity;
}

void VisualTerms::read(const Window& window, const BackendConfig& config, double focal_px,
                       LandmarkSelection selection) {
  frames_ = static_cast<int>(window.frames.size());
  noise_ = reprojection_noise(config, focal_px);
  cauchy_squared_ = config.cauchy_scale * config.cauchy_scale;
  marginalizes_ = selection == LandmarkSelection::kHostedByOldest;
  bearings_move_ = window.time_offset_model == TimeOffsetModel::kBearing;
  observation_model_.read(window);
  lens_at_read_ = window.lens;
  const auto pairs = static_cast<std::size_t>(frames_) * static_cast<std::size_t>(frames_);
  pair_used_.assign(pairs, 0);
  relative_poses_.resize(pairs);
  sums_.resize(pairs);
  scale_sums_.resize(pairs);
  lens_sums_.resize(pairs);
  landmarks_.clear();
  timed_observations_.clear();
  host_frames_.clear();
  variable_count_ = 0;
  measured_ = 0;
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    const bool wanted = selection == LandmarkSelection::kAll || landmark.host == 0;
    if (wanted && is_usable(landmark)) add_landmark(window, i, config);
  }
  information_.resize(variable_count_);
  gradient_.resize(variable_count_);
}

void VisualTerms::add_landmark(const Window& window, std::size_t index, const BackendConfig& config) {
  const Landmark& landmark = window.landmarks[index];
  const double fraction = marginalizes_ ? marginalized_fraction(landmark, window, config) : 1.0;
  const Eigen::Vector3d position_w = observation_model_.position(landmark);
  const Observation& host = landmark.observations.front();
  const bool host_depth = uses_depth(host, config);
  landmarks_.push_back({.index = index,
                        .host = landmark.host,
                        .last = landmark.last(),
                        .first_observation = timed_observations_.size(),
                        .in_host = observation_model_.at(landmark, landmark.host, position_w),
                        .measured = host_depth ? 1.0 / host.depth : 0.0,
                        .has_depth = host_depth,
                        .information = fraction * host.information,
                        .column = has_constant_depth(landmark, config) ? -1 : variable_count_});
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const Observation& observation = landmark.observation_in(frame);
    const bool depth = uses_depth(observation, config);
    timed_observations_.push_back({.bearing = observation_model_.at(landmark, frame, position_w),
                                   .inverse_depth = depth ? 1.0 / observation.depth : 0.0,
                                   .has_depth = depth,
                                   .information = fraction * observation.information});
    pair_used_[pair(landmark.host, frame)] = 1;
  }
  measured_ += landmark.source == DepthSource::kMeasured;
  if (landmarks_.back().column < 0) return;
  host_frames_.push_back(landmark.host);
  ++variable_count_;
}

VisualTerms::LandmarkState VisualTerms::state_of(const VisualLandmark& landmark,
                                                 const ParameterBlocks& blocks) const {
  return {*blocks.inverse_depth(landmark.index), at_state(landmark.in_host).homogeneous(),
          landmark.in_host.seen, landmark.in_host.velocity};
}

MeasuredPoint VisualTerms::measured_point_at(const TimedObservation& observation) const {
  return {.bearing = at_state(observation.bearing),
          .noise_ratio = lens_noise_ratio(observation.bearing.seen, lens_),
          .inverse_depth = observation.inverse_depth,
          .inverse_depth_scale = inverse_depth_scale_,
          .has_depth = observation.has_depth};
}

/// Host depth residual and its derivative; zero without a depth in the host.
BoundedError VisualTerms::host_depth(const VisualLandmark& landmark, double lambda) const {
  if (!landmark.has_depth) return {0.0, 0.0};
  const BoundedError depth = bounded_error(
      (lambda * inverse_depth_scale_ - landmark.measured) / noise_.inverse_depth, noise_.depth_outlier);
  return {depth.value, depth.slope / noise_.inverse_depth * inverse_depth_scale_};
}

double VisualTerms::cost(const ParameterBlocks& blocks) {
  update_relative_poses(blocks);
  double total = 0.0;
  for (const VisualLandmark& landmark : landmarks_) {
    const LandmarkState state = state_of(landmark, blocks);
    const double depth = host_depth(landmark, state.lambda).value;
    total += landmark.information * depth * depth;
    for (int frame = landmark.host + 1; frame <= landmark.last; ++frame) {
      const RelativePoseLinearization& to = relative_poses_[pair(landmark.host, frame)];
      const Eigen::Vector3d p_cj = to.R_cj_ci * state.ray + state.lambda * to.p_cj_ci;
      const TimedObservation& observation = observation_of(landmark, frame);
      const ReprojectionRows rows =
          reprojection_rows(p_cj, state.lambda, measured_point_at(observation), noise_);
      total += observation.information * cauchy_squared_ *
               std::log(1.0 + rows.residual.squaredNorm() / cauchy_squared_);
    }
  }
  return 0.5 * total;
}

double VisualTerms::add_to(ReducedSystem& system, const Linearization& at) {
  lens_varies_ = system.layout.variable_globals().lens;
  update_relative_poses(at.states);
  update_pose_jacobians(at.point, system.layout.variable_globals().extrinsics);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (pair_used_[i] == 0) continue;
    sums_[i].setZero();
    scale_sums_[i].setZero();
    lens_sums_[i].setZero();
  }
  scale_information_ = host_scale_gradient_ = 0.0;
  lens_information_.setZero();
  lens_scale_.setZero();
  coupling_.resize(system.layout.size() - system.layout.first_pose(), variable_count_);
  double total = 0.0;
  for (const VisualLandmark& landmark : landmarks_) total += linearize(landmark, at.states, system.layout);
  for (int host = 0; host < frames_; ++host) {
    for (int frame = host + 1; frame < frames_; ++frame) {
      if (pair_used_[pair(host, frame)] != 0) add_pair(host, frame, system);
    }
  }
  const int depth_scale = system.layout.column({BlockKind::kDepthScale});
  if (depth_scale >= 0) {
    system.H(depth_scale, depth_scale) += scale_information_;
    system.g[depth_scale] += host_scale_gradient_;
  }
  const int lens = system.layout.column({BlockKind::kLens});
  if (lens >= 0) system.H.block<4, 4>(lens, lens) += lens_information_;
  if (lens >= 0 && depth_scale >= 0) system.H.block<4, 1>(lens, depth_scale) += lens_scale_;
  return 0.5 * total;
}

VisualTerms::ObservationTerm VisualTerms::linearize(const TimedObservation& timed,
                                                    const RelativePoseLinearization& to,
                                                    const LandmarkState& host) const {
  const Eigen::Vector3d p_cj = to.R_cj_ci * host.ray + host.lambda * to.p_cj_ci;
  const MeasuredPoint measured = measured_point_at(timed);
  const ReprojectionRows at = reprojection_rows(p_cj, host.lambda, measured, noise_);
  const double x = p_cj.x(), y = p_cj.y(), z = p_cj.z();
  const double J_xy = at.J_point(0, 0), J_xz = at.J_point(0, 2), J_yz = at.J_point(1, 2);
  const double J_zz = at.J_point(2, 2);
  ObservationTerm term;
  term.rows.col(0) << host.lambda * J_xy, 0.0, host.lambda * J_xz,  // by nu
      y * J_xz, z * J_xy - x * J_xz, -(y * J_xy),                   // by omega: P x J_point
      0.0, at.residual[0];
  term.rows.col(1) << 0.0, host.lambda * J_xy, host.lambda * J_yz,  //
      y * J_yz - z * J_xy, -(x * J_yz), x * J_xy,                   //
      0.0, at.residual[1];
  term.rows.col(2) << 0.0, 0.0, host.lambda * J_zz,  //
      y * J_zz, -(x * J_zz), 0.0,                    //
      0.0, at.residual[2];
  if (bearings_move_) {
    const Eigen::Vector3d J_time = -(to.R_cj_ci.leftCols<2>() * host.velocity);
    for (int row = 0; row < 3; ++row) {
      const Eigen::Vector3d J_point = at.J_point.row(row).transpose();
      term.rows(6, row) = J_point.dot(J_time);
    }
    term.rows.row(6).head<2>() +=
        timed.bearing.velocity.transpose() / (measured.noise_ratio * noise_.bearing);
  }
  if (lens_varies_) {
    const Eigen::Matrix<double, 3, 2> J_host = at.J_point * to.R_cj_ci.leftCols<2>();
    term.J_lens.noalias() = lens_jacobian(host.seen).transpose() * J_host.transpose();
    term.J_lens.leftCols<2>() -=
        lens_jacobian(timed.bearing.seen).transpose() / (measured.noise_ratio * noise_.bearing) +
        lens_noise_gradient(timed.bearing.seen).transpose() * at.residual.head<2>().transpose() /
            measured.noise_ratio;
  }
  term.J_lambda = at.J_point * to.p_cj_ci;
  term.J_lambda[2] += at.J_depth_lambda;
  term.J_scale = at.J_depth_scale;
  return term;
}

/// @return twice the cost
double VisualTerms::linearize(const VisualLandmark& landmark, const ParameterBlocks& blocks,
                              const ReducedLayout& layout) {
  const LandmarkState state = state_of(landmark, blocks);
  const BoundedError depth = host_depth(landmark, state.lambda);
  double total = landmark.information * depth.value * depth.value;
  double information = landmark.information * depth.slope * depth.slope;
  double gradient = landmark.information * depth.slope * depth.value;
  const bool with_scale = layout.variable_globals().depth_scale;
  if (landmark.column >= 0) coupling_.col(landmark.column).setZero();
  if (with_scale && landmark.has_depth) add_host_scale_terms(landmark, state.lambda, depth, layout);
  for (int frame = landmark.host + 1; frame <= landmark.last; ++frame) {
    const std::size_t shared = pair(landmark.host, frame);
    const TimedObservation& observation = observation_of(landmark, frame);
    ObservationTerm term = linearize(observation, relative_poses_[shared], state);
    const double inner = 1.0 + term.rows.row(7).squaredNorm() / cauchy_squared_;
    total += observation.information * cauchy_squared_ * std::log(inner);
    term.inverse_weight = inner / observation.information;
    const Eigen::Matrix<double, 8, 3> weighted = term.rows / term.inverse_weight;
    sums_[shared].noalias() += weighted * term.rows.transpose();
    if (with_scale) add_scale_terms(landmark, frame, term, layout);
    if (lens_varies_) add_lens_terms(landmark, frame, term, layout);
    if (landmark.column < 0) continue;
    const Column8 column = weighted * term.J_lambda;
    information += term.J_lambda.squaredNorm() / term.inverse_weight;
    gradient += column[7];
    add_coupling(landmark, frame, column, layout);
  }
  if (landmark.column < 0) return total;
  information_[landmark.column] = information;
  gradient_[landmark.column] = gradient;
  return total;
}

/// The same terms of the lens, by all rows of one observation.
void VisualTerms::add_lens_terms(const VisualLandmark& landmark, int frame, const ObservationTerm& term,
                                 const ReducedLayout& layout) {
  const Eigen::Matrix<double, 4, 3> weighted = term.J_lens / term.inverse_weight;
  lens_sums_[pair(landmark.host, frame)].noalias() += term.rows * weighted.transpose();
  lens_information_.noalias() += weighted * term.J_lens.transpose();
  lens_scale_ += term.J_scale * weighted.col(2);
  if (landmark.column < 0) return;
  coupling_.block<4, 1>(layout.column({BlockKind::kLens}) - layout.first_pose(), landmark.column) +=
      weighted * term.J_lambda;
}

/// H_ps, H_ss, g_s and H_ls of the depth row of one observation.
void VisualTerms::add_scale_terms(const VisualLandmark& landmark, int frame, const ObservationTerm& term,
                                  const ReducedLayout& layout) {
  const double weighted = 1.0 / term.inverse_weight * term.J_scale;
  scale_sums_[pair(landmark.host, frame)] += weighted * term.rows.col(2);
  scale_information_ += weighted * term.J_scale;
  if (landmark.column < 0) return;
  coupling_(layout.column({BlockKind::kDepthScale}) - layout.first_pose(), landmark.column) +=
      weighted * term.J_lambda[2];
}

/// H_ss, g_s and H_ls of the depth in the host. @param depth of `host_depth`
void VisualTerms::add_host_scale_terms(const VisualLandmark& landmark, double lambda,
                                       const BoundedError& depth, const ReducedLayout& layout) {
  const double J_scale = depth.slope * lambda / inverse_depth_scale_;
  const double weighted = landmark.information * J_scale;
  scale_information_ += weighted * J_scale;
  host_scale_gradient_ += weighted * depth.value;
  if (landmark.column < 0) return;
  coupling_(layout.column({BlockKind::kDepthScale}) - layout.first_pose(), landmark.column) +=
      weighted * depth.slope;
}

namespace {

Pose pose_at(const double* x) { return Pose{Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

}  // namespace

/// Computes what the relative poses of `blocks` share.
CameraOnBody VisualTerms::place_cameras(const ParameterBlocks& blocks) {
  CameraOnBody camera(pose_at(blocks.at({BlockKind::kExtrinsics})));
  cameras_.clear();
  for (int frame = 0; frame < frames_; ++frame) {
    cameras_.emplace_back(pose_at(blocks.at({BlockKind::kPose, frame})), camera);
  }
  return camera;
}

/// Computes the relative poses of all frame pairs that share landmarks at the current states.
void VisualTerms::update_relative_poses(const ParameterBlocks& blocks) {
  time_offset_ = *blocks.at({BlockKind::kTimeOffset});
  inverse_depth_scale_ = *blocks.at({BlockKind::kDepthScale});
  lens_ = Eigen::Vector4d(blocks.at({BlockKind::kLens}));
  const CameraOnBody camera = place_cameras(blocks);
  for (std::size_t host = 0; host < cameras_.size(); ++host) {
    for (std::size_t frame = host + 1; frame < cameras_.size(); ++frame) {
      const std::size_t shared = pair(host, frame);
      if (pair_used_[shared] != 0) set_pose(cameras_[host], cameras_[frame], camera, relative_poses_[shared]);
    }
  }
}

/// Evaluates the derivatives of the relative poses, but not the poses, at `point`.
void VisualTerms::update_pose_jacobians(const ParameterBlocks& point, bool with_extrinsics) {
  const CameraOnBody camera = place_cameras(point);
  for (std::size_t host = 0; host < cameras_.size(); ++host) {
    for (std::size_t frame = host + 1; frame < cameras_.size(); ++frame) {
      const std::size_t shared = pair(host, frame);
      if (pair_used_[shared] == 0) continue;
      RelativePoseLinearization& relative = relative_poses_[shared];
      set_pose_jacobians(cameras_[host], cameras_[frame], camera, relative);
      if (with_extrinsics) set_extrinsics_jacobian(cameras_[host], cameras_[frame], camera, relative);
    }
  }
}

/// H_pl += M_ij^T w J_y^T J_l of one observation. @param column w [J_y r]^T J_l
void VisualTerms::add_coupling(const VisualLandmark& landmark, int frame, const Column8& column,
                               const ReducedLayout& layout) {
  const RelativePoseLinearization& to = relative_poses_[pair(landmark.host, frame)];
  const Eigen::Matrix<double, 6, 1> relative = column.head<6>();
  const Eigen::Index to_column = landmark.column;
  coupling_.block<6, 1>(Eigen::Index{6} * frame, to_column).noalias() = to.J_pose_j.transpose() * relative;
  coupling_.block<6, 1>(Eigen::Index{6} * landmark.host, to_column).noalias() +=
      to.J_pose_i.transpose() * relative;
  if (layout.variable_globals().extrinsics) {
    const int extrinsics = layout.column({BlockKind::kExtrinsics}) - layout.first_pose();
    coupling_.block<6, 1>(extrinsics, to_column).noalias() += to.J_extrinsics.transpose() * relative;
  }
  if (layout.variable_globals().time_offset) {
    coupling_(layout.column({BlockKind::kTimeOffset}) - layout.first_pose(), to_column) += column[6];
  }
}

void VisualTerms::add_pair(int host, int frame, ReducedSystem& system) const {
  struct PoseBlock {
    int column;
    const Matrix6& map;
  };
  const RelativePoseLinearization& to = relative_poses_[pair(host, frame)];
  const PairSum& sum = sums_[pair(host, frame)];
  const PoseBlock pose_blocks[] = {{system.layout.column({BlockKind::kPose, host}), to.J_pose_i},
                                   {system.layout.column({BlockKind::kPose, frame}), to.J_pose_j},
                                   {system.layout.column({BlockKind::kExtrinsics}), to.J_extrinsics}};
  const int time = system.layout.column({BlockKind::kTimeOffset});
  const int scale = system.layout.column({BlockKind::kDepthScale});
  const Column8& scale_sum = scale_sums_[pair(host, frame)];
  const int lens = system.layout.column({BlockKind::kLens});
  const Eigen::Matrix<double, 8, 4>& lens_sum = lens_sums_[pair(host, frame)];
  for (const PoseBlock& a : pose_blocks) {
    if (a.column < 0) continue;
    const Matrix6 left = a.map.transpose() * sum.topLeftCorner<6, 6>();
    for (const PoseBlock& b : pose_blocks) {
      if (b.column < 0 || a.column < b.column) continue;
      system.H.block<6, 6>(a.column, b.column).noalias() += left * b.map;
    }
    system.g.segment<6>(a.column).noalias() += a.map.transpose() * sum.block<6, 1>(0, 7);
    if (time >= 0) system.H.block<1, 6>(time, a.column).noalias() += sum.block<1, 6>(6, 0) * a.map;
    if (scale >= 0) {
      system.H.block<1, 6>(scale, a.column).noalias() += scale_sum.head<6>().transpose() * a.map;
    }
    if (lens >= 0) {
      system.H.block<4, 6>(lens, a.column).noalias() += lens_sum.topRows<6>().transpose() * a.map;
    }
  }
  if (scale >= 0) system.g[scale] += scale_sum[7];
  if (scale >= 0 && time >= 0) system.H(scale, time) += scale_sum[6];
  if (lens >= 0) system.g.segment<4>(lens) += lens_sum.row(7).transpose();
  if (lens >= 0 && time >= 0) system.H.block<4, 1>(lens, time) += lens_sum.row(6).transpose();
  if (time < 0) return;
  system.H(time, time) += sum(6, 6);
  system.g[time] += sum(6, 7);
}

namespace {

/// Landmarks eliminated by one rank update.
constexpr int kLandmarkBatch = 32;

}  // namespace

void VisualTerms::eliminate(double damping, Eigen::Ref<RowMajorMatrix> S, Eigen::Ref<Eigen::VectorXd> rhs) {
  const Eigen::Index states = coupling_.rows();
  scaled_.resize(states, kLandmarkBatch);
  for (int begin = 0; begin < variable_count_; begin += kLandmarkBatch) {
    const int count = std::min(kLandmarkBatch, variable_count_ - begin);
    int first_frame = frames_;
    for (int i = 0; i < count; ++i) {
      const int landmark = begin + i;
      first_frame = std::min(first_frame, host_frames_[static_cast<std::size_t>(landmark)]);
      const double damped = information_[landmark] * (1.0 + damping);
      const double inverse_root = damped > 0.0 ? 1.0 / std::sqrt(damped) : 0.0;
      scaled_.col(i) = inverse_root * coupling_.col(landmark);
      rhs.tail(states) += (gradient_[landmark] * inverse_root) * scaled_.col(i);
    }
    // A landmark involves only the poses from its host on.
    const Eigen::Index involved = states - Eigen::Index{6} * first_frame;
    S.bottomRightCorner(involved, involved)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(scaled_.bottomRows(involved).leftCols(count), -1.0);
  }
}

void VisualTerms::apply_step(const ReusableVector& step, ParameterBlocks& blocks) const {
  for (const VisualLandmark& landmark : landmarks_) {
    if (landmark.column >= 0) *blocks.inverse_depth(landmark.index) += step[landmark.column];
  }
}

}  // namespace stillpoint
