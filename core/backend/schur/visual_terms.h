// SPDX-License-Identifier: BSD-3-Clause
/// The landmarks of a window: their residuals, and their elimination from the normal equations.
#pragma once

#include "core/backend/observation_model.h"
#include "core/backend/schur/frame_transfer.h"
#include "core/backend/schur/reduced_system.h"

namespace stillpoint {

/// Which landmarks take part.
enum class LandmarkPart { kAll, kHostedByOldest };

/// Each landmark has one number, so its elimination is a division: no matrix over landmarks is ever built.
/// Rows of a sighting are summed by the tangent of the relative pose of its two frames, together with the
/// time offset and the residual itself: one symmetric 8x8 sum for each pair of frames.
class VisualTerms {
 public:
  /// Takes over what was seen; no allocation once as much has been held.
  void read(const Window& window, const BackendConfig& config, double focal_px, LandmarkPart part);

  [[nodiscard]] double cost(ParameterBlocks& blocks);
  /// Adds the part of the states to the system and keeps that of the landmarks. @return the cost
  double add_to(ReducedSystem& system, ParameterBlocks& blocks);

  /// Subtracts from S and right-hand side what the landmarks, free to follow, take off; each is held by
  /// `damping` times its own information.
  void eliminate(double damping, Eigen::Ref<RowMajorMatrix> S, Eigen::Ref<Eigen::VectorXd> rhs);

  /// Of the landmarks that are free, side by side: information, gradient, and the coupling to the columns of
  /// the layout from its first pose on (one column each).
  [[nodiscard]] const KeptVector& information() const { return information_; }
  [[nodiscard]] const KeptVector& gradient() const { return gradient_; }
  [[nodiscard]] const KeptMatrix<Eigen::MatrixXd>& coupling() const { return coupling_; }
  /// Moves the inverse depths of the free ones.
  void move(const KeptVector& step, ParameterBlocks& blocks) const;

  [[nodiscard]] int landmarks() const { return static_cast<int>(landmarks_.size()); }
  [[nodiscard]] int measured_landmarks() const { return measured_; }

 private:
  struct SeenLandmark {
    std::size_t index = 0;  // in the window
    int host = 0;
    int last = 0;
    std::size_t first_sighting = 0;
    TimedBearing in_host;
    double measured = 0.0;  // inverse depth in the host
    bool has_depth = false;
    int column = -1;  // among the free ones; -1 = held
  };
  struct TimedSighting {
    TimedBearing bearing;
    double inverse_depth = 0.0;
    bool has_depth = false;
  };
  /// Sums over the sightings of one pair of frames: nu, omega, time offset, residual.
  using PairSum = Eigen::Matrix<double, 8, 8>;
  using Column8 = Eigen::Matrix<double, 8, 1>;
  struct LandmarkState {
    double lambda;
    Eigen::Vector3d ray;       // at the time of the host's state
    Eigen::Vector2d velocity;  // of its bearing
  };
  /// Three whitened rows, not yet weighted by the loss.
  struct SightingTerm {
    Eigen::Matrix<double, 8, 3> rows;  // by nu, omega and the time offset; then the residual
    Eigen::Vector3d by_lambda;
  };

  void add_landmark(const Landmark& landmark, std::size_t index, const BackendConfig& config);
  void place_frames(ParameterBlocks& blocks);
  [[nodiscard]] LandmarkState state_of(const SeenLandmark& landmark, ParameterBlocks& blocks) const;
  [[nodiscard]] Sighting sighting_at(const TimedSighting& sighting) const;
  [[nodiscard]] const TimedSighting& sighting_of(const SeenLandmark& landmark, int frame) const {
    return sightings_[landmark.first_sighting + static_cast<std::size_t>(frame - landmark.host - 1)];
  }
  [[nodiscard]] BoundedError host_depth(const SeenLandmark& landmark, double lambda) const;
  [[nodiscard]] SightingTerm linearize(const TimedSighting& timed, const FrameTransfer& to,
                                       const LandmarkState& host) const;
  [[nodiscard]] double linearize(const SeenLandmark& landmark, ParameterBlocks& blocks,
                                 const ReducedLayout& layout);
  void couple(const SeenLandmark& landmark, int frame, const Column8& column, const ReducedLayout& layout);
  void add_pair(int host, int frame, ReducedSystem& system) const;
  [[nodiscard]] std::size_t pair(int host, int frame) const {
    return static_cast<std::size_t>(host * frames_ + frame);
  }

  int frames_ = 0;
  int measured_ = 0;
  double cauchy_squared_ = 1.0;
  double time_offset_ = 0.0;
  ReprojectionNoise noise_;
  ObservationModel observations_;
  std::vector<SeenLandmark> landmarks_;
  std::vector<TimedSighting> sightings_;
  std::vector<std::uint8_t> pair_used_;
  std::vector<FrameTransfer> transfers_;
  std::vector<PairSum> sums_;
  int free_ = 0;
  std::vector<int> first_frame_;  // of each free landmark: its host
  KeptVector information_;
  KeptVector gradient_;
  KeptMatrix<Eigen::MatrixXd> coupling_;
  KeptMatrix<Eigen::MatrixXd> scaled_;  // coupling of some landmarks over the root of their information
};

}  // namespace stillpoint
