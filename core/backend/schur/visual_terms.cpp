// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/schur/visual_terms.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

/// Landmarks subtracted together.
constexpr int kBatch = 32;

Pose pose_at(const double* x) { return Pose{Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

Eigen::Vector2d at_state(const TimedBearing& timed, double time_offset_s) {
  return timed.bearing - (time_offset_s + timed.exposure_s) * timed.velocity;
}

}  // namespace

void VisualTerms::read(const Window& window, const BackendConfig& config, double focal_px,
                       LandmarkPart part) {
  frames_ = static_cast<int>(window.frames.size());
  noise_ = reprojection_noise(config, focal_px);
  cauchy_squared_ = config.cauchy_scale * config.cauchy_scale;
  observations_.read(window);
  const auto pairs = static_cast<std::size_t>(frames_ * frames_);
  pair_used_.assign(pairs, 0);
  transfers_.resize(pairs);
  sums_.resize(pairs);
  landmarks_.clear();
  sightings_.clear();
  first_frame_.clear();
  free_ = 0;
  measured_ = 0;
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    const bool wanted = part == LandmarkPart::kAll || landmark.host == 0;
    if (wanted && is_usable(landmark)) add_landmark(landmark, i, config);
  }
  information_.resize(free_);
  gradient_.resize(free_);
}

void VisualTerms::add_landmark(const Landmark& landmark, std::size_t index, const BackendConfig& config) {
  const Eigen::Vector3d position_w = observations_.position(landmark);
  const Observation& host = landmark.observations.front();
  const bool host_depth = uses_depth(host, config);
  landmarks_.push_back({.index = index,
                        .host = landmark.host,
                        .last = landmark.last(),
                        .first_sighting = sightings_.size(),
                        .in_host = observations_.at(landmark, landmark.host, position_w),
                        .measured = host_depth ? 1.0 / host.depth : 0.0,
                        .has_depth = host_depth,
                        .column = is_held(landmark, config) ? -1 : free_});
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const Observation& seen = landmark.in(frame);
    const bool depth = uses_depth(seen, config);
    sightings_.push_back({.bearing = observations_.at(landmark, frame, position_w),
                          .inverse_depth = depth ? 1.0 / seen.depth : 0.0,
                          .has_depth = depth});
    pair_used_[pair(landmark.host, frame)] = 1;
  }
  measured_ += landmark.source == DepthSource::kMeasured;
  if (landmarks_.back().column < 0) return;
  first_frame_.push_back(landmark.host);
  ++free_;
}

/// Transforms between the frames that share landmarks, at the present states.
void VisualTerms::place_frames(ParameterBlocks& blocks) {
  time_offset_ = *blocks.time_offset();
  const Pose T_b_c = pose_at(blocks.extrinsics());
  for (int host = 0; host < frames_; ++host) {
    for (int frame = host + 1; frame < frames_; ++frame) {
      if (pair_used_[pair(host, frame)] == 0) continue;
      transfers_[pair(host, frame)] =
          frame_transfer(pose_at(blocks.pose(static_cast<std::size_t>(host))),
                         pose_at(blocks.pose(static_cast<std::size_t>(frame))), T_b_c);
    }
  }
}

VisualTerms::LandmarkState VisualTerms::state_of(const SeenLandmark& landmark,
                                                 ParameterBlocks& blocks) const {
  return {*blocks.inverse_depth(landmark.index), at_state(landmark.in_host, time_offset_).homogeneous(),
          landmark.in_host.velocity};
}

Sighting VisualTerms::sighting_at(const TimedSighting& sighting) const {
  return {.bearing = at_state(sighting.bearing, time_offset_),
          .inverse_depth = sighting.inverse_depth,
          .has_depth = sighting.has_depth};
}

/// Whitened; without a depth in the host it is nothing.
BoundedError VisualTerms::host_depth(const SeenLandmark& landmark, double lambda) const {
  if (!landmark.has_depth) return {0.0, 0.0};
  const BoundedError depth =
      bounded_error((lambda - landmark.measured) / noise_.inverse_depth, noise_.depth_outlier);
  return {depth.value, depth.slope / noise_.inverse_depth};
}

double VisualTerms::cost(ParameterBlocks& blocks) {
  place_frames(blocks);
  double total = 0.0;
  for (const SeenLandmark& landmark : landmarks_) {
    const LandmarkState state = state_of(landmark, blocks);
    const double depth = host_depth(landmark, state.lambda).value;
    total += depth * depth;
    for (int frame = landmark.host + 1; frame <= landmark.last; ++frame) {
      const FrameTransfer& to = transfers_[pair(landmark.host, frame)];
      const Eigen::Vector3d p_cj = to.R_cj_ci * state.ray + state.lambda * to.p_cj_ci;
      const ReprojectionRows rows =
          reprojection_rows(p_cj, state.lambda, sighting_at(sighting_of(landmark, frame)), noise_);
      total += cauchy_squared_ * std::log(1.0 + rows.residual.squaredNorm() / cauchy_squared_);
    }
  }
  return 0.5 * total;
}

double VisualTerms::add_to(ReducedSystem& system, ParameterBlocks& blocks) {
  place_frames(blocks);
  for (PairSum& sum : sums_) sum.setZero();
  information_.setZero();
  gradient_.setZero();
  coupling_.resize(system.layout.size() - system.layout.first_pose(), free_);
  coupling_.setZero();
  double total = 0.0;
  for (const SeenLandmark& landmark : landmarks_) total += linearize(landmark, blocks, system.layout);
  for (int host = 0; host < frames_; ++host) {
    for (int frame = host + 1; frame < frames_; ++frame) {
      if (pair_used_[pair(host, frame)] != 0) add_pair(host, frame, system);
    }
  }
  return 0.5 * total;
}

VisualTerms::SightingTerm VisualTerms::linearize(const TimedSighting& timed, const FrameTransfer& to,
                                                 const LandmarkState& host) const {
  const Eigen::Vector3d p_cj = to.R_cj_ci * host.ray + host.lambda * to.p_cj_ci;
  const ReprojectionRows at = reprojection_rows(p_cj, host.lambda, sighting_at(timed), noise_);
  const Eigen::Vector3d by_time = -(to.R_cj_ci.leftCols<2>() * host.velocity);
  SightingTerm term;
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector3d by_point = at.by_point.row(row).transpose();
    term.rows.col(row).head<3>() = host.lambda * by_point;
    term.rows.col(row).segment<3>(3) = p_cj.cross(by_point);
    term.rows(6, row) = by_point.dot(by_time);
    term.rows(7, row) = at.residual[row];
  }
  term.rows.row(6).head<2>() += timed.bearing.velocity.transpose() / noise_.bearing;
  term.by_lambda = at.by_point * to.p_cj_ci;
  term.by_lambda[2] += at.depth_by_lambda;
  return term;
}

/// @return twice the cost
double VisualTerms::linearize(const SeenLandmark& landmark, ParameterBlocks& blocks,
                              const ReducedLayout& layout) {
  const LandmarkState state = state_of(landmark, blocks);
  const BoundedError depth = host_depth(landmark, state.lambda);
  double total = depth.value * depth.value;
  double information = depth.slope * depth.slope;
  double gradient = depth.slope * depth.value;
  for (int frame = landmark.host + 1; frame <= landmark.last; ++frame) {
    const std::size_t shared = pair(landmark.host, frame);
    const SightingTerm term = linearize(sighting_of(landmark, frame), transfers_[shared], state);
    const double spread = 1.0 + term.rows.row(7).squaredNorm() / cauchy_squared_;
    total += cauchy_squared_ * std::log(spread);
    const Eigen::Matrix<double, 8, 3> weighted = term.rows / spread;
    sums_[shared].noalias() += weighted * term.rows.transpose();
    if (landmark.column < 0) continue;
    const Column8 column = weighted * term.by_lambda;
    information += term.by_lambda.squaredNorm() / spread;
    gradient += column[7];
    couple(landmark, frame, column, layout);
  }
  if (landmark.column < 0) return total;
  information_[landmark.column] = information;
  gradient_[landmark.column] = gradient;
  return total;
}

/// Brings one sighting's coupling of landmark and relative pose to the states.
void VisualTerms::couple(const SeenLandmark& landmark, int frame, const Column8& column,
                         const ReducedLayout& layout) {
  const FrameTransfer& to = transfers_[pair(landmark.host, frame)];
  const Eigen::Matrix<double, 6, 1> relative = column.head<6>();
  const Eigen::Index to_column = landmark.column;
  coupling_.block<6, 1>(6 * frame, to_column).noalias() = to.by_pose_j.transpose() * relative;
  coupling_.block<6, 1>(6 * landmark.host, to_column).noalias() += to.by_pose_i.transpose() * relative;
  if (layout.free().extrinsics) {
    const int extrinsics = layout.column({BlockKind::kExtrinsics}) - layout.first_pose();
    coupling_.block<6, 1>(extrinsics, to_column).noalias() += to.by_extrinsics.transpose() * relative;
  }
  if (layout.free().time_offset) {
    coupling_(layout.column({BlockKind::kTimeOffset}) - layout.first_pose(), to_column) += column[6];
  }
}

void VisualTerms::add_pair(int host, int frame, ReducedSystem& system) const {
  struct Side {
    int column;
    const Matrix6& map;
  };
  const FrameTransfer& to = transfers_[pair(host, frame)];
  const PairSum& sum = sums_[pair(host, frame)];
  const Side sides[] = {{system.layout.column({BlockKind::kPose, host}), to.by_pose_i},
                        {system.layout.column({BlockKind::kPose, frame}), to.by_pose_j},
                        {system.layout.column({BlockKind::kExtrinsics}), to.by_extrinsics}};
  const int time = system.layout.column({BlockKind::kTimeOffset});
  for (const Side& a : sides) {
    if (a.column < 0) continue;
    const Matrix6 left = a.map.transpose() * sum.topLeftCorner<6, 6>();
    for (const Side& b : sides) {
      if (b.column < 0 || a.column < b.column) continue;
      system.H.block<6, 6>(a.column, b.column).noalias() += left * b.map;
    }
    system.g.segment<6>(a.column).noalias() += a.map.transpose() * sum.block<6, 1>(0, 7);
    if (time >= 0) system.H.block<1, 6>(time, a.column).noalias() += sum.block<1, 6>(6, 0) * a.map;
  }
  if (time < 0) return;
  system.H(time, time) += sum(6, 6);
  system.g[time] += sum(6, 7);
}

void VisualTerms::eliminate(double damping, Eigen::Ref<RowMajorMatrix> S, Eigen::Ref<Eigen::VectorXd> rhs) {
  const Eigen::Index states = coupling_.rows();
  scaled_.resize(states, kBatch);
  for (int begin = 0; begin < free_; begin += kBatch) {
    const int count = std::min(kBatch, free_ - begin);
    int first_frame = frames_;
    for (int i = 0; i < count; ++i) {
      const int landmark = begin + i;
      first_frame = std::min(first_frame, first_frame_[static_cast<std::size_t>(landmark)]);
      const double damped = information_[landmark] * (1.0 + damping);
      const double inverse_root = damped > 0.0 ? 1.0 / std::sqrt(damped) : 0.0;
      scaled_.col(i) = inverse_root * coupling_.col(landmark);
      rhs.tail(states) += (gradient_[landmark] * inverse_root) * scaled_.col(i);
    }
    // Older landmarks touch all poses, younger ones only those from their host on.
    const Eigen::Index touched = states - 6 * first_frame;
    S.bottomRightCorner(touched, touched)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(scaled_.bottomRows(touched).leftCols(count), -1.0);
  }
}

void VisualTerms::move(const KeptVector& step, ParameterBlocks& blocks) const {
  for (const SeenLandmark& landmark : landmarks_) {
    if (landmark.column >= 0) *blocks.inverse_depth(landmark.index) += step[landmark.column];
  }
}

}  // namespace stillpoint
