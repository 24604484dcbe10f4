// SPDX-License-Identifier: BSD-3-Clause
/// The rows of one reprojection residual and how they follow the point that camera j sees: what the factor
/// and the Schur solver share.
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace stillpoint {

/// Standard deviations that scale the rows.
struct ReprojectionNoise {
  double bearing = 1.0;        ///< of a bearing [normalised plane]
  double inverse_depth = 1.0;  ///< of a measured inverse depth [1/m]
  double depth_outlier = 2.0;  ///< the depth row saturates at this many standard deviations
};

/// A whitened depth error, bounded at `c`: d / sqrt(1 + (d/c)^2) (Geman & McClure 1985), and the bound's
/// slope.
struct BoundedError {
  double value;
  double slope;
};
[[nodiscard]] inline BoundedError bounded_error(double d, double c) {
  const double inner = 1.0 + d * d / (c * c);
  const double root = std::sqrt(inner);
  return {d / root, 1.0 / (inner * root)};
}

/// What frame j saw of a landmark.
struct Sighting {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< at the state's time, normalised plane
  double inverse_depth = 0.0;                         ///< measured [1/m]
  bool has_depth = false;                             ///< whether the third row is wanted
};

/// Whitened rows: two of bearing and one of inverse depth, the latter zero unless wanted.
struct ReprojectionRows {
  Eigen::Vector3d residual;
  Eigen::Matrix3d by_point;      ///< derivatives with respect to the point times its inverse depth
  double depth_by_lambda = 0.0;  ///< of the depth row by the inverse depth, beyond what the point tells
};

/// Ratio of the depths in j and in the host below which the point counts as in the plane of camera j: nearer
/// ones, and those behind it, are read as if they lay there.
inline constexpr double kMinDepthRatio = 0.01;

/// @param p_cj the landmark in camera j times its inverse depth `lambda` in the host
[[nodiscard]] inline ReprojectionRows reprojection_rows(const Eigen::Vector3d& p_cj, double lambda,
                                                        const Sighting& sighting,
                                                        const ReprojectionNoise& noise) {
  const bool before_camera = p_cj.z() > kMinDepthRatio;
  const double inverse_z = 1.0 / (before_camera ? p_cj.z() : kMinDepthRatio);
  const double by_z = before_camera ? -inverse_z : 0.0;  // d log(1/z) / dz
  const double weight = 1.0 / noise.bearing;
  const Eigen::Vector2d seen = p_cj.head<2>() * inverse_z;

  ReprojectionRows rows;
  rows.residual.head<2>() = weight * (seen - sighting.bearing);
  rows.residual[2] = 0.0;
  rows.by_point << weight * inverse_z, 0.0, weight * seen.x() * by_z,  //
      0.0, weight * inverse_z, weight * seen.y() * by_z,               //
      0.0, 0.0, 0.0;
  if (sighting.has_depth) {
    const double inverse_depth = lambda * inverse_z;
    const BoundedError depth =
        bounded_error((inverse_depth - sighting.inverse_depth) / noise.inverse_depth, noise.depth_outlier);
    const double slope = depth.slope / noise.inverse_depth;
    rows.residual[2] = depth.value;
    rows.by_point(2, 2) = slope * inverse_depth * by_z;
    rows.depth_by_lambda = slope * inverse_z;
  }
  return rows;
}

}  // namespace stillpoint
