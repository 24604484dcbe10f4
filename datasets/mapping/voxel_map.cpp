// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/mapping/voxel_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr double kMinFusedDepth_m = 0.2;
constexpr int kMaxColumns = 480;  ///< that are used of an image
/// Depth difference of neighbors at an edge, relative to the depth: a plane at 80 degrees has less at 1 px.
constexpr double kEdgeRatio = 0.02;
/// Of the depth by which a voxel must be exceeded to be seen through, in addition to three voxels: three
/// deviations of the depth at 4 m.
constexpr double kSeenThroughRatio = 0.04;

constexpr std::uint64_t kIndexBits = 21;
constexpr std::uint64_t kIndexMask = (1 << kIndexBits) - 1;
constexpr std::int64_t kIndexOffset = 1 << (kIndexBits - 1);
constexpr int kBlockVoxels = 16;  ///< per axis, a power of two
/// Half a diagonal of a block, in voxels, and one more for rounding.
constexpr double kBlockRadius = 0.5 * kBlockVoxels * std::numbers::sqrt3 + 1.0;

/// Number of a voxel: 21 bits per axis, ascending by z, then y, then x.
std::uint64_t voxel_number(const Eigen::Vector3d& p, double voxel_m) {
  const auto index = [&](double value) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / voxel_m)) + kIndexOffset) &
           kIndexMask;
  };
  return index(p.z()) << 2 * kIndexBits | index(p.y()) << kIndexBits | index(p.x());
}

/// Number of the first voxel of the block that contains a voxel.
std::uint64_t block_number(std::uint64_t voxel) {
  constexpr std::uint64_t kAxis = kBlockVoxels - 1;
  return voxel & ~(kAxis << 2 * kIndexBits | kAxis << kIndexBits | kAxis);
}

Eigen::Vector3d block_center(std::uint64_t block, double voxel_m) {
  const auto center = [&](std::uint64_t axis) {
    const auto index = static_cast<std::int64_t>(block >> axis * kIndexBits & kIndexMask) - kIndexOffset;
    return (static_cast<double>(index) + 0.5 * kBlockVoxels) * voxel_m;
  };
  return {center(0), center(1), center(2)};
}

/// Whether the depth differs from that of a neighbor, or one is not measured.
bool is_edge(const cv::Mat& depth, int row, int column) {
  if (row < 1 || column < 1 || row + 1 >= depth.rows || column + 1 >= depth.cols) return true;
  const double center = depth.at<std::uint16_t>(row, column);
  const std::pair<int, int> neighbors[] = {
      {row - 1, column}, {row + 1, column}, {row, column - 1}, {row, column + 1}};
  return std::ranges::any_of(neighbors, [&](const std::pair<int, int>& at) {
    return std::abs(depth.at<std::uint16_t>(at.first, at.second) - center) > kEdgeRatio * center;
  });
}

Eigen::Vector3d color_at(const cv::Mat& color, const cv::Mat& gray, int row, int column) {
  if (color.empty()) return Eigen::Vector3d::Constant(gray.at<std::uint8_t>(row, column));
  const auto& rgb = color.at<cv::Vec3b>(row, column);
  return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

}  // namespace

VoxelMap::VoxelMap(const Camera& camera, const VoxelMapOptions& options)
    : camera_(camera),
      options_(options),
      step_px_(std::max(1, (camera.width + kMaxColumns - 1) / kMaxColumns)) {
  STILLPOINT_CHECK(options.voxel_m > 0.0 && options.min_images >= 1);
  for (int row = 0; row < camera.height; row += step_px_) {
    for (int column = 0; column < camera.width; column += step_px_)
      bearings_.push_back(camera.unproject(Eigen::Vector2d(column, row)));
  }
  for (const Eigen::Vector2d& bearing : bearings_) max_bearing_ = max_bearing_.max(bearing.array().abs());
}

VoxelMap::Voxel& VoxelMap::voxel_at(const Eigen::Vector3d& p_w) {
  const std::uint64_t number = voxel_number(p_w, options_.voxel_m);
  const std::uint64_t block = block_number(number);
  const auto [at, is_new] = blocks_.try_emplace(block);
  if (is_new) at->second.center = block_center(block, options_.voxel_m);
  return at->second.voxels[number];
}

bool VoxelMap::in_view(const Eigen::Vector3d& center_c) const {
  constexpr double kBorder = 1.02;  // the outermost pixels may be unused
  const double radius_m = kBlockRadius * options_.voxel_m;
  if (center_c.z() < kMinFusedDepth_m - radius_m || center_c.z() > options_.max_depth_m + radius_m)
    return false;
  // Distance to the planes through the camera's center and the border of the image, in x and y.
  const Eigen::Array2d slope = kBorder * max_bearing_;
  return (center_c.head<2>().array().abs() - slope * center_c.z() <= radius_m * (1.0 + slope.square()).sqrt())
      .all();
}

void VoxelMap::count_seen_through(const Frame& frame, const Pose& T_w_c) {
  const Pose T_c_w = T_w_c.inverse();
  for (auto& [first, block] : blocks_) {
    if (!in_view(T_c_w * block.center)) continue;
    for (auto& [number, voxel] : block.voxels) {
      if (voxel.measured == 0) continue;
      const Eigen::Vector3d p_c = T_c_w * (voxel.p / voxel.weight);
      if (p_c.z() < kMinFusedDepth_m || p_c.z() > options_.max_depth_m) continue;
      const Eigen::Vector2d pixel = camera_.project(p_c);
      if (!camera_.contains(pixel)) continue;
      const double depth_m = depth_at(frame.depth, frame.depth_units_per_m, pixel.x(), pixel.y());
      const double margin_m = 3.0 * options_.voxel_m + kSeenThroughRatio * p_c.z();
      if (depth_m > p_c.z() + margin_m) ++voxel.seen_through;
    }
  }
}

void VoxelMap::add(const Frame& frame, const Pose& T_w_c, const Excluded& excluded) {
  if (frame.depth.empty()) return;
  STILLPOINT_CHECK(frame.depth.cols == camera_.width && frame.depth.rows == camera_.height);
  count_seen_through(frame, T_w_c);
  const cv::Mat color = color_image(frame);
  auto bearing = bearings_.begin();
  for (int row = 0; row < camera_.height; row += step_px_) {
    for (int column = 0; column < camera_.width; column += step_px_, ++bearing) {
      const double depth_m = frame.depth.at<std::uint16_t>(row, column) / frame.depth_units_per_m;
      if (depth_m < kMinFusedDepth_m || depth_m > options_.max_depth_m || is_edge(frame.depth, row, column))
        continue;
      const Eigen::Vector3d p_w = T_w_c * Eigen::Vector3d(depth_m * bearing->homogeneous());
      Voxel& voxel = voxel_at(p_w);
      if (excluded && excluded(column, row, depth_m)) {
        voxel.excluded += voxel.last_excluded == image_ ? 0 : 1;
        voxel.last_excluded = image_;
        continue;
      }
      const double weight = 1.0 / (depth_m * depth_m * depth_m * depth_m);
      voxel.weight += weight;
      voxel.p += weight * p_w;
      voxel.rgb += weight * color_at(color, frame.gray, row, column);
      voxel.measured += voxel.last_measured == image_ ? 0 : 1;
      voxel.last_measured = image_;
    }
  }
  ++image_;
}

std::vector<eval::CloudPoint> VoxelMap::cloud() const {
  std::map<std::uint64_t, const Voxel*> found;
  for (const auto& [first, block] : blocks_) {
    for (const auto& [number, voxel] : block.voxels) {
      if (voxel.measured >= options_.min_images && voxel.measured > 2 * (voxel.seen_through + voxel.excluded))
        found.emplace(number, &voxel);
    }
  }
  std::vector<eval::CloudPoint> points;
  for (const auto& [number, found_voxel] : found) {
    const Voxel& voxel = *found_voxel;
    const Eigen::Vector3d rgb = voxel.rgb / voxel.weight;
    points.push_back(
        {.p = (voxel.p / voxel.weight).cast<float>(),
         .rgb = {static_cast<std::uint8_t>(rgb[0] + 0.5), static_cast<std::uint8_t>(rgb[1] + 0.5),
                 static_cast<std::uint8_t>(rgb[2] + 0.5)}});
  }
  return points;
}

}  // namespace stillpoint::datasets
