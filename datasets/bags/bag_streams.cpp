// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_streams.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "datasets/bags/messages.h"
#include "datasets/io/imu_file.h"

namespace stillpoint::datasets {
namespace {

constexpr std::uint64_t kHeaderBytes =
    1024;  ///< contains the header of a message and the encoding of an image

/// Items of one topic; repaired stamps are counted.
template <class Item>
class Stream {
 public:
  void add(const Item& item) {
    unordered_ += !items_.empty() && item.t < items_.back().t;
    items_.push_back(item);
  }

  /// The items, sorted and without repeated stamps; warnings are appended to `streams`.
  [[nodiscard]] std::vector<Item> finish(const std::string& place, std::vector<std::string>& warnings) {
    std::ranges::stable_sort(items_, {}, &Item::t);
    const auto repeated = std::ranges::unique(items_, {}, &Item::t);
    if (!repeated.empty())
      warnings.push_back(place + ": " + std::to_string(repeated.size()) +
                         " messages with the time stamp of an earlier one are dropped");
    if (unordered_ > 0)
      warnings.push_back(place + ": " + std::to_string(unordered_) +
                         " messages have an earlier time stamp than their predecessor and are sorted");
    items_.erase(repeated.begin(), repeated.end());
    return std::move(items_);
  }

 private:
  std::vector<Item> items_;
  std::size_t unordered_ = 0;
};

Eigen::Vector3d in_range(const Eigen::Vector3d& value, const SensorRange& range, std::string_view place) {
  if (value.allFinite() && value.cwiseAbs().maxCoeff() <= range.limit) return value;
  throw InputError(std::string(place),
                   "the " + std::string(range.quantity) + " exceeds " +
                       std::to_string(std::lround(range.limit)) + " " + std::string(range.unit) +
                       ", the range of such sensors; is it in " + std::string(range.likely_unit) + "?");
}

/// Collects the messages of the selected topics.
class StreamCollector {
 public:
  StreamCollector(const BagFile& bag, const BagTopics& topics) : bag_(bag), topics_(topics) {}

  [[nodiscard]] bool wants(const MessageReference& reference) const {
    const std::string& topic = bag_.connection(reference).topic;
    return topic == topics_.color || topic == topics_.depth || is_inertial(topic);
  }

  void add(const MessageReference& reference) {
    const BagConnection& connection = bag_.connection(reference);
    const std::string place = bag_.place(reference);
    const std::string bytes = bag_.payload(reference, kHeaderBytes);
    const SerializedMessage message{.bytes = bytes, .format = connection.format, .place = place};
    if (is_inertial(connection.topic)) {
      add_inertial(connection.topic, message, reference.message.t);
    } else {
      add_image(connection, message, reference);
    }
  }

  [[nodiscard]] BagStreams finish() {
    const auto place = [this](const std::string& topic) { return bag_.path().string() + ":" + topic; };
    streams_.color = color_.finish(place(topics_.color), streams_.warnings);
    streams_.depth = depth_.finish(place(topics_.depth), streams_.warnings);
    if (!topics_.imu.empty()) {
      streams_.imu = imu_.finish(place(topics_.imu), streams_.warnings);
    } else if (!topics_.gyro.empty() && !topics_.accel.empty()) {
      streams_.imu = merge_onto_gyro(gyro_.finish(place(topics_.gyro), streams_.warnings),
                                     accel_.finish(place(topics_.accel), streams_.warnings));
    }
    return std::move(streams_);
  }

 private:
  [[nodiscard]] bool is_inertial(const std::string& topic) const {
    return topic == topics_.imu || topic == topics_.gyro || topic == topics_.accel;
  }

  void add_image(const BagConnection& connection, const SerializedMessage& message,
                 const MessageReference& reference) {
    const MessageHeader header = parse_header(message);
    const bool is_color = connection.topic == topics_.color;
    Stream<StampedImage>& stream = is_color ? color_ : depth_;
    std::string& frame = is_color ? streams_.color_frame : streams_.depth_frame;
    if (frame.empty()) {
      frame = header.frame;
      if (!is_color) streams_.float_depth = has_meters(connection.type, message);
    }
    stream.add({.t = header.stamp.ns == 0 ? reference.message.t : header.stamp, .message = reference});
  }

  static bool has_meters(const std::string& type, const SerializedMessage& message) {
    return has_float_depth(type == "sensor_msgs/Image" ? parse_image_head(message).encoding
                                                       : parse_compressed_image_head(message).format);
  }

  void add_inertial(const std::string& topic, const SerializedMessage& message, Timestamp recorded) {
    const ImuMessage sample = parse_imu(message);
    const Timestamp t = sample.header.stamp.ns == 0 ? recorded : sample.header.stamp;
    if (streams_.imu_frame.empty() && topic != topics_.accel) streams_.imu_frame = sample.header.frame;
    if (topic == topics_.imu) {
      imu_.add({.t = t,
                .gyro_b = in_range(sample.gyro, kGyroscopeRange, message.place),
                .accel_b = in_range(sample.accel, kAccelerometerRange, message.place)});
    } else if (topic == topics_.gyro) {
      gyro_.add({.t = t, .value = in_range(sample.gyro, kGyroscopeRange, message.place)});
    } else {
      accel_.add({.t = t, .value = in_range(sample.accel, kAccelerometerRange, message.place)});
    }
  }

  const BagFile& bag_;
  const BagTopics& topics_;
  BagStreams streams_;
  Stream<StampedImage> color_;
  Stream<StampedImage> depth_;
  Stream<ImuSample> imu_;
  Stream<VectorSample> gyro_;
  Stream<VectorSample> accel_;
};

}  // namespace

BagStreams read_bag_streams(const BagFile& bag, const BagTopics& topics, FaultLog& faults) {
  StreamCollector collector(bag, topics);
  std::vector<MessageReference> wanted;
  std::ranges::copy_if(
      bag.messages(), std::back_inserter(wanted),
      [&collector](const MessageReference& reference) { return collector.wants(reference); });
  for (const MessageReference& reference : in_file_order(wanted)) {
    faults.guard([&] { collector.add(reference); });
  }
  return collector.finish();
}

}  // namespace stillpoint::datasets
