// SPDX-License-Identifier: BSD-3-Clause
/// One round of the batch estimation of a calibration: the problem at the present values, its solution and
/// the statistics of its residuals.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include "core/backend/factors/ceres_manifolds.h"
#include "core/calibration/batch_state.h"
#include "core/calibration/calibration_factors.h"
#include "core/calibration/imu_axes_factor.h"
#include "core/imu/imu_buffer.h"

namespace stillpoint {

/// The numbers of the calibration, in the order of `SharedVector`.
enum class SharedValue : std::uint8_t {
  kFx,
  kFy,
  kCx,
  kCy,
  kK1,
  kK2,
  kReadout,
  kDepthScale,
  kDepthOffset,
  kDepthFx,
  kDepthFy,
  kDepthCx,
  kDepthCy,
  kDepthPose,                    ///< T_c_d: three of position, three of rotation
  kExtrinsics = kDepthPose + 6,  ///< T_b_c: likewise
  kTimeOffset = kExtrinsics + 6,
  kImuAxes,  ///< as ImuAxesValues
  kDepthDelay = kImuAxes + kImuAxesCount,
  kTruthPose,  ///< T_f_b: likewise
  kTruthDelay = kTruthPose + 6,
  kCount
};
inline constexpr int kSharedCount = static_cast<int>(SharedValue::kCount);
using SharedFlags = std::array<bool, kSharedCount>;
using SharedVector = Eigen::Matrix<double, kSharedCount, 1>;

/// How a round is solved.
struct RoundOptions {
  SharedFlags is_variable{};  ///< poses: all three numbers of position, or of rotation, alike
  bool is_first = false;      ///< deviations are not known yet
  bool depth_is_registered = true;
  double edge_radius_px = 0.0;  ///< within which edges of depth and color images are matched; 0 = not used
  int max_iterations = 20;
  std::function<bool(int iteration, double cost)> on_iteration = {};  ///< false = stop; may be empty
};

/// What the residuals of a solution tell.
struct RoundStatistics {
  double pixel_rms_px = 0.0;       ///< of inliers, corrected for the number of estimated values
  double inverse_depth_rms = 0.0;  ///< likewise [1/m]; zero without depth
  double cost = 0.0;
  std::size_t landmarks = 0, observations = 0, depths = 0, inertial_factors = 0, truth_poses = 0, edges = 0;
  std::vector<ImageResidual> residuals;  ///< of inliers
};

class BatchProblem {
 public:
  /// Changes `state` when it is solved; all arguments must outlive the object.
  BatchProblem(const CalibrationInput& input, const CalibrationPriors& priors, const RoundOptions& options,
               BatchState& state);

  /// @return false if the solver failed
  [[nodiscard]] bool solve();

  /// Of the present values; marks outliers in `state` and sets its deviations.
  [[nodiscard]] RoundStatistics update_deviations();

  /// Standard deviations of the shared values; zero where they are constant. nullopt if the information is
  /// singular.
  [[nodiscard]] std::optional<SharedVector> deviations();

 private:
  struct Seen {  ///< an observation in the problem
    BatchObservation* observation;
    Eigen::Vector3d* point;
    PixelFactor* pixel;
    DepthFactor* depth;  ///< null = not measured
  };
  struct Inertial {
    int first;  ///< keyframe; the second one is the next
    Preintegration imu;
    TimedImuResidual::Ends ends;
  };

  void add_keyframes();
  void add_shared();
  void add_landmark(BatchLandmark& landmark);
  void add_inertial(ImuBuffer& samples, int first);
  void add_state_prior(int keyframe);
  void add_truth();
  void add_edges(int keyframe);
  void add_priors();
  void hold(double* block, int size, std::span<const int> constant);
  void add_pose_block(double* block, SharedValue first);
  void add_linear_prior(double* block, const Eigen::VectorXd& mean, const Eigen::MatrixXd& A);
  [[nodiscard]] std::optional<DepthFactor::Measurement> depth_of(const BatchObservation& seen,
                                                                 const Eigen::Vector3d& p_w) const;
  [[nodiscard]] bool estimates_imu_axes() const;
  [[nodiscard]] bool is_variable(SharedValue value) const {
    return options_.is_variable[static_cast<std::size_t>(value)];
  }
  [[nodiscard]] std::array<const double*, 8> depth_blocks(const Seen& seen) const;
  [[nodiscard]] Eigen::Vector3d velocity_c(const BatchObservation& seen, const Eigen::Vector3d& p_w) const;
  void update_imu_noise();
  [[nodiscard]] Eigen::Vector3d mean_velocity_c(int keyframe, const Eigen::Vector3d& p_w) const;
  void update_truth_noise();
  void update_edge_noise();

  const CalibrationInput& input_;
  const CalibrationPriors& priors_;
  const RoundOptions& options_;
  BatchState& state_;
  PoseManifold pose_manifold_;
  GravityManifold gravity_manifold_;
  std::deque<ceres::SubsetManifold> subsets_;
  ceres::CauchyLoss cauchy_{2.0};
  ceres::HuberLoss huber_{2.5};
  std::deque<PixelFactor> pixel_factors_;
  std::deque<DepthFactor> depth_factors_;
  std::deque<Inertial> inertial_;
  std::deque<ImuAxesFactor> imu_factors_;
  std::deque<LinearPriorFactor> linear_priors_;
  std::deque<PosePrior> pose_priors_;
  std::deque<TruthFactor> truth_factors_;
  std::deque<EdgeFactor> edge_factors_;
  std::vector<int> truth_keyframes_;
  std::vector<Seen> seen_;
  std::size_t landmark_count_ = 0;
  /// Residual blocks of all clusters (landmarks, edges of a keyframe), and the number of residuals up to the
  /// last one of each cluster.
  std::vector<ceres::ResidualBlockId> cluster_blocks_;
  std::vector<int> cluster_ends_;
  ceres::Problem problem_;
};

}  // namespace stillpoint
