// SPDX-License-Identifier: BSD-3-Clause
/// Compares a point cloud with that of the true surfaces (Knapitsch et al., Tanks and Temples, 2017, Sec. 4):
///
///   d(a, B)      = min_b |a - b|
///   accuracy     = mean of d(a, B) over the points a of the estimate A
///   precision    = fraction of A with d(a, B) < t
///   completeness = fraction of the truth B with d(b, A) < t, also called recall
///   F            = 2 precision completeness / (precision + completeness)
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// Nearest neighbors in a fixed set of points, by a k-d tree.
class PointTree {
 public:
  /// @param points not empty
  explicit PointTree(std::vector<Eigen::Vector3f> points);

  /// Distance to the nearest point [m].
  [[nodiscard]] double distance(const Eigen::Vector3f& query) const;

 private:
  /// A subtree: the points in [begin, end), divided along `axis`.
  struct Range {
    std::size_t begin = 0, end = 0;
    int axis = 0;

    [[nodiscard]] std::size_t middle() const { return begin + (end - begin) / 2; }
    [[nodiscard]] Range lower() const { return {begin, middle(), (axis + 1) % 3}; }
    [[nodiscard]] Range upper() const { return {middle() + 1, end, (axis + 1) % 3}; }
  };

  void sort(const Range& range);
  /// @return the smaller of `nearest_squared` and the smallest squared distance in the subtree
  [[nodiscard]] float search(const Range& range, const Eigen::Vector3f& query, float nearest_squared) const;

  std::vector<Eigen::Vector3f> points_;  ///< the median of a range along its axis is in its middle
};

struct CloudScore {
  std::size_t estimate_points = 0;
  std::size_t truth_points = 0;
  double accuracy_m = 0.0;
  double accuracy_median_m = 0.0;
  double precision = 0.0;
  double completeness = 0.0;
  double f_score = 0.0;
};

/// The transform from the world of the estimate to that of the truth by all orientations, for comparing
/// clouds: R = mean of R_w_i R_v_i^T, t = mean of p_w_i - R p_v_i. An alignment by positions alone turns a
/// map of rooms by centimeters if the camera moved little. Identity without matches.
[[nodiscard]] Pose align_worlds(MatchView matches);

/// @param estimate, truth not empty, in the same coordinates
/// @param threshold_m > 0
[[nodiscard]] CloudScore score_cloud(std::span<const Eigen::Vector3f> estimate,
                                     std::span<const Eigen::Vector3f> truth, double threshold_m);

}  // namespace stillpoint::eval
