// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/loop_closure.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/loop/bundle_adjustment.h"
#include "core/loop/keyframe.h"
#include "core/loop/loop_verification.h"

namespace stillpoint {
namespace {

/// Loops whose queries are at most this many keyframes apart are compared: the drift between them is small.
constexpr int kComparedKeyframes = 40;

/// Keyframes between two optimizations: at least this many, and this fraction of all, so that the time per
/// keyframe does not grow with their number.
constexpr std::size_t kMinInterval = 3;
constexpr std::size_t kIntervalDivisor = 50;

/// Standard deviation of the direction of gravity in a keyframe: an accelerometer bias of 0.05 m/s^2.
constexpr double kGravitySigma_rad = 0.3 * std::numbers::pi / 180.0;

}  // namespace

LoopClosure::LoopClosure(const LoopConfig& config, const Camera& camera, bool has_imu)
    : config_(config), camera_(camera), recognition_(config), relocalization_(config, camera) {
  if (config.dof != 4 && config.dof != 6) throw InputError("loop.dof", "is neither 4 nor 6; use one of them");
  if (config.dof == 4 && !has_imu)
    throw InputError("loop.dof", "4 requires the direction of gravity from an IMU; use 6");
  parts_.begin(segment_);
}

void LoopClosure::use_map(const KeyframeMap& map) {
  STILLPOINT_CHECK(keyframes_.empty());
  if (map.keyframes.empty()) return;
  parts_ = {};
  parts_.begin(-1);
  for (const Keyframe& keyframe : map.keyframes) {
    append(keyframe);
    drift_.add(keyframe.t, keyframe.T_w_b);
    parts_.add();
  }
  loaded_ = keyframes_.size();
  recognition_.add_all(keyframes_);
  T_m_b_ = T_w_b_;
  parts_.begin(segment_);
}

void LoopClosure::append(Keyframe keyframe) {
  features_allocated_ += keyframe.features.capacity();
  T_w_b_.push_back(keyframe.T_w_b);
  keyframes_.push_back(std::move(keyframe));
}

/// The keyframes so far become the map in which the new segment is to be located: those of parts that are not
/// located in it themselves are never used again.
void LoopClosure::enter_segment(int segment) {
  if (segment == segment_) return;
  segment_ = segment;
  if (has_new_loop_) optimize();
  for (std::size_t k = 0; k < keyframes_.size(); ++k) keyframes_[k].T_w_b = T_m_b_[k];
  recognition_.add_all(keyframes_);
  relocalization_ = Relocalization(config_, camera_);
  start_.reset();
  T_m_w_ = {};
  parts_.begin(segment);
}

Keyframe LoopClosure::describe(const DepartedKeyframe& keyframe) const {
  if (keyframe.depth.empty())
    throw InputError("loop.enabled",
                     "requires depth images, which the sequence lacks; switch loop closure off");
  return {.frame = keyframe.frame,
          .t = keyframe.t,
          .T_w_b = keyframe.T_w_b,
          .T_b_c = keyframe.T_b_c,
          .gravity_b = keyframe.gravity_b,
          .features = keyframe_features(keyframe, camera_, config_)};
}

Pose LoopClosure::add(const DepartedKeyframe& keyframe) {
  const auto start = std::chrono::steady_clock::now();
  enter_segment(keyframe.segment);
  append(describe(keyframe));
  T_m_b_.push_back(T_m_w_ * keyframe.T_w_b);
  if (parts_.is_empty()) {
    drift_.add_unrelated(keyframe.t, keyframe.T_w_b);
  } else {
    drift_.add(keyframe.t, keyframe.T_w_b, keyframe.motion_covariance);
  }
  parts_.add();
  constrain_by_start();
  find_loops();
  if (is_optimization_due()) optimize();
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  costs_.push_back({.processing_ms = elapsed.count(), .memory_bytes = memory_bytes()});
  // Corrections by loops within a part do not locate it in the map.
  return is_located() ? T_m_w_ : Pose{};
}

Pose LoopClosure::locate(const DepartedKeyframe& frame) {
  enter_segment(frame.segment);
  if (is_located()) return T_m_w_;
  start_ = relocalization_.locate(describe(frame), keyframes_, parts_, recognition_);
  if (start_) start_->record += records_.size();
  records_.insert(records_.end(), relocalization_.records().begin(), relocalization_.records().end());
  if (!start_) return {};
  move_into_map(T_m_b_[static_cast<std::size_t>(start_->match)] * start_->T_bm_bq * start_->T_w_b.inverse());
  return T_m_w_;
}

void LoopClosure::constrain_by_start() {
  if (!start_) return;
  const Keyframe& keyframe = keyframes_.back();
  OdometryDrift between;  // the keyframe may be earlier than the frame
  between.add(std::min(start_->t, keyframe.t), start_->T_w_b);
  between.add(std::max(start_->t, keyframe.t), keyframe.T_w_b);
  const GraphLoop location{
      .match = start_->match, .T_bm_bq = start_->T_bm_bq, .covariance = start_->covariance};
  loops_.push_back({.loop = with_query(location, static_cast<int>(keyframes_.size()) - 1,
                                       start_->T_w_b.inverse() * keyframe.T_w_b, between.covariance(0, 1)),
                    .record = start_->record,
                    .confirmed = true,
                    .is_start = true});
  start_.reset();
}

void LoopClosure::find_loops() {
  for (const PlaceVotes& place : recognition_.recognize(keyframes_)) {
    const auto index = static_cast<std::size_t>(place.place);
    if (!parts_.is_current(index) && !parts_.is_in_map(index)) continue;
    const Keyframe& match = keyframes_[index];
    VerifiedLoop verified = verify_loop(keyframes_.back(), match, camera_, config_);
    verified.record.votes = place.votes;
    verified.record.in_map = parts_.is_loaded(index);
    assess(verified, place.place);
    if (records_.back().outcome == LoopOutcome::kAccepted) return;
  }
}

void LoopClosure::assess(const VerifiedLoop& verified, int match) {
  records_.push_back(verified.record);
  LoopOutcome& outcome = records_.back().outcome;
  if (outcome != LoopOutcome::kAccepted) return;
  const GraphLoop loop{.match = match,
                       .query = static_cast<int>(keyframes_.size()) - 1,
                       .T_bm_bq = verified.T_bm_bq,
                       .covariance = verified.covariance};
  if (odometry_distance(loop, T_w_b_, drift_) > kMaxSquaredDistance) {
    outcome = LoopOutcome::kOdometry;
    return;
  }
  outcome = compare_with_others(loop);
  if (outcome == LoopOutcome::kPairwise) return;
  const bool confirmed = outcome == LoopOutcome::kAccepted;
  loops_.push_back({.loop = loop, .record = records_.size() - 1, .confirmed = confirmed});
  has_new_loop_ = has_new_loop_ || confirmed;
}

/// A loop is accepted with another one that agrees with it, and refused if more confirmed ones contradict it
/// than agree.
LoopOutcome LoopClosure::compare_with_others(const GraphLoop& loop) {
  std::vector<ConsistentLoop*> agreeing;
  std::size_t contradicting = 0;
  for (ConsistentLoop& other : loops_) {
    if (loop.query - other.loop.query > kComparedKeyframes || other.loop.query == loop.query) continue;
    if (!parts_.is_same_part(loop, other.loop)) continue;
    if (pairwise_distance(loop, other.loop, T_w_b_, drift_) <= kMaxSquaredDistance) {
      agreeing.push_back(&other);
    } else {
      // A wrong start must not refuse all loops that would correct it.
      contradicting += other.confirmed && !other.is_start;
    }
  }
  if (contradicting > agreeing.size()) return LoopOutcome::kPairwise;
  if (agreeing.empty()) return LoopOutcome::kUnconfirmed;
  for (ConsistentLoop* other : agreeing) {
    other->confirmed = true;
    records_[other->record].outcome = LoopOutcome::kAccepted;
  }
  return LoopOutcome::kAccepted;
}

bool LoopClosure::is_optimization_due() const {
  if (!has_new_loop_ || !is_located()) return has_new_loop_;
  const std::size_t interval = std::max(kMinInterval, keyframes_.size() / kIntervalDivisor);
  return keyframes_.size() >= keyframes_optimized_ + interval;
}

void LoopClosure::relocalize() {
  if (is_located()) return;
  const auto found = std::find_if(loops_.rbegin(), loops_.rend(), [this](const ConsistentLoop& loop) {
    return loop.confirmed && parts_.is_location(loop.loop);
  });
  if (found == loops_.rend()) return;
  const auto match = static_cast<std::size_t>(found->loop.match);
  const auto query = static_cast<std::size_t>(found->loop.query);
  move_into_map(T_m_b_[match] * found->loop.T_bm_bq * T_w_b_[query].inverse());
}

void LoopClosure::move_into_map(const Pose& T_m_w) {
  T_m_w_ = T_m_w;
  parts_.set_located(true);
  for (std::size_t k = 0; k < T_m_b_.size(); ++k) {
    if (parts_.is_current(k)) T_m_b_[k] = T_m_w_ * T_w_b_[k];
  }
}

bool LoopClosure::has_inlier_in_map() const {
  return std::ranges::any_of(loops_, [this](const ConsistentLoop& loop) {
    return parts_.is_location(loop.loop) && records_[loop.record].outcome == LoopOutcome::kAccepted;
  });
}

PoseGraph LoopClosure::build_graph() const {
  PoseGraph graph{.T_m_b = T_m_b_};
  for (const Keyframe& keyframe : keyframes_) graph.gravity_b.push_back(keyframe.gravity_b);
  for (std::size_t k = 1; k < keyframes_.size(); ++k) {
    graph.odometry.push_back({.i = static_cast<int>(k) - 1,
                              .j = static_cast<int>(k),
                              .T_i_j = T_w_b_[k - 1].inverse() * T_w_b_[k],
                              .covariance = drift_.step_covariance(k)});
  }
  for (const ConsistentLoop& loop : loops_) {
    if (!loop.confirmed) continue;
    graph.loops.push_back({.i = loop.loop.match,
                           .j = loop.loop.query,
                           .T_i_j = loop.loop.T_bm_bq,
                           .covariance = loop.loop.covariance});
  }
  return graph;
}

void LoopClosure::optimize() {
  relocalize();
  std::vector<std::size_t> records;  // of the loops of the graph
  for (const ConsistentLoop& loop : loops_) {
    if (loop.confirmed) records.push_back(loop.record);
  }
  PoseGraphSolution solution =
      optimize_pose_graph(build_graph(), {.dof = config_.dof, .gravity_sigma_rad = kGravitySigma_rad});
  for (std::size_t i = 0; i < records.size(); ++i) {
    records_[records[i]].outcome = solution.inliers[i] ? LoopOutcome::kAccepted : LoopOutcome::kPoseGraph;
  }
  T_m_b_ = std::move(solution.T_m_b);
  T_m_w_ = T_m_b_.back() * T_w_b_.back().inverse();
  keyframes_optimized_ = keyframes_.size();
  has_new_loop_ = false;
  if (!parts_.is_first_part() && is_located() && !has_inlier_in_map()) parts_.set_located(false);
}

std::optional<BundleAdjustmentSummary> LoopClosure::adjust() {
  if (!config_.final_bundle_adjustment || keyframes_.empty()) return std::nullopt;
  std::vector<GraphLoop> accepted;
  for (const ConsistentLoop& loop : loops_) {
    if (records_[loop.record].outcome == LoopOutcome::kAccepted) accepted.push_back(loop.loop);
  }
  const RelativePoseOptions noise{.inlier_threshold = kLoopInlier_px / camera_.focal_px(),
                                  .inverse_depth_sigma = kLoopInverseDepthSigma};
  BundleAdjustmentResult adjusted =
      adjust_bundle(build_graph(), keyframes_, associate_landmarks(keyframes_, T_m_b_, accepted, noise),
                    {.bearing_sigma = noise.inlier_threshold / kThresholdSigmas,
                     .inverse_depth_sigma = noise.inverse_depth_sigma,
                     .gravity_sigma_rad = kGravitySigma_rad});
  T_m_b_ = std::move(adjusted.T_m_b);
  return adjusted.summary;
}

LoopReport LoopClosure::finish() {
  if (has_new_loop_) optimize();
  LoopReport report{.loops = records_, .bundle_adjustment = adjust()};
  for (std::size_t k = loaded_; k < keyframes_.size(); ++k) {
    report.keyframes.push_back({.frame = keyframes_[k].frame,
                                .t = keyframes_[k].t,
                                .segment = parts_.segment_of(k),
                                .is_located = parts_.is_in_map(k),
                                .T_w_b = T_w_b_[k],
                                .T_m_b = T_m_b_[k],
                                .T_b_c = keyframes_[k].T_b_c,
                                .cost = costs_[k - loaded_]});
    report.relocalized = report.relocalized || (loaded_ > 0 && parts_.is_in_map(k));
  }
  if (loaded_ > 0 && !report.relocalized) return report;
  auto map = std::make_shared<KeyframeMap>();
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    if (!parts_.is_in_map(k)) continue;
    keyframes_[k].T_w_b = T_m_b_[k];
    map->keyframes.push_back(std::move(keyframes_[k]));
  }
  report.map = std::move(map);
  return report;
}

}  // namespace stillpoint
