// SPDX-License-Identifier: BSD-3-Clause
/// Associated poses of ground truth and estimate: as structs, or computed where they are read, so that the
/// pairs of 10^7 poses do not take more memory than the trajectories.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "eval/trajectory/association.h"

namespace stillpoint::eval {

/// Ground truth and estimate at the stamp of the estimate.
struct MatchedPose {
  Timestamp t;  ///< of the estimate, as written in its file
  Pose gt;      ///< T_w_f, w the world of the ground truth
  Pose est;     ///< T_v_f, v the world of the estimate
};

/// x_w = scale * R_w_v * x_v + p_w_v: from the world v of the estimate to the world w of the ground truth.
struct Similarity {
  Pose T_w_v;
  double scale = 1.0;

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& x_v) const {
    return T_w_v.q * (scale * x_v) + T_w_v.p;
  }
  [[nodiscard]] Pose operator*(const Pose& T_v_f) const {
    return Pose{(T_w_v.q * T_v_f.q).normalized(), *this * T_v_f.p};
  }
};

/// The matched poses of pairs, each computed when it is read: 8 bytes per pair of indices, 16 per
/// interpolated pair and 32 more for its interpolated rotation, instead of the 144 of a `MatchedPose`. Refers
/// to both trajectories, which must outlive it.
class PoseMatches {
 public:
  PoseMatches(const Trajectory& gt, const Trajectory& est, std::vector<IndexPair> pairs);

  /// Ground truth by slerp of the rotation and linear interpolation of the position.
  PoseMatches(const Trajectory& gt, const Trajectory& est, std::vector<InterpolatedPair> pairs);

  [[nodiscard]] std::size_t size() const { return pairs_.empty() ? interpolated_.size() : pairs_.size(); }
  [[nodiscard]] MatchedPose operator[](std::size_t i) const {
    const Pose& est = est_pose(i).T_w_f;
    return {time(i), gt_pose(i), is_aligned_ ? S_w_v_ * est : est};
  }
  [[nodiscard]] Timestamp time(std::size_t i) const {
    const Timestamp t = est_pose(i).t;
    return offset_s_ == 0.0 ? t : after(t, offset_s_);
  }

  /// From now on, the estimated poses are those in the world of the ground truth.
  void align(const Similarity& S_w_v) {
    S_w_v_ = S_w_v;
    is_aligned_ = true;
  }

  /// From now on, `offset_s` is added to the stamps.
  void shift(double offset_s) { offset_s_ = offset_s; }

 private:
  [[nodiscard]] static bool is_between(const InterpolatedPair& pair) { return pair.fraction > 0.0; }

  [[nodiscard]] Pose gt_pose(std::size_t i) const {
    if (interpolated_.empty()) return gt_[pairs_[i].gt].T_w_f;
    const InterpolatedPair& pair = interpolated_[i];
    const Pose& from = gt_[pair.gt].T_w_f;
    if (!is_between(pair)) return from;
    return {q_gt_[i], (1.0 - pair.fraction) * from.p + pair.fraction * gt_[pair.gt + 1].T_w_f.p};
  }
  [[nodiscard]] const StampedPose& est_pose(std::size_t i) const {
    return est_[interpolated_.empty() ? pairs_[i].est : interpolated_[i].est];
  }

  const std::vector<StampedPose>& gt_;
  const std::vector<StampedPose>& est_;
  std::vector<IndexPair> pairs_;
  std::vector<InterpolatedPair> interpolated_;
  std::vector<Eigen::Quaterniond> q_gt_;  ///< interpolated rotations; empty if all fractions are 0
  Similarity S_w_v_;
  bool is_aligned_ = false;
  double offset_s_ = 0.0;
};

/// A list of matched poses that refers to structs or to `PoseMatches`, which must outlive it.
class MatchView {
 public:
  MatchView(std::span<const MatchedPose> poses)  // NOLINT(google-explicit-constructor): a view, as std::span
      : poses_(poses.data()), size_(poses.size()) {}
  MatchView(const std::vector<MatchedPose>& poses)  // NOLINT(google-explicit-constructor)
      : MatchView(std::span<const MatchedPose>(poses)) {}
  MatchView(const PoseMatches& matches)  // NOLINT(google-explicit-constructor)
      : matches_(&matches), size_(matches.size()) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] MatchedPose operator[](std::size_t i) const {
    return matches_ == nullptr ? poses_[i] : (*matches_)[i];
  }
  [[nodiscard]] Timestamp time(std::size_t i) const {
    return matches_ == nullptr ? poses_[i].t : matches_->time(i);
  }
  [[nodiscard]] MatchedPose front() const { return (*this)[0]; }
  [[nodiscard]] MatchedPose back() const { return (*this)[size_ - 1]; }

  /// The first `count` matches; there are at least as many.
  [[nodiscard]] MatchView first(std::size_t count) const {
    MatchView part = *this;
    part.size_ = count;
    return part;
  }

  class Iterator {
   public:
    Iterator(const MatchView& view, std::size_t index) : view_(view), index_(index) {}
    [[nodiscard]] MatchedPose operator*() const { return view_[index_]; }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    friend bool operator!=(const Iterator& a, const Iterator& b) { return a.index_ != b.index_; }

   private:
    const MatchView& view_;
    std::size_t index_;
  };
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }

 private:
  const MatchedPose* poses_ = nullptr;
  const PoseMatches* matches_ = nullptr;
  std::size_t size_ = 0;
};

/// The poses of the pairs.
[[nodiscard]] std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                                     std::span<const IndexPair> pairs);

/// The poses of the pairs; ground truth by slerp of the rotation and linear interpolation of the position.
[[nodiscard]] std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                                     std::span<const InterpolatedPair> pairs);

}  // namespace stillpoint::eval
