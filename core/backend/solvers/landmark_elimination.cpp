// SPDX-License-Identifier: BSD-3-Clause
// Elimination of the landmarks from the normal equations of VisualTerms.
#include <algorithm>
#include <cmath>

#include "core/backend/solvers/visual_terms.h"

namespace stillpoint {
namespace {

/// Landmarks eliminated by one rank update.
constexpr int kLandmarkBatch = 32;

}  // namespace

void VisualTerms::eliminate(double damping, Eigen::Ref<RowMajorMatrix> S, Eigen::Ref<Eigen::VectorXd> rhs) {
  const Eigen::Index states = coupling_.rows();
  scaled_.resize(states, kLandmarkBatch);
  for (int begin = 0; begin < variable_count_; begin += kLandmarkBatch) {
    const int count = std::min(kLandmarkBatch, variable_count_ - begin);
    int first_frame = frames_;
    for (int i = 0; i < count; ++i) {
      const int landmark = begin + i;
      first_frame = std::min(first_frame, host_frames_[static_cast<std::size_t>(landmark)]);
      const double damped = information_[landmark] * (1.0 + damping);
      const double inverse_root = damped > 0.0 ? 1.0 / std::sqrt(damped) : 0.0;
      scaled_.col(i) = inverse_root * coupling_.col(landmark);
      rhs.tail(states) += (gradient_[landmark] * inverse_root) * scaled_.col(i);
    }
    // A landmark involves only the poses from its host on.
    const Eigen::Index involved = states - 6 * first_frame;
    S.bottomRightCorner(involved, involved)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(scaled_.bottomRows(involved).leftCols(count), -1.0);
  }
}

void VisualTerms::apply_step(const ReusableVector& step, ParameterBlocks& blocks) const {
  for (const VisualLandmark& landmark : landmarks_) {
    if (landmark.column >= 0) *blocks.inverse_depth(landmark.index) += step[landmark.column];
  }
}

}  // namespace stillpoint
