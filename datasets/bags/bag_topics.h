// SPDX-License-Identifier: BSD-3-Clause
/// Selects the topics of a bag that make up a sequence.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/image_message.h"

namespace stillpoint::datasets {

/// All connections of one topic.
struct TopicSummary {
  std::string topic;
  std::string type;
  std::size_t messages = 0;
  ImageContent image = ImageContent::kOther;  ///< of its first message
  std::string encoding;                       ///< encoding or format of its first image
};

/// The topics with at least one message, in alphabetical order. Reads the first message of image topics.
[[nodiscard]] std::vector<TopicSummary> summarize_topics(const BagFile& bag);

/// Selected topics; empty where the bag has none.
struct BagTopics {
  std::string color;
  std::string depth;
  std::string imu;    ///< both inertial sensors
  std::string gyro;   ///< if they are in two topics
  std::string accel;  ///< if they are in two topics
  std::string truth;  ///< poses of a reference system
};

/// Selects topics by type and name.
///
/// Color: an image with a color or gray encoding; names with "color" or "rgb" are preferred to others, and
/// those of infrared and fisheye cameras come last. Depth: an image with a depth encoding; names with
/// "aligned" or "registered" are preferred. Of equal ones, uncompressed images are preferred. IMU: one
/// topic for both sensors, or one with "gyro" and one with "accel" in its name; those that begin with the
/// same name as the color topic are preferred. Ground truth: poses whose topic names a reference system.
/// @param requested "ROLE=TOPIC" with a role of `BagTopics`, overrides the selection; "ROLE=" selects none
/// @throws InputError if a request is malformed or its topic is not in the bag or has another type, or there
/// is no color topic
[[nodiscard]] BagTopics select_topics(const BagFile& bag, std::span<const std::string> requested);

/// "color /a, depth /b, ..." for messages.
[[nodiscard]] std::string topics_text(const BagTopics& topics);

}  // namespace stillpoint::datasets
