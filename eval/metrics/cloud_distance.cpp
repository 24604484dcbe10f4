// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/cloud_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::eval {

PointTree::PointTree(std::vector<Eigen::Vector3f> points) : points_(std::move(points)) {
  STILLPOINT_CHECK(!points_.empty());
  sort({.begin = 0, .end = points_.size()});
}

void PointTree::sort(const Range& range) {
  if (range.end - range.begin < 2) return;
  const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(range.begin), at(range.middle()), at(range.end),
                   [axis = range.axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  sort(range.lower());
  sort(range.upper());
}

float PointTree::search(const Range& range, const Eigen::Vector3f& query, float nearest_squared) const {
  if (range.begin == range.end) return nearest_squared;
  const Eigen::Vector3f& point = points_[range.middle()];
  const float offset = query[range.axis] - point[range.axis];
  nearest_squared = std::min(nearest_squared, (point - query).squaredNorm());
  nearest_squared = search(offset < 0.0F ? range.lower() : range.upper(), query, nearest_squared);
  if (offset * offset >= nearest_squared) return nearest_squared;
  return search(offset < 0.0F ? range.upper() : range.lower(), query, nearest_squared);
}

double PointTree::distance(const Eigen::Vector3f& query) const {
  const float nearest_squared =
      search({.begin = 0, .end = points_.size()}, query, std::numeric_limits<float>::max());
  return std::sqrt(static_cast<double>(nearest_squared));
}

namespace {

std::vector<double> distances_to(std::span<const Eigen::Vector3f> points,
                                 std::span<const Eigen::Vector3f> others) {
  const PointTree tree({others.begin(), others.end()});
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const Eigen::Vector3f& point : points) distances.push_back(tree.distance(point));
  return distances;
}

double fraction_below(const std::vector<double>& distances, double threshold) {
  const auto below =
      std::ranges::count_if(distances, [threshold](double distance) { return distance < threshold; });
  return static_cast<double>(below) / static_cast<double>(distances.size());
}

}  // namespace

Pose align_worlds(MatchView matches) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const MatchedPose& match : matches) {
    const Eigen::Vector4d q = (match.gt.q * match.est.q.conjugate()).coeffs();
    sum += q.dot(sum) < 0.0 ? Eigen::Vector4d(-q) : q;
  }
  if (sum.isZero(0.0)) return {};
  Pose T{Eigen::Quaterniond(sum).normalized(), Eigen::Vector3d::Zero()};
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (const MatchedPose& match : matches) offset += match.gt.p - T.q * match.est.p;
  T.p = offset / static_cast<double>(matches.size());
  return T;
}

CloudScore score_cloud(std::span<const Eigen::Vector3f> estimate, std::span<const Eigen::Vector3f> truth,
                       double threshold_m) {
  STILLPOINT_CHECK(!estimate.empty() && !truth.empty() && threshold_m > 0.0);
  const std::vector<double> of_estimate = distances_to(estimate, truth);
  const Statistics distances = *statistics(of_estimate);
  const double precision = fraction_below(of_estimate, threshold_m);
  const double completeness = fraction_below(distances_to(truth, estimate), threshold_m);
  const double sum = precision + completeness;
  return {.estimate_points = estimate.size(),
          .truth_points = truth.size(),
          .accuracy_m = distances.mean,
          .accuracy_median_m = distances.median,
          .precision = precision,
          .completeness = completeness,
          .f_score = sum > 0.0 ? 2.0 * precision * completeness / sum : 0.0};
}

}  // namespace stillpoint::eval
