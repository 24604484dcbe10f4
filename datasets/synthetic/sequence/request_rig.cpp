// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/request_rig.h"

#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/calibration/rig_file.h"

namespace stillpoint::synth {
namespace {

/// Rays are found by inverting the distortion, which strong coefficients do not allow near the border.
void require_invertible(const std::filesystem::path& file, const Camera& camera) {
  constexpr int kSteps = 16;
  constexpr double kMostError_px = 0.01;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel((camera.width - 1.0) * column / kSteps,
                                  (camera.height - 1.0) * row / kSteps);
      const Eigen::Vector3d ray = camera.unproject(pixel).homogeneous();
      if (ray.allFinite() && (camera.project(ray) - pixel).norm() < kMostError_px) continue;
      throw InputError(file.string(),
                       fmt::format("its distortion has no ray for the pixel ({:.0f}, {:.0f}); use "
                                   "coefficients that hold for the whole image",
                                   pixel.x(), pixel.y()));
    }
  }
}

Rig read_rig(const std::filesystem::path& file, const Rig& defaults) {
  const datasets::OverriddenRig read = datasets::apply_rig_file(file, defaults);
  if (read.rig.camera.model != CameraModel::kRadialTangential) {
    throw InputError(file.string(),
                     "has a fisheye camera, which is not rendered; use a radial-tangential one");
  }
  if (read.depth_camera) {
    throw InputError(file.string(),
                     "has a depth camera of its own, but depth is rendered in the color camera; "
                     "remove all of [depth] but scale");
  }
  require_invertible(file, read.rig.camera);
  return read.rig;
}

}  // namespace

Pose realsense_T_b_c() {
  // Pose of the accelerometer in the color camera, from the calibration of an OpenLORIS package.
  Eigen::Matrix4d T_c_b;
  T_c_b << 0.999976, -0.00378981, -0.00580659, -0.0203839, 0.00381011, 0.999987, 0.00348894, 0.00506166,
      0.00579329, -0.00351098, 0.999977, 0.0110642, 0.0, 0.0, 0.0, 1.0;
  return Pose::from_matrix(T_c_b).inverse();
}

Rig rig_of(const SynthRequest& request) {
  Rig rig;
  rig.camera = {.width = request.width,
                .height = request.height,
                .fx = request.focal_px,
                .fy = request.focal_px,
                .cx = 0.5 * (request.width - 1),
                .cy = 0.5 * (request.height - 1)};
  rig.T_b_c = realsense_T_b_c();
  if (!request.rig_file.empty()) {
    rig = read_rig(request.rig_file, rig);
    if (rig.camera.width != request.width || rig.camera.height != request.height) {
      throw InputError(request.rig_file.string(),
                       "states another image size than the request; take it by use_rig");
    }
  }
  rig.depth_units_per_m = request.depth.units_per_m;
  rig.has_imu = request.layout == SequenceLayout::kOpenLoris;
  rig.imu_noise = request.imu.noise;
  rig.imu_axes = {};            // those of the rendered samples are exact
  rig.depth_offset = 0.0;       // as is the rendered depth
  rig.time_offset_s = 0.0;      // a rendered delay is not part of the calibration that is written,
  rig.rolling_shutter_s = 0.0;  // nor is the read-out time
  return rig;
}

void use_rig(SynthRequest& request, const std::filesystem::path& file) {
  Rig rig = rig_of(request);
  rig.time_offset_s = request.imu.time_offset_s;
  rig.rolling_shutter_s = request.rolling_shutter_s;
  rig = read_rig(file, rig);
  request.rig_file = file;
  request.width = rig.camera.width;
  request.height = rig.camera.height;
  request.focal_px = std::sqrt(rig.camera.fx * rig.camera.fy);
  request.rolling_shutter_s = rig.rolling_shutter_s;
  request.depth.units_per_m = rig.depth_units_per_m;
  request.imu.noise = rig.imu_noise;
  request.imu.time_offset_s = rig.time_offset_s;
}

}  // namespace stillpoint::synth
