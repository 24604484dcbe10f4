// SPDX-License-Identifier: BSD-3-Clause
/// Calibration of the cameras of a bag.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "datasets/calibration/transform_graph.h"

namespace stillpoint::datasets {

/// The first camera info of an image topic: of the topic `camera_info` beside it, in recordings of
/// librealsense of `info/camera_info`, else of any topic whose message has the frame of the images.
/// @return nullopt without one, or if it is not calibrated (fx = 0)
[[nodiscard]] std::optional<CameraInfoMessage> find_camera_info(const BagFile& bag,
                                                                const std::string& image_topic,
                                                                const std::string& image_frame);

/// The camera of an image topic. A topic with "rect" in its name has rectified images: focal lengths and
/// principal point of P, without distortion. Others: K and D, models plumb_bob, rational_polynomial
/// without its denominator, equidistant, and any model whose coefficients are all 0.
/// @throws InputError if the distortion model is another one
[[nodiscard]] Camera camera_of(const CameraInfoMessage& info, const std::string& image_topic,
                               const std::string& place);

/// Recordings of librealsense: topics /device_N/sensor_M/STREAM/..., no frames in the headers. Their
/// extrinsics are in the topics STREAM/tf/REFERENCE.
struct RealsenseStreams {
  std::vector<NamedTransform> links;  ///< the streams, named as by `realsense_stream`, in their reference
  double depth_units_per_m = 1000.0;
};

/// "/device_0/sensor_1/Color_0" of a topic of that stream; nullopt in other bags.
[[nodiscard]] std::optional<std::string> realsense_stream(const std::string& topic);

/// Reads the extrinsics and the unit of depth.
[[nodiscard]] RealsenseStreams read_realsense_streams(const BagFile& bag);

}  // namespace stillpoint::datasets
