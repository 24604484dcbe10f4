// SPDX-License-Identifier: BSD-3-Clause
/// Visual residuals of a window and the elimination of its landmarks from the normal equations.
#pragma once

#include "core/backend/factors/relative_pose_linearization.h"
#include "core/backend/solvers/observation_model.h"
#include "core/backend/solvers/reduced_system.h"
#include "core/backend/solvers/window_problem.h"

namespace stillpoint {

/// Which landmarks are used.
enum class LandmarkSelection { kAll, kHostedByOldest };

/// Reprojection residuals (see reprojection_rows.h), their normal equations and the Schur complement.
///
/// An observation depends on the states only through the relative pose of its two cameras and the time
/// offset. Its rows r are therefore linearized with respect to y = (nu, omega, td), where (nu, omega) is the
/// tangent of RelativePoseLinearization, and lambda. Per pair of frames (i, j) the sum
///
///   A_ij = sum w [J_y r]^T [J_y r],    w = f / (1 + |r|^2 / c^2)    (8x8; w: weight of the Cauchy loss,
///                                                           f: fraction of the information that is used)
///
/// is mapped to the states x once, with M_ij = dy/dx: H_pp += M_ij^T A_yy M_ij, g_p += M_ij^T A_yr. A
/// displacement of the world is in the null space of M_ij, whatever A_ij is: with first-estimates Jacobians
/// only M_ij is evaluated at the first estimates.
///
/// A landmark is one scalar lambda. Over its observations
///
///   H_ll = sum w |J_l|^2,    g_l = sum w J_l^T r,    H_pl = sum M_ij^T w J_y^T J_l    (a column)
///
/// plus the host depth residual in H_ll and g_l, so its elimination is a rank-one update,
/// S -= H_pl H_ll^-1 H_pl^T.
///
/// If the inverse depth scale k is variable, it has the sum a_ij = sum w J_k [J_y r] per pair, mapped
/// likewise to H_pk and g_k, and H_kk = sum w J_k^2; both only from depth rows. The lens c has the same sums
/// with four columns.
class VisualTerms {
 public:
  /// Reads the observations of a window; allocates only if it is larger than all windows before.
  void read(const Window& window, const BackendConfig& config, double focal_px, LandmarkSelection selection);

  [[nodiscard]] double cost(const ParameterBlocks& blocks);
  /// Adds H_pp and g_p to the system and stores H_ll, g_l and H_pl. @return the cost
  double add_to(ReducedSystem& system, const Linearization& at);

  /// Schur complement with damped landmarks, H_ll' = (1 + damping) H_ll:
  /// S -= H_pl H_ll'^-1 H_lp (lower triangle), rhs += H_pl H_ll'^-1 g_l.
  void eliminate(double damping, Eigen::Ref<RowMajorMatrix> S, Eigen::Ref<Eigen::VectorXd> rhs);

  /// H_ll, g_l and H_pl of the variable landmarks. H_pl has one column per landmark; its rows are those of
  /// the layout from the first pose on.
  [[nodiscard]] const ReusableVector& information() const { return information_; }
  [[nodiscard]] const ReusableVector& gradient() const { return gradient_; }
  [[nodiscard]] const ReusableMatrix<Eigen::MatrixXd>& coupling() const { return coupling_; }
  /// Adds the step to the inverse depths of the variable landmarks.
  void apply_step(const ReusableVector& step, ParameterBlocks& blocks) const;

  [[nodiscard]] int landmarks() const { return static_cast<int>(landmarks_.size()); }
  [[nodiscard]] int measured_landmarks() const { return measured_; }

 private:
  struct VisualLandmark {
    std::size_t index = 0;  // in the window
    int host = 0;
    int last = 0;
    std::size_t first_observation = 0;
    TimedBearing in_host;
    double measured = 0.0;  // inverse depth in the host
    bool has_depth = false;
    double information = 1.0;  // of the depth in the host
    int column = -1;           // among the variable landmarks; -1 = constant
  };
  struct TimedObservation {
    TimedBearing bearing;
    double inverse_depth = 0.0;
    bool has_depth = false;
    double information = 1.0;  // that is used, as a fraction
  };
  /// A_ij: rows and columns (nu, omega, td, r).
  using PairSum = Eigen::Matrix<double, 8, 8>;
  using Column8 = Eigen::Matrix<double, 8, 1>;
  struct LandmarkState {
    double lambda;
    Eigen::Vector3d ray;       // bearing at the time of the host's state, z = 1
    Eigen::Vector2d seen;      // by the camera of the rig
    Eigen::Vector2d velocity;  // of the bearing [1/s]
  };
  /// Three whitened rows, not yet weighted by the loss.
  struct ObservationTerm {
    Eigen::Matrix<double, 8, 3> rows;  // [J_y r]^T
    Eigen::Vector3d J_lambda;
    double J_scale;  // of the depth row
    Eigen::Matrix<double, 4, 3> J_lens;
    double inverse_weight;  // 1 / w
  };

  void add_landmark(const Window& window, std::size_t index, const BackendConfig& config);
  [[nodiscard]] CameraOnBody place_cameras(const ParameterBlocks& blocks);
  void update_relative_poses(const ParameterBlocks& blocks);
  void update_pose_jacobians(const ParameterBlocks& point, bool with_extrinsics);
  [[nodiscard]] LandmarkState state_of(const VisualLandmark& landmark, const ParameterBlocks& blocks) const;
  [[nodiscard]] MeasuredPoint measured_point_at(const TimedObservation& observation) const;
  [[nodiscard]] const TimedObservation& observation_of(const VisualLandmark& landmark, int frame) const {
    return timed_observations_[landmark.first_observation +
                               static_cast<std::size_t>(frame - landmark.host - 1)];
  }
  [[nodiscard]] Eigen::Vector2d at_state(const TimedBearing& timed) const;
  void add_lens_terms(const VisualLandmark& landmark, int frame, const ObservationTerm& term,
                      const ReducedLayout& layout);
  void add_scale_terms(const VisualLandmark& landmark, int frame, const ObservationTerm& term,
                       const ReducedLayout& layout);
  void add_host_scale_terms(const VisualLandmark& landmark, double lambda, const BoundedError& depth,
                            const ReducedLayout& layout);
  [[nodiscard]] BoundedError host_depth(const VisualLandmark& landmark, double lambda) const;
  [[nodiscard]] ObservationTerm linearize(const TimedObservation& timed, const RelativePoseLinearization& to,
                                          const LandmarkState& host) const;
  [[nodiscard]] double linearize(const VisualLandmark& landmark, const ParameterBlocks& blocks,
                                 const ReducedLayout& layout);
  void add_coupling(const VisualLandmark& landmark, int frame, const Column8& column,
                    const ReducedLayout& layout);
  void add_pair(int host, int frame, ReducedSystem& system) const;
  template <class Index>
  [[nodiscard]] std::size_t pair(Index host, Index frame) const {
    return static_cast<std::size_t>(host) * static_cast<std::size_t>(frames_) +
           static_cast<std::size_t>(frame);
  }

  int frames_ = 0;
  int measured_ = 0;
  bool bearings_move_ = false;  // with the time offset, see ObservationModel
  bool lens_varies_ = false;
  bool marginalizes_ = false;  // only a fraction of the information, see marginalized_fraction
  double cauchy_squared_ = 1.0;
  double time_offset_ = 0.0;
  double inverse_depth_scale_ = 1.0;
  Eigen::Vector4d lens_at_read_ = Eigen::Vector4d::Zero();
  Eigen::Vector4d lens_ = Eigen::Vector4d::Zero();
  ReprojectionNoise noise_;
  ObservationModel observation_model_;
  std::vector<VisualLandmark> landmarks_;
  std::vector<TimedObservation> timed_observations_;
  std::vector<std::uint8_t> pair_used_;
  std::vector<CameraInWorld> cameras_;
  std::vector<RelativePoseLinearization> relative_poses_;
  std::vector<PairSum> sums_;
  std::vector<Column8> scale_sums_;  // a_ij
  std::vector<Eigen::Matrix<double, 8, 4>> lens_sums_;
  Eigen::Matrix4d lens_information_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d lens_scale_ = Eigen::Vector4d::Zero();  // of H
  double scale_information_ = 0.0;                        // H_ss
  double host_scale_gradient_ = 0.0;                      // part of g_s
  int variable_count_ = 0;
  std::vector<int> host_frames_;  // host of each variable landmark
  ReusableVector information_;
  ReusableVector gradient_;
  ReusableMatrix<Eigen::MatrixXd> coupling_;
  ReusableMatrix<Eigen::MatrixXd> scaled_;  // H_pl H_ll'^-1/2 of one batch
};

}  // namespace stillpoint
