// SPDX-License-Identifier: BSD-3-Clause
/// Consistency of the errors that a system claims with its true ones: whether it knows when its pose is
/// wrong, how it recovers from sensor faults (`honesty`), and whether its covariances are of the right size
/// (`nees`).
///
/// For frame k: E_k the reported pose in the world frame of its segment, G_k the true one, s_k and r_k the
/// claimed standard deviations of position and rotation. S aligns the located poses before the first fault
/// (all of them without a fault) rigidly, with the rotation of their positions, or of their orientations if
/// these determine it better (few, straight or standing poses). With the position errors e_k and rotation
/// errors theta_k after S, and their largest values e_0, theta_0 before the fault (if it begins with the
/// first frame: S aligns all located poses of the first segment, theta_k are the angles after their mean
/// rotation, because positions within a small space do not determine one, and e_0 = theta_0 = 0), the excess
/// is max(0, e_k - e_0), likewise for the rotation. A pose is wrong if its excess is beyond both 5 cm and 3
/// s_k, or beyond both 2 degrees and 3 r_k. A pose of a later segment is in another world: it is neither
/// wrong nor right. Claims are relative to the first pose, and an alignment of all poses moves it: if the
/// fault begins with the first frame, the mean of the s_k of the aligned poses, which is at least the
/// deviation of the alignment, is added to s_k in quadrature, likewise to r_k.
///
///   false confidence      fraction of all frames that are located (tracking, degraded, relocated) and wrong
///   missed availability   fraction of all frames after the first located one that are lost although the
///                         excess is below 5 cm and 2 degrees
///   time to detect        from the first wrong pose after the begin of a fault to the first frame that is
///                         not located; 0 if the loss is reported before
///   time to recover       from the end of the last fault to the first located pose that is not wrong in the
///                         first segment; a fault that lasts to the last frame ends at its begin
///   error after recovery  RMSE of e_k of the located poses of the first segment from then on
///
/// Normalized estimation error squared (NEES), of the rotation and of the position:
///
///   e_R = -Log(R_g R_e^T),  e_p = p_g - p_e,  NEES_R = e_R^T P_R^-1 e_R,  NEES_p = e_p^T P_p^-1 e_p
///
/// R_g, p_g: ground truth; R_e, p_e: estimate; P_R, P_p: covariances of rotation and position. Signs and
/// frames as in OpenVINS ov_eval; definition: Bar-Shalom et al., "Estimation with Applications to Tracking
/// and Navigation", 2001, Sec. 5.4.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "core/types/trajectory.h"
#include "eval/metrics/ate.h"

namespace stillpoint::eval {

enum class PoseClaim { kNone, kLocated, kDeadReckoning, kLost };

/// What a system reported for one frame.
struct ClaimedPose {
  Timestamp t;
  Pose T_w_c;
  PoseClaim claim = PoseClaim::kNone;  ///< kNone: not started
  int segment = 0;
  double sigma_m = 0.0;    ///< along the least certain direction; 0 = not reported
  double sigma_rad = 0.0;  ///< same
  /// Of the position [m^2] and of the rotation Exp(e) R_w_c [rad^2], in the world frame; zero = not reported.
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();
};

struct Honesty {
  double false_confidence = 0.0;
  double missed_availability = 0.0;
  std::optional<double> time_to_detect_s;        ///< nullopt if no pose was wrong after the begin of a fault
  std::optional<double> time_to_recover_s;       ///< nullopt without a fault or a recovery
  std::optional<double> error_after_recovery_m;  ///< nullopt without a recovery
};

/// @param gt true poses of the same body frame
/// @param claims one per frame, in order of time
/// @param faults in order of time; may be empty
/// @return nullopt if fewer than ten of the located frames that S aligns have a true pose
[[nodiscard]] std::optional<Honesty> honesty(const Trajectory& gt, std::span<const ClaimedPose> claims,
                                             std::span<const TimeSpan> faults);

/// Median over the located frames of 3 s_k [m]; nullopt if no standard deviation is claimed.
[[nodiscard]] std::optional<double> claimed_three_sigma_m(std::span<const ClaimedPose> claims);

/// The expectation of each is 3 (its degrees of freedom) for a consistent estimator.
struct Nees {
  double rotation = 0.0;
  double position = 0.0;
};

/// @param gt, est in the same world frame: align them first
/// @param rotation_covariance P_R [rad^2] of e_R, expressed in the world frame; positive definite
/// @param position_covariance P_p [m^2]; positive definite
/// @throws InputError if a covariance is not positive definite
[[nodiscard]] Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
                        const Eigen::Matrix3d& position_covariance);

/// Means over frames of NEES / 3: 1 for a consistent estimator, more if it claims too small an error.
struct MeanNees {
  double rotation = 0.0;
  double position = 0.0;
};

/// Mean over the located poses E_k of the first segment from 3 s after the first one, E_0, on. Claimed
/// covariances are relative to the first pose, so the true poses are E_0 G_0^-1 G_k, without an alignment
/// over the trajectory; they are interpolated to the time of the frame.
/// @param gt true poses of the same body frame
/// @param claims one per frame, in order of time; those without a positive definite covariance do not count
/// @return nullopt if no frame counts
[[nodiscard]] std::optional<MeanNees> mean_nees(const Trajectory& gt, std::span<const ClaimedPose> claims);

/// Errors of the position or of the rotation against their claimed covariances.
struct ClaimQuality {
  double nees = 0.0;  ///< mean of NEES / 3
  /// Interval that contains `nees` of a consistent system with a probability of 95 %: of a chi-square
  /// distribution with 3 N / (1 + 2 sum rho_k) degrees of freedom, divided by them. rho_k: autocorrelation of
  /// the NEES of N poses at lag k, up to the first that is not positive: errors of consecutive poses are not
  /// independent.
  double nees_low = 0.0;
  double nees_high = 0.0;
  double nll = 0.0;  ///< mean of (NEES + log det P + 3 log 2 pi) / 2, of errors in m or rad
  double within_3_sigma =
      0.0;  ///< fraction of the components with |e_i| <= 3 sqrt(P_ii); .9973 of a normal error
};

struct CovarianceScore {
  std::size_t poses = 0;  ///< that count
  ClaimQuality position;
  ClaimQuality rotation;
};

/// What claimed covariances are relative to.
enum class ClaimOrigin {
  kFirstPose,  ///< as in `mean_nees`
  kWorld,      ///< the world of the ground truth, which is that of the estimate
};

/// Over the poses that `mean_nees` counts.
/// @return nullopt if no pose counts
[[nodiscard]] std::optional<CovarianceScore> covariance_score(const Trajectory& gt,
                                                              std::span<const ClaimedPose> claims,
                                                              ClaimOrigin origin = ClaimOrigin::kFirstPose);

}  // namespace stillpoint::eval
