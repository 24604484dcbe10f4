// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/surface_samples.h"

#include <vector>

namespace stillpoint::report {
namespace {

constexpr double kFusionInterval_s = 0.495;      // 2 Hz, with jitter
constexpr double kSurfaceVoxel_m = 0.04;         // a room of 5 m x 5 m has about 50,000
constexpr std::size_t kMaxSurfacePoints = 8000;  // 240 kB per run in the store

}  // namespace

void add_static_pixels(datasets::VoxelMap& map, const Frame& frame, const Pose& T_w_c,
                       const SemanticMask& mask) {
  map.add(frame, T_w_c, [&mask](int column, int row, double depth_m) {
    return depth_m < mask.threshold_at(Eigen::Vector2d(column, row));
  });
}

SurfaceSamples::SurfaceSamples(const Camera& camera)
    : map_(camera, {.voxel_m = kSurfaceVoxel_m, .min_images = 2}) {}

void SurfaceSamples::add(const FrameReport& report) {
  const OdometryUpdate& update = report.update;
  if (!is_located(update.status) || update.segment != 0 || report.dynamic.labels.empty()) return;
  if (last_t_ && seconds_between(*last_t_, report.frame.t) < kFusionInterval_s) return;
  last_t_ = report.frame.t;
  add_static_pixels(map_, report.frame, update.T_w_c, report.dynamic.mask);
}

std::string SurfaceSamples::ply() const {
  const std::vector<eval::CloudPoint> cloud = eval::thinned_cloud(map_.cloud(), kMaxSurfacePoints);
  return cloud.empty() ? "" : eval::ply_text(cloud);
}

}  // namespace stillpoint::report
