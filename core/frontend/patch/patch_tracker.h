// SPDX-License-Identifier: BSD-3-Clause
/// Sparse optical flow between two images by 8x8 patches, an alternative to klt.h (Paper Sec. III-A), and the
/// alignment of later matches with the patch of the image where a track began.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/frontend/klt/klt.h"
#include "core/frontend/patch/patch_kernel.h"

namespace stillpoint {

/// Finds the points by `track_patches`; drop-in replacement of `track_points_klt`.
/// @param recycled buffers reused for the result
[[nodiscard]] KltResult track_points_patch(const TrackingRequest& request, const PatchSettings& settings,
                                           PatchTarget target = PatchTarget::kBest, KltResult recycled = {});

struct AlignmentSettings {
  PatchSettings search;
  float max_shift_px = 1.0F;  ///< from the initial guess
};

/// The surroundings of a feature in one image, in the two finest levels of its pyramid.
class TrackTemplate {
 public:
  /// Replaces the template. @param pixel in the image or at most `kPatchReach` - 1 px outside
  void capture(const ImagePyramid& pyramid, PatchPoint pixel);

  void clear() { levels_ = 0; }
  [[nodiscard]] bool empty() const { return levels_ == 0; }

  /// Position in another image that fits the template best, by `track_patches` from `initial_guess`, with the
  /// template warped by bilinear interpolation:
  ///   T_w(d) = T(A d), d = offset from the feature in the other image, A = `A_template_image`.
  /// The arithmetic of the warp is that of integers, so that its result does not depend on the processor.
  /// @param pyramid its border must be at least `kPatchReach`
  /// @return nullopt if nothing is found within `max_shift_px`, or if `A` maps a patch to more than the
  /// template
  [[nodiscard]] std::optional<PatchPoint> align(const ImagePyramid& pyramid,
                                                const Eigen::Matrix2d& A_template_image,
                                                PatchPoint initial_guess,
                                                const AlignmentSettings& settings) const;

 private:
  static constexpr int kSide = 24;
  struct Level {
    std::array<std::uint8_t, std::size_t{kSide} * kSide> pixels;
    PatchPoint center;  ///< of the feature in `pixels`
  };
  std::array<Level, 2> level_;
  int levels_ = 0;  ///< number of captured ones
};

}  // namespace stillpoint
