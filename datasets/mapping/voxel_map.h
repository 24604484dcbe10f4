// SPDX-License-Identifier: BSD-3-Clause
/// Fuses depth images with known poses into a colored point cloud of static surfaces: one point per voxel,
/// the weighted mean of the measurements in it.
///
/// A measurement at distance z has the weight 1 / z^4, as the deviation of stereo depth grows with z^2.
/// Pixels at depth edges are left out: they mix two surfaces. Of images with more than 480 columns, every
/// second (third ...) row and column is used. A voxel counts the images in which it was measured, n, and
/// those in which it was seen through or left out (a person), m. Seen through: the depth at its pixel exceeds
/// its distance by more than a margin.
/// It is a point of the cloud if n >= min_images and n > 2 m: surfaces that moved are removed once what is
/// behind them was seen.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/frame.h"
#include "eval/io/ply_file.h"

namespace stillpoint::datasets {

struct VoxelMapOptions {
  double voxel_m = 0.02;     ///< side of a voxel, > 0
  double max_depth_m = 4.0;  ///< farther measurements are left out
  int min_images = 4;        ///< in which a point must be measured, >= 1
};

class VoxelMap {
 public:
  /// Whether a pixel with this depth [m] is left out, e.g. as one of a person; it hides what is behind it.
  using Excluded = std::function<bool(int column, int row, double depth_m)>;

  VoxelMap(const Camera& camera, const VoxelMapOptions& options);

  /// @param frame with a depth image of the size of the camera; without one nothing is added
  /// @param excluded may be empty
  void add(const Frame& frame, const Pose& T_w_c, const Excluded& excluded);

  /// The points, in the order of their voxels. Deterministic.
  [[nodiscard]] std::vector<eval::CloudPoint> cloud() const;

 private:
  struct Voxel {
    double weight = 0.0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();    ///< weighted sum
    Eigen::Vector3d rgb = Eigen::Vector3d::Zero();  ///< weighted sum
    int measured = 0;                               ///< images
    int seen_through = 0;                           ///< images
    int excluded = 0;                               ///< images
    int last_measured = -1, last_excluded = -1;     ///< images
  };

  /// A cube of 16^3 voxels, of which those are stored that were measured or left out.
  struct Block {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    std::unordered_map<std::uint64_t, Voxel> voxels;  ///< by number
  };

  Voxel& voxel_at(const Eigen::Vector3d& p_w);
  /// Whether the camera may see a part of the block. Conservative.
  [[nodiscard]] bool in_view(const Eigen::Vector3d& center_c) const;
  void count_seen_through(const Frame& frame, const Pose& T_w_c);

  Camera camera_;
  VoxelMapOptions options_;
  int step_px_;                                          ///< distance of the used pixels
  std::vector<Eigen::Vector2d> bearings_;                ///< undistorted, of the used pixels, row by row
  Eigen::Array2d max_bearing_ = Eigen::Array2d::Zero();  ///< absolute values of `bearings_`
  std::unordered_map<std::uint64_t, Block> blocks_;
  int image_ = 0;
};

}  // namespace stillpoint::datasets
