// SPDX-License-Identifier: BSD-3-Clause
/// Reprojection residual of a landmark between its host frame i and another frame j, and its derivatives with
/// respect to the point in camera j; shared by the Ceres factor and the Schur solver.
///
/// Two rows of bearing error and, with a measured depth, one of inverse depth. Qin et al. 2018, Eq. (25), on
/// the normalized image plane instead of the unit sphere. With the bearings u_i, u_j and their velocities, td
/// the time offset, e_k the row readout offset minus the time offset at which state k is defined, k the
/// inverse depth scale (ratio of true to measured depth), and lambda the inverse depth in the host:
///
///   u_k(td) = u_k - (td + e_k) du_k/dt,  k = i, j         (shifted to the time of the state)
///   P       = T_c_b T_bj_w T_w_bi T_b_c [u_i(td); 1; lambda]
///   r_u     = (P_xy / P_z - u_j(td)) / sigma_u
///   r_d     = rho((k lambda / P_z - lambda_j) / sigma_d),   rho(d) = d / sqrt(1 + (d/c)^2)
///
/// P is homogeneous: lambda times the point in camera j.
/// lambda_j is the inverse depth measured in j; lambda / P_z is the true one. The scale is a
/// factor on the prediction: one on the measurement would scale its noise, and the cost would decrease with
/// it. It is the inverse scale because a path is k times as long as measured, which remains true in a prior
/// that is linearized at another k. The
/// bounded rho (Geman & McClure 1985) keeps a depth measured across an object's edge from outweighing the
/// bearing.
///
/// If the lens differs from that of the rig, with c = (f, k1, cx, cy) and the bearing s that its camera
/// gives,
///
///   u = s (1 + f + k1 |s|^2) + (cx, cy),    du/dc = [s  s |s|^2  I]:
///
/// f is the relative error of the stated focal length, k1 what the radial distortion lacks, (cx, cy) the
/// principal point that is stated minus the true one, in focal lengths. The noise of the bearing is magnified
/// with it, by the mean of the radial and the tangential derivative:
///
///   sigma_u -> g_j sigma_u,    g = 1 + f + 2 k1 |s|^2,    dr_u/dc = -[s_j  s_j |s_j|^2  I] / (g_j sigma_u)
///                                                                    - r_u (1, 2 |s_j|^2, 0, 0) / g_j
///
/// With sigma_u alone a longer focal length would have less noise, and be found where there is little
/// parallax: 5 % on a robot that drives slowly.
///
/// Scaling the point by lambda removes the pole at infinity: the residual is defined for every inverse depth,
/// including zero and negative values, and for points behind camera j. One outlier therefore cannot make the
/// solver reject a step.
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace stillpoint {

/// Standard deviations by which the rows are whitened.
struct ReprojectionNoise {
  double bearing = 1.0;        ///< of a bearing [normalized image plane]
  double inverse_depth = 1.0;  ///< of a measured inverse depth [1/m]
  double depth_outlier = 2.0;  ///< the depth row saturates at this many standard deviations
};

/// du/dc. @param seen s
[[nodiscard]] inline Eigen::Matrix<double, 2, 4> lens_jacobian(const Eigen::Vector2d& seen) {
  Eigen::Matrix<double, 2, 4> J;
  J << seen, seen * seen.squaredNorm(), Eigen::Matrix2d::Identity();
  return J;
}
[[nodiscard]] inline Eigen::Vector2d corrected_bearing(const Eigen::Vector2d& seen,
                                                       const Eigen::Vector4d& lens) {
  if (lens.isZero(0.0)) return seen;  // also where the square of the bearing overflows
  return seen + lens_jacobian(seen) * lens;
}

/// g, and dg/dc. @param seen s
[[nodiscard]] inline double lens_noise_ratio(const Eigen::Vector2d& seen, const Eigen::Vector4d& lens) {
  return lens.isZero(0.0) ? 1.0 : 1.0 + lens[0] + 2.0 * lens[1] * seen.squaredNorm();
}
[[nodiscard]] inline Eigen::RowVector4d lens_noise_gradient(const Eigen::Vector2d& seen) {
  return {1.0, 2.0 * seen.squaredNorm(), 0.0, 0.0};
}

/// Bounded error rho(d) = d / sqrt(1 + (d/c)^2) of a whitened error d (Geman & McClure 1985), |rho| < c, and
/// its derivative rho'(d).
struct BoundedError {
  double value;
  double slope;
};
[[nodiscard]] inline BoundedError bounded_error(double d, double c) {
  const double inner = 1.0 + d * d / (c * c);
  const double root = std::sqrt(inner);
  return {d / root, 1.0 / (inner * root)};
}

/// Measurement of a landmark in frame j.
struct MeasuredPoint {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< at the time of the state, normalized image plane
  double noise_ratio = 1.0;                           ///< g
  double inverse_depth = 0.0;                         ///< measured [1/m]
  double inverse_depth_scale = 1.0;                   ///< ratio of true to measured depth
  bool has_depth = false;                             ///< whether the depth row is evaluated
};

/// Whitened rows: two of bearing and one of inverse depth, the latter zero without a depth measurement.
struct ReprojectionRows {
  Eigen::Vector3d residual;
  Eigen::Matrix3d J_point;      ///< with respect to the scaled point P in camera j
  double J_depth_lambda = 0.0;  ///< depth row: partial derivative by lambda at constant P
  double J_depth_scale = 0.0;   ///< depth row: derivative by the inverse depth scale
};

/// Lower clamp of P_z, the ratio of the depths in j and in the host: smaller values, including points behind
/// camera j, are evaluated at this ratio.
inline constexpr double kMinDepthRatio = 0.01;

/// @param p_cj P: the landmark in camera j times its inverse depth `lambda` in the host
[[nodiscard]] inline ReprojectionRows reprojection_rows(const Eigen::Vector3d& p_cj, double lambda,
                                                        const MeasuredPoint& observation,
                                                        const ReprojectionNoise& noise) {
  const bool in_front = p_cj.z() > kMinDepthRatio;
  const double inverse_z = 1.0 / (in_front ? p_cj.z() : kMinDepthRatio);
  const double dlog_dz = in_front ? -inverse_z : 0.0;  // d log(1/z) / dz
  const double weight = 1.0 / (noise.bearing * observation.noise_ratio);
  const Eigen::Vector2d projected = p_cj.head<2>() * inverse_z;

  ReprojectionRows rows;
  rows.residual.head<2>() = weight * (projected - observation.bearing);
  rows.residual[2] = 0.0;
  rows.J_point << weight * inverse_z, 0.0, weight * projected.x() * dlog_dz,  //
      0.0, weight * inverse_z, weight * projected.y() * dlog_dz,              //
      0.0, 0.0, 0.0;
  if (observation.has_depth) {
    const double scaled_inverse_z = inverse_z * observation.inverse_depth_scale;
    const double inverse_depth = lambda * scaled_inverse_z;
    const BoundedError depth =
        bounded_error((inverse_depth - observation.inverse_depth) / noise.inverse_depth, noise.depth_outlier);
    const double slope = depth.slope / noise.inverse_depth;
    rows.residual[2] = depth.value;
    rows.J_point(2, 2) = slope * inverse_depth * dlog_dz;
    rows.J_depth_lambda = slope * scaled_inverse_z;
    rows.J_depth_scale = slope * lambda * inverse_z;
  }
  return rows;
}

}  // namespace stillpoint
