// SPDX-License-Identifier: BSD-3-Clause
/// The message types of recordings for viewers: those that Foxglove publishes (docs.foxglove.dev, "Message
/// schemas"; names and numbers of fields as in its .proto files), and those of this project in the package
/// `stillpoint`. Both Foxglove and rerun read the first by their names; the others are shown by their fields.
///
///   stillpoint.Status  status of the odometry after a frame, and its counters
///   stillpoint.State   estimate with covariance: pose of the body, velocity, biases, calibration
///   stillpoint.Claim   status and standard deviations along the least certain directions, of a stored run
///   stillpoint.Timings times of the modules in a frame
///   stillpoint.Imu     one inertial sample
///   stillpoint.Loop    one recognized place, accepted or refused
#pragma once

#include <string>
#include <string_view>

namespace stillpoint::datasets {

/// The schema of a type in MCAP files: an encoded google.protobuf.FileDescriptorSet with the type and all
/// types that it contains.
/// @param type full name, e.g. "foxglove.PoseInFrame"; one of the types above
[[nodiscard]] std::string protobuf_schema(std::string_view type);

}  // namespace stillpoint::datasets
