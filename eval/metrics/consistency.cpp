// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/consistency.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/association.h"

namespace stillpoint::eval {
namespace {

constexpr double kWrong_m = 0.05;
constexpr double kWrong_rad = 2.0 * M_PI / 180.0;
constexpr double kSigmas = 3.0;
constexpr std::size_t kMinAligned = 10;
constexpr double kMaxTruthDistance_s = 0.05;

/// A frame with a true pose, and its errors after alignment.
struct Assessed {
  const ClaimedPose* pose = nullptr;
  Pose truth;
  double error_m = 0.0;
  double error_rad = 0.0;
  bool small = false;  ///< excess below the absolute limits
  bool wrong = false;

  [[nodiscard]] bool located() const { return pose->claim == PoseClaim::kLocated; }
  [[nodiscard]] bool first_world() const { return pose->segment == 0; }
};

/// True pose closest in time; nullopt if none is near.
std::optional<Pose> truth_at(const Trajectory& gt, Timestamp t) {
  const auto later = std::ranges::lower_bound(gt.poses, t, {}, &StampedPose::t);
  const StampedPose* nearest = nullptr;
  if (later != gt.poses.end()) nearest = &*later;
  if (later != gt.poses.begin()) {
    const StampedPose& before = *std::prev(later);
    if (nearest == nullptr || seconds_between(before.t, t) < seconds_between(t, nearest->t))
      nearest = &before;
  }
  if (nearest == nullptr || std::abs(seconds_between(nearest->t, t)) > kMaxTruthDistance_s)
    return std::nullopt;
  return nearest->T_w_f;
}

std::vector<Assessed> with_truth(const Trajectory& gt, std::span<const ClaimedPose> claims) {
  std::vector<Assessed> frames;
  for (const ClaimedPose& claim : claims) {
    const std::optional<Pose> truth = truth_at(gt, claim.t);
    if (truth) frames.push_back({.pose = &claim, .truth = *truth});
  }
  return frames;
}

/// Mean of the rotations R_g R_e^T: normalized sum of quaternions with the sign of the first one.
Eigen::Quaterniond mean_rotation(std::span<const MatchedPose> poses) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const MatchedPose& pose : poses) {
    const Eigen::Vector4d q = (pose.gt.q * pose.est.q.conjugate()).coeffs();
    sum += sum.dot(q) < 0.0 ? Eigen::Vector4d(-q) : q;
  }
  return Eigen::Quaterniond(Eigen::Vector4d(sum.normalized()));
}

/// The alignment of the reference poses: by their positions, unless their orientations determine the rotation
/// better. Few, straight or standing poses leave it to the noise of the positions, and the error grows with
/// the distance from them. Standard deviations of the rotation: RMSE of the positions over the extension of
/// the path across its direction, and RMS of the rotations from their mean.
Similarity aligned_by_best(std::span<const MatchedPose> reference) {
  Similarity by_positions = align(reference, Alignment::kSe3).S_w_v;
  const Eigen::Quaterniond mean = mean_rotation(reference);
  const double count = static_cast<double>(reference.size());
  Eigen::Vector3d mean_gt = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  for (const MatchedPose& pose : reference) {
    mean_gt += pose.gt.p / count;
    mean_est += pose.est.p / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double squared_m = 0.0, squared_rad = 0.0;
  for (const MatchedPose& pose : reference) {
    covariance += (pose.gt.p - mean_gt) * (pose.gt.p - mean_gt).transpose() / count;
    squared_m += (by_positions * pose.est.p - pose.gt.p).squaredNorm() / count;
    squared_rad += std::pow(pose.gt.q.angularDistance(mean * pose.est.q), 2) / count;
  }
  const double across = std::max(eigenvalues(covariance)(1), 0.0);
  if (squared_m <= squared_rad * across) return by_positions;
  return {Pose{mean, mean_gt - mean * mean_est}};
}

/// Means of the deviations claimed for the poses that were aligned: those of the alignment itself, at most.
struct AlignmentClaim {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

AlignmentClaim claim_of_alignment(const std::vector<Assessed>& frames) {
  AlignmentClaim sum;
  int count = 0;
  for (const Assessed& frame : frames) {
    if (!frame.located() || !frame.first_world()) continue;
    sum.sigma_m += frame.pose->sigma_m;
    sum.sigma_rad += frame.pose->sigma_rad;
    ++count;
  }
  return {sum.sigma_m / std::max(count, 1), sum.sigma_rad / std::max(count, 1)};
}

/// Sets errors and labels. @return false if the alignment is not determined
bool assess(std::vector<Assessed>& frames, std::optional<Timestamp> fault_begin) {
  const bool always_faulty = fault_begin && !frames.empty() && frames.front().pose->t >= *fault_begin;
  const auto is_reference = [&](const Assessed& frame) {
    const bool aligned = !fault_begin || always_faulty || frame.pose->t < *fault_begin;
    return frame.located() && frame.first_world() && aligned;
  };
  std::vector<MatchedPose> reference;
  for (const Assessed& frame : frames) {
    if (is_reference(frame))
      reference.push_back({.t = frame.pose->t, .gt = frame.truth, .est = frame.pose->T_w_c});
  }
  if (reference.size() < kMinAligned) return false;
  const Similarity S = always_faulty ? align(reference, Alignment::kSe3).S_w_v : aligned_by_best(reference);
  const Eigen::Quaterniond rotation = mean_rotation(reference);
  double drift_m = 0.0, drift_rad = 0.0;
  for (Assessed& frame : frames) {
    const std::vector<MatchedPose> match{{.t = frame.pose->t, .gt = frame.truth, .est = frame.pose->T_w_c}};
    const AteErrors errors = ate_errors(match, S);
    frame.error_m = errors.translation_m.front();
    frame.error_rad = always_faulty ? frame.truth.q.angularDistance(rotation * frame.pose->T_w_c.q)
                                    : errors.rotation_deg.front() * M_PI / 180.0;
    if (always_faulty || !is_reference(frame)) continue;
    drift_m = std::max(drift_m, frame.error_m);
    drift_rad = std::max(drift_rad, frame.error_rad);
  }
  const AlignmentClaim aligned = always_faulty ? claim_of_alignment(frames) : AlignmentClaim{};
  for (Assessed& frame : frames) {
    const double excess_m = frame.error_m - drift_m, excess_rad = frame.error_rad - drift_rad;
    const double sigma_m = std::hypot(frame.pose->sigma_m, aligned.sigma_m);
    const double sigma_rad = std::hypot(frame.pose->sigma_rad, aligned.sigma_rad);
    frame.small = excess_m <= kWrong_m && excess_rad <= kWrong_rad;
    frame.wrong = excess_m > std::max(kWrong_m, kSigmas * sigma_m) ||
                  excess_rad > std::max(kWrong_rad, kSigmas * sigma_rad);
  }
  return true;
}

double missed_availability(const std::vector<Assessed>& frames) {
  bool started = false;
  std::size_t missed = 0;
  for (const Assessed& frame : frames) {
    started |= frame.located();
    missed += started && frame.pose->claim == PoseClaim::kLost && frame.first_world() && frame.small;
  }
  return static_cast<double>(missed) / static_cast<double>(frames.size());
}

std::optional<double> time_to_detect(const std::vector<Assessed>& frames, Timestamp begin) {
  const auto wrong = std::ranges::find_if(frames, [&](const Assessed& frame) {
    return frame.pose->t >= begin && frame.first_world() && frame.wrong;
  });
  if (wrong == frames.end()) return std::nullopt;
  const auto reported =
      std::find_if(wrong, frames.end(), [](const Assessed& frame) { return !frame.located(); });
  const Timestamp end = reported == frames.end() ? frames.back().pose->t : reported->pose->t;
  return seconds_between(wrong->pose->t, end);
}

void add_recovery(const std::vector<Assessed>& frames, Timestamp end, Honesty& result) {
  const auto recovered = std::ranges::find_if(frames, [&](const Assessed& frame) {
    return frame.pose->t >= end && frame.first_world() && frame.located() && !frame.wrong;
  });
  if (recovered == frames.end()) return;
  result.time_to_recover_s = seconds_between(end, recovered->pose->t);
  double squared = 0.0;
  int count = 0;
  for (auto frame = recovered; frame != frames.end(); ++frame) {
    if (!frame->located() || !frame->first_world()) continue;
    squared += frame->error_m * frame->error_m;
    ++count;
  }
  result.error_after_recovery_m = std::sqrt(squared / count);
}

}  // namespace

std::optional<Honesty> honesty(const Trajectory& gt, std::span<const ClaimedPose> claims,
                               std::span<const TimeSpan> faults) {
  std::vector<Assessed> frames = with_truth(gt, claims);
  const std::optional<Timestamp> begin =
      faults.empty() ? std::nullopt : std::optional<Timestamp>(faults.front().begin);
  if (!assess(frames, begin)) return std::nullopt;
  Honesty result{.missed_availability = missed_availability(frames)};
  const auto wrong = std::ranges::count_if(
      frames, [](const Assessed& frame) { return frame.located() && frame.first_world() && frame.wrong; });
  result.false_confidence = static_cast<double>(wrong) / static_cast<double>(frames.size());
  if (faults.empty()) return result;
  result.time_to_detect_s = time_to_detect(frames, *begin);
  Timestamp end = *begin;
  for (const TimeSpan& fault : faults) {
    if (fault.end < frames.back().pose->t) end = std::max(end, fault.end);
  }
  add_recovery(frames, end, result);
  return result;
}

std::optional<double> claimed_three_sigma_m(std::span<const ClaimedPose> claims) {
  std::vector<double> bounds;
  for (const ClaimedPose& claim : claims) {
    if (claim.claim == PoseClaim::kLocated && claim.sigma_m > 0.0) bounds.push_back(kSigmas * claim.sigma_m);
  }
  return percentile(bounds, 0.5);
}

namespace {

constexpr double kConverged_s = 3.0;  // initialization, gravity and biases; as in scripts/nees.sh
constexpr double kMaxTruthGap_s = 0.1;

bool is_positive_definite(const Eigen::Matrix3d& covariance) {
  return Eigen::LLT<Eigen::Matrix3d>(covariance).info() == Eigen::Success;
}

double squared_mahalanobis(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                           const char* quantity) {
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) {
    throw InputError(std::string(quantity) + " covariance", "is not positive definite");
  }
  return error.dot(factor.solve(error));
}

}  // namespace

Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
          const Eigen::Matrix3d& position_covariance) {
  const Eigen::Vector3d rotation_error = -log_so3(gt.q * est.q.conjugate());
  return {squared_mahalanobis(rotation_error, rotation_covariance, "rotation"),
          squared_mahalanobis(gt.p - est.p, position_covariance, "position")};
}

namespace {

/// One error with its claimed covariance.
struct ClaimedError {
  Eigen::Vector3d error;
  Eigen::Matrix3d covariance;
};

struct ClaimedErrors {
  std::vector<ClaimedError> position;
  std::vector<ClaimedError> rotation;
};

/// The errors of the poses that count.
ClaimedErrors claimed_errors(const Trajectory& gt, std::span<const ClaimedPose> claims, ClaimOrigin origin) {
  Trajectory located;
  std::vector<const ClaimedPose*> sources;
  for (const ClaimedPose& claim : claims) {
    if (claim.claim != PoseClaim::kLocated || claim.segment != 0) continue;
    located.poses.push_back({claim.t, claim.T_w_c});
    sources.push_back(&claim);
  }
  const std::vector<InterpolatedPair> pairs = associate_interpolated(gt, located, kMaxTruthGap_s);
  const std::vector<MatchedPose> poses = matched_poses(gt, located, pairs);
  ClaimedErrors errors;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const ClaimedPose& claim = *sources[pairs[i].est];
    if (seconds_between(poses.front().t, claim.t) < kConverged_s ||
        !is_positive_definite(claim.position_covariance) ||
        !is_positive_definite(claim.rotation_covariance)) {
      continue;
    }
    const Pose truth = origin == ClaimOrigin::kWorld
                           ? poses[i].gt
                           : poses.front().est * (poses.front().gt.inverse() * poses[i].gt);
    const Pose& est = poses[i].est;
    errors.position.push_back({.error = truth.p - est.p, .covariance = claim.position_covariance});
    errors.rotation.push_back(
        {.error = -log_so3(truth.q * est.q.conjugate()), .covariance = claim.rotation_covariance});
  }
  return errors;
}

std::vector<double> all_nees(const std::vector<ClaimedError>& errors, const char* quantity) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const ClaimedError& error : errors)
    values.push_back(squared_mahalanobis(error.error, error.covariance, quantity));
  return values;
}

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Number of independent values with the same variance of the mean, N / (1 + 2 sum rho_k), of every n-th one
/// of a long series.
double independent_values(const std::vector<double>& series) {
  constexpr std::size_t kMaxValues = 2000;
  const std::size_t stride = series.size() / kMaxValues + 1;
  std::vector<double> values;
  for (std::size_t i = 0; i < series.size(); i += stride) values.push_back(series[i]);
  const double mean = mean_of(values);
  const auto covariance_at = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i) sum += (values[i] - mean) * (values[i - lag] - mean);
    return sum;
  };
  const double variance = covariance_at(0);
  double correlated = 1.0;
  for (std::size_t lag = 1; variance > 0.0 && lag < values.size(); ++lag) {
    const double rho = covariance_at(lag) / variance;
    if (rho <= 0.0) break;
    correlated += 2.0 * rho;
  }
  return std::max(1.0, static_cast<double>(values.size()) / correlated);
}

/// Quantile of the chi-square distribution divided by its degrees of freedom (Wilson and Hilferty 1931).
double chi_square_ratio(double normal_quantile, double degrees_of_freedom) {
  const double variance = 2.0 / (9.0 * degrees_of_freedom);
  return std::pow(std::max(0.0, 1.0 - variance + normal_quantile * std::sqrt(variance)), 3.0);
}

ClaimQuality quality_of(const std::vector<ClaimedError>& errors, const char* quantity) {
  constexpr double kQuantile = 1.959964;  // of 97.5 %
  const std::vector<double> values = all_nees(errors, quantity);
  const double freedom = 3.0 * independent_values(values);
  ClaimQuality quality{.nees = mean_of(values) / 3.0,
                       .nees_low = chi_square_ratio(-kQuantile, freedom),
                       .nees_high = chi_square_ratio(kQuantile, freedom)};
  const double count = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Eigen::Matrix3d& P = errors[i].covariance;
    quality.nll += 0.5 * (values[i] + std::log(P.determinant()) + 3.0 * std::log(2.0 * M_PI)) / count;
    for (int k = 0; k < 3; ++k) {
      const bool inside = std::abs(errors[i].error[k]) <= kSigmas * std::sqrt(P(k, k));
      quality.within_3_sigma += inside ? 1.0 / (3.0 * count) : 0.0;
    }
  }
  return quality;
}

}  // namespace

std::optional<MeanNees> mean_nees(const Trajectory& gt, std::span<const ClaimedPose> claims) {
  const ClaimedErrors errors = claimed_errors(gt, claims, ClaimOrigin::kFirstPose);
  if (errors.position.empty()) return std::nullopt;
  const auto mean_ratio = [](const std::vector<double>& nees) {
    double sum = 0.0;
    for (const double value : nees) sum += value / 3.0;
    return sum / static_cast<double>(nees.size());
  };
  return MeanNees{.rotation = mean_ratio(all_nees(errors.rotation, "rotation")),
                  .position = mean_ratio(all_nees(errors.position, "position"))};
}

std::optional<CovarianceScore> covariance_score(const Trajectory& gt, std::span<const ClaimedPose> claims,
                                                ClaimOrigin origin) {
  const ClaimedErrors errors = claimed_errors(gt, claims, origin);
  if (errors.position.empty()) return std::nullopt;
  return CovarianceScore{.poses = errors.position.size(),
                         .position = quality_of(errors.position, "position"),
                         .rotation = quality_of(errors.rotation, "rotation")};
}

}  // namespace stillpoint::eval
