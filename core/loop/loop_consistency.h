// SPDX-License-Identifier: BSD-3-Clause
/// Consistency of a loop with the odometry and with other loops: aliased places pass any check of a single
/// pair of images. The odometry is known with the uncertainty of its drift, and within each part of the
/// keyframes only.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/loop/keyframe.h"
#include "core/loop/loop_verification.h"

namespace stillpoint {

/// Uncertainty of the motion between keyframes by the odometry. The motion between two successive keyframes
/// has the covariance
///
///   Q = diag(s_p^2 d + e_p^2, s_r^2 d + s_t^2 dt + e_r^2) + f^2 Q_window      (p + rho, q * Exp(theta))
///
/// The first part is a random walk over the distance d [m] and the time dt [s], of errors that the window
/// does not claim (calibration, depth, moving objects), with s_p = 1 cm/sqrt(m), s_r =
/// 0.1 deg/sqrt(m), s_t = 0.02 deg/sqrt(s), e_p = 2 mm, e_r = 0.02 degrees. Q_window
/// is composed of the covariances of the motion from the oldest frame of the window to the next one, see
/// `WindowSolver::covariance`; zero where it is not known (without `backend.covariance`, in a loaded map, at
/// the end of a run), and scaled down to at most 1 cm and 0.3 degrees: where people hide the scene the window
/// claims meters for a fifth of a second, along directions that a linear covariance does not describe, and
/// loops bent such motions. f = 3, as the published prior counts observations repeatedly. An error (rho,
/// theta) of the motion from k to k+1 moves all later poses by the displacement v + phi x p of the world with
///
///   phi = R_w,k+1 theta,   v = R_w,k rho - phi x p_k+1
///
/// so the covariances of (v, phi) add up, and that of the motion between any two keyframes follows from the
/// difference of two sums (Barfoot and Furgale 2014, Sec. III: uncertainty of compound poses, first order).
class OdometryDrift {
 public:
  /// Appends the next keyframe: its pose by the odometry.
  /// @param motion_covariance Q_window of the motion from the keyframe before; absent if it is not known
  void add(Timestamp t, const Pose& T_w_b, const std::optional<Matrix6>& motion_covariance = {});

  /// Appends the first keyframe of another run or segment, whose pose relative to the previous ones is
  /// unknown: Q has standard deviations of 1 km and 10 rad.
  void add_unrelated(Timestamp t, const Pose& T_w_b);

  /// Covariance Q of the motion from keyframe k - 1 to k, k > 0.
  [[nodiscard]] const Matrix6& step_covariance(std::size_t k) const { return steps_[k]; }

  /// Covariance of T_bi_bj, i < j: (p + rho, q * Exp(theta)).
  [[nodiscard]] Matrix6 covariance(std::size_t i, std::size_t j) const;

 private:
  [[nodiscard]] Matrix6 step(Timestamp t, const Pose& T_w_b,
                             const std::optional<Matrix6>& motion_covariance) const;
  void append(Timestamp t, const Pose& T_w_b, const Matrix6& step);

  std::vector<Timestamp> times_;
  std::vector<Pose> T_w_b_;
  std::vector<Matrix6> steps_;  ///< Q of the motion to each keyframe; zero for keyframe 0
  std::vector<Matrix6> sums_;   ///< of (v, phi), from keyframe 0
};

/// Loops farther from the odometry or from another loop are refused (squared Mahalanobis distance): 99.99 %
/// quantile of the chi-square distribution with 6 degrees of freedom.
inline constexpr double kMaxSquaredDistance = 27.9;

/// A verified loop between two keyframes of the graph.
struct GraphLoop {
  int match = 0;
  int query = 0;
  Pose T_bm_bq;
  Matrix6 covariance = Matrix6::Identity();  ///< p + rho, q * Exp(theta)
};

/// The loop from another query: T_bm_bk = T_bm_bq T_bq_bk.
/// @param query the keyframe k
/// @param covariance of `T_bq_bk`: p + rho, q * Exp(theta)
[[nodiscard]] GraphLoop with_query(const GraphLoop& loop, int query, const Pose& T_bq_bk,
                                   const Matrix6& covariance);

/// Squared Mahalanobis distance between a loop and the motion of the odometry. Chi-square distributed with 6
/// degrees of freedom if the loop is true.
/// @param T_w_b poses of the keyframes by the odometry
[[nodiscard]] double odometry_distance(const GraphLoop& loop, std::span<const Pose> T_w_b,
                                       const OdometryDrift& drift);

/// Squared Mahalanobis distance between two loops (Mangelson et al. 2018, Eq. (3)): of the cycle
///
///   T_q_q' T_q'_m' T_m'_m T_m_q
///
/// from the identity, where the motions q to q' and m to m' are those of the odometry, so that only the drift
/// over these short parts enters, and not that over the loops.
/// @param T_w_b poses of the keyframes by the odometry
[[nodiscard]] double pairwise_distance(const GraphLoop& a, const GraphLoop& b, std::span<const Pose> T_w_b,
                                       const OdometryDrift& drift);

/// Parts of the keyframes: a loaded map, and the segments of the run. Each has an odometry of its own; the
/// motion between two parts is not known until a later one is located in the map.
class KeyframeParts {
 public:
  /// Begins the part of the next keyframes. The first one determines the frame of the map and is located.
  /// @param segment of the run; -1: a loaded map
  void begin(int segment) { parts_.push_back({.segment = segment, .located = parts_.empty()}); }

  /// Appends the next keyframe to the current part.
  void add() { part_of_.push_back(parts_.size() - 1); }

  /// Whether the poses of the current part are known in the map.
  void set_located(bool located) { parts_.back().located = located; }
  [[nodiscard]] bool is_located() const { return parts_.back().located; }

  [[nodiscard]] bool is_first_part() const { return parts_.size() == 1; }
  /// Whether the current part has no keyframe yet.
  [[nodiscard]] bool is_empty() const { return part_of_.empty() || part_of_.back() + 1 != parts_.size(); }

  [[nodiscard]] int segment_of(std::size_t keyframe) const { return parts_[part_of_[keyframe]].segment; }
  [[nodiscard]] bool is_loaded(std::size_t keyframe) const { return segment_of(keyframe) < 0; }
  [[nodiscard]] bool is_current(std::size_t keyframe) const {
    return part_of_[keyframe] + 1 == parts_.size();
  }
  [[nodiscard]] bool is_in_map(std::size_t keyframe) const { return parts_[part_of_[keyframe]].located; }
  [[nodiscard]] bool is_same_part(std::size_t i, std::size_t j) const { return part_of_[i] == part_of_[j]; }
  /// Whether a loop locates the current part in the map.
  [[nodiscard]] bool is_location(const GraphLoop& loop) const {
    return is_current(static_cast<std::size_t>(loop.query)) &&
           is_reference(static_cast<std::size_t>(loop.match));
  }
  /// Whether the odometry knows the motion between the queries of two loops, and that between the matches.
  [[nodiscard]] bool is_same_part(const GraphLoop& a, const GraphLoop& b) const {
    const auto is_same = [this](int i, int j) {
      return is_same_part(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    };
    return is_same(a.match, b.match) && is_same(a.query, b.query);
  }
  /// A keyframe of another part by which the current one can be located.
  [[nodiscard]] bool is_reference(std::size_t keyframe) const {
    return is_in_map(keyframe) && !is_current(keyframe);
  }

 private:
  struct Part {
    int segment = 0;
    bool located = false;
  };
  std::vector<Part> parts_;
  std::vector<std::size_t> part_of_;  ///< of each keyframe
};

}  // namespace stillpoint
