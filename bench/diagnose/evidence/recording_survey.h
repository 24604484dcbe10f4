// SPDX-License-Identifier: BSD-3-Clause
/// One pass over the frames of a recording: statistics of images and depth, and the motion between images.
/// The motion is that of a run without IMU where it located the camera (people do not disturb it), else that
/// by alignment of brightness (ImageMotion).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/angular_rates.h"
#include "datasets/sensor_stream.h"
#include "datasets/sequence_plausibility.h"

namespace stillpoint::bench {

struct FrameStatistics {
  Timestamp t;
  double mean_gray = 0.0;
  double deviation_gray = 0.0;  ///< standard deviation of the gray values
  double dark_ratio = 0.0;      ///< fraction of pixels below 5
  double bright_ratio = 0.0;    ///< fraction of pixels above 250
  /// Root mean square of the Laplacian to the standard deviation of the gray values: small for images that
  /// are blurred along any direction (variance of the Laplacian, Pech-Pacheco et al. 2000).
  double sharpness = 0.0;
  double depth_ratio = 0.0;  ///< fraction of pixels with depth
  bool same_image = false;   ///< as the frame before
  bool same_depth = false;
  std::optional<Pose> T_now_last{};    ///< motion of the camera since the last frame
  std::vector<std::uint16_t> depth{};  ///< every 16th pixel in both directions, row by row
};

struct RecordingSurvey {
  std::vector<FrameStatistics> frames;
  int unreadable = 0;                                        ///< frames
  std::optional<datasets::DepthScaleByTruth> depth_scale{};  ///< by which depth is too small

  /// Angular rates of the camera between the frames whose images determine them.
  [[nodiscard]] std::vector<datasets::RateInterval> rates() const;
};

/// @throws InputError for a recording without inertial data whose first frame has no depth image: the
/// odometry locates none of its frames
void require_depth_or_imu(const datasets::SensorStream& stream);

/// Distance of the pixels of `FrameStatistics::depth`.
inline constexpr int kSurveyStep_px = 16;

/// @param visual trajectory of the camera by a run without IMU; used if it has most of the frames
/// @param stop_requested polled before each frame; on true the rest is left out
[[nodiscard]] RecordingSurvey survey_recording(const datasets::SensorStream& stream, const Trajectory& visual,
                                               const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
