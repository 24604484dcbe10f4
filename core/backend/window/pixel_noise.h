// SPDX-License-Identifier: BSD-3-Clause
/// Pixel noise, estimated from the reprojection errors of the window.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Parts of the variance of a reprojection error r, the difference of the bearings in a frame and in the host
/// frame, of one component:
///
///   white       w = median |r_j - r_j-1|^2 / (2 log 2),    over successive frames j of a track
///   correlated  m = median |r_j|^2 / (2 log 2) - w,        at least 0
///
/// 2 log 2 is the median of the chi-square distribution with two degrees of freedom. White noise u of each
/// bearing gives m = 0: the error of the host frame is common to the r_j, that of frame j to two of their
/// differences. m is model error (distortion, blur, rolling shutter, patches that change with the view),
/// which is correlated along a track.
///
///   design effect  D = 1 + 2 sum_a<b e_a . e_b / sum_a |e_a|^2
///
/// over the features a, b of the newest frame that are less than 0.4 focal lengths apart. e_a is the change
/// r_j - r_j-1 of a feature relative to 1.5 sqrt(w) of that frame, at most of norm 1. D is the variance of
/// the mean of correlated errors relative to that of independent ones (Kish 1965). Errors of a lens, blur,
/// rolling shutter and registration are those of neighbors, too: so many features tell no more than one does.
struct ReprojectionVariance {
  double white_px2 = 0.0;
  double correlated_px2 = 0.0;
  double design_effect = 1.0;
};

/// Stateless except for its buffers.
class ReprojectionErrorMonitor {
 public:
  /// Of usable landmarks in frames after their host; nothing with fewer than 20 finite errors or differences.
  [[nodiscard]] std::optional<ReprojectionVariance> measure(const Window& window, double focal_px);

 private:
  /// Of a feature of the newest frame, on the normalized image plane.
  struct Change {
    Eigen::Vector2d bearing;
    Eigen::Vector2d error;  ///< r_j - r_j-1
  };
  [[nodiscard]] double design_effect();

  std::vector<Pose> T_c_w_;      ///< of each frame
  std::vector<double> squared_;  ///< |r|^2 of each observation [normalized image plane]
  std::vector<double> changes_;  ///< |r_j - r_j-1|^2 likewise
  std::vector<Change> newest_;   ///< features of the newest frame
};

/// Low-pass filtered standard deviation s of a reprojection error. The observations of a track together tell
/// about its model error no more than one does: to count all of them, their variance is K times as large,
///
///   s <- s + 0.1 (c sqrt(w + K m) - s),    K = 6,    0.09 px <= c sqrt(w + K m) <= 9 px,
///
/// with c = `BackendConfig::pixel_noise_scale`; likewise the white part s_w of the noise, with sqrt(w) in
/// place of c sqrt(w + K m), and the design effect D. The features of a frame together have the noise
/// sqrt(max(1, D)) s; each of them has the noise s, to which the robust loss refers.
class PixelNoise {
 public:
  /// @param nominal_px s before the first observation
  /// @param scale      c; 0 = s is constant
  PixelNoise(double nominal_px, double scale)
      : nominal_px_(nominal_px), scale_(scale), sigma_px_(nominal_px), white_px_(nominal_px) {}

  /// Updates s, s_w and D after a solve.
  void observe(const ReprojectionVariance& variance);

  /// The newest features are not where they were predicted: something is not as it was when their errors were
  /// small, so s is at least the nominal one again.
  void expect_errors() { sigma_px_ = std::max(sigma_px_, nominal_px_); }

  [[nodiscard]] bool is_constant() const { return scale_ == 0.0; }
  [[nodiscard]] double sigma_px() const { return sigma_px_; }
  /// s_w: of the change of an error between successive frames.
  [[nodiscard]] double white_px() const { return white_px_; }
  /// The configuration with the noise of the features together as `pixel_sigma_px`, and `cauchy_scale` in its
  /// units.
  [[nodiscard]] BackendConfig applied_to(BackendConfig config) const;

 private:
  double nominal_px_, scale_, sigma_px_, white_px_;
  double design_effect_ = 1.0;
};

}  // namespace stillpoint
