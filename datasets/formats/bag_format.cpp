// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/bag_format.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/content_hash.h"
#include "core/base/counted.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/bags/messages.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/nmea_file.h"

namespace stillpoint::datasets {
namespace {

/// Contains the header of a message and the encoding of an image.
constexpr std::uint64_t kHeaderBytes = 1024;

/// Items of one topic; repaired stamps are counted.
template <class Item>
class Stream {
 public:
  /// @param item with the stamp of its header
  void add(const Item& item, Timestamp recorded) {
    items_.push_back(item);
    recorded_.push_back(recorded);
  }

  /// The items, sorted and without repeated stamps; warnings are appended to `warnings`.
  [[nodiscard]] std::vector<Item> finish(const std::string& place, std::vector<std::string>& warnings) {
    set_missing_stamps(place, warnings);
    const auto is_earlier = [](const Item& a, const Item& b) { return a.t < b.t; };
    std::size_t unordered = 0;
    for (std::size_t i = 1; i < items_.size(); ++i) unordered += is_earlier(items_[i], items_[i - 1]) ? 1 : 0;
    std::ranges::stable_sort(items_, is_earlier);
    const auto repeated =
        std::unique(items_.begin(), items_.end(), [](const Item& a, const Item& b) { return a.t == b.t; });
    if (repeated != items_.end())
      warnings.push_back(place + ": " + std::to_string(items_.end() - repeated) +
                         " messages with the time stamp of an earlier one are dropped");
    if (unordered > 0)
      warnings.push_back(place + ": " + std::to_string(unordered) +
                         " messages have an earlier time stamp than their predecessor and are sorted");
    items_.erase(repeated, items_.end());
    return std::move(items_);
  }

 private:
  /// Stamps that are 0 become the time of recording plus the median difference of the others of the topic,
  /// which is the delay of the transport, or of another clock.
  void set_missing_stamps(const std::string& place, std::vector<std::string>& warnings) {
    std::vector<std::int64_t> differences_ns;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (items_[i].t.ns != 0) differences_ns.push_back(items_[i].t.ns - recorded_[i].ns);
    }
    const std::size_t missing = items_.size() - differences_ns.size();
    if (missing == 0) return;
    std::int64_t difference_ns = 0;
    if (!differences_ns.empty()) {
      const auto middle = differences_ns.begin() + static_cast<std::ptrdiff_t>(differences_ns.size() / 2);
      std::nth_element(differences_ns.begin(), middle, differences_ns.end());
      difference_ns = *middle;
    }
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (items_[i].t.ns == 0) items_[i].t.ns = recorded_[i].ns + difference_ns;
    }
    warnings.push_back(place + ": " + std::to_string(missing) + " of " + std::to_string(items_.size()) +
                       " messages have the stamp 0; the time of their recording is used" +
                       (differences_ns.empty() ? "" : ", with the median delay of the others"));
  }

  std::vector<Item> items_;
  std::vector<Timestamp> recorded_;
};

Eigen::Vector3d in_range(const Eigen::Vector3d& value, const SensorRange& range, std::string_view place) {
  if (value.cwiseAbs().maxCoeff() <= range.limit) return value;
  throw SensorRangeError(
      InputError(std::string(place), "the " + std::string(range.quantity) + " exceeds " +
                                         std::to_string(std::lround(range.limit)) + " " +
                                         std::string(range.unit) + ", the range of such sensors; is it in " +
                                         std::string(range.likely_unit) + "?"),
      range);
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
    add_warnings();
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
    stream.add({.t = header.stamp, .message = reference}, reference.message.t);
  }

  void add_warnings() {
    for (const auto& [topic, count] : not_finite_)
      streams_.warnings.push_back(fmt::format("{}:{}: {} with NaN or infinite values skipped",
                                              bag_.path().string(), topic, counted(count, "message")));
  }

  static bool has_meters(const std::string& type, const SerializedMessage& message) {
    return has_float_depth(type == "sensor_msgs/Image" ? parse_image_head(message).encoding
                                                       : parse_compressed_image_head(message).format);
  }

  void add_inertial(const std::string& topic, const SerializedMessage& message, Timestamp recorded) {
    const ImuMessage sample = parse_imu(message);
    const bool is_finite = (topic == topics_.accel || sample.gyro.allFinite()) &&
                           (topic == topics_.gyro || sample.accel.allFinite());
    if (!is_finite) {
      ++not_finite_[topic];
      return;
    }
    const Timestamp t = sample.header.stamp;
    if (streams_.imu_frame.empty() && topic != topics_.accel) streams_.imu_frame = sample.header.frame;
    if (topic == topics_.imu) {
      imu_.add({.t = t,
                .gyro_b = in_range(sample.gyro, kGyroscopeRange, message.place),
                .accel_b = in_range(sample.accel, kAccelerometerRange, message.place)},
               recorded);
    } else if (topic == topics_.gyro) {
      gyro_.add({.t = t, .value = in_range(sample.gyro, kGyroscopeRange, message.place)}, recorded);
    } else {
      accel_.add({.t = t, .value = in_range(sample.accel, kAccelerometerRange, message.place)}, recorded);
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
  std::map<std::string, std::size_t> not_finite_;  ///< messages by topic
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

namespace {

constexpr double kRealsenseMaxDepthUnits = 1e6;

/// The images of a sequence in its bag.
struct BagImages {
  std::shared_ptr<const BagFile> bag;
  std::vector<MessageReference> color;  ///< one per frame
  std::vector<MessageReference> depth;  ///< one per frame, or empty
};

template <class Decode>
cv::Mat decode_message(const BagFile& bag, const MessageReference& reference, const Decode& decode) {
  const std::string bytes = bag.payload(reference);
  const std::string place = bag.place(reference);
  const SerializedMessage message{.bytes = bytes, .format = bag.connection(reference).format, .place = place};
  if (bag.connection(reference).type == "sensor_msgs/Image") return decode(parse_image(message), place);
  return decode(parse_compressed_image(message), place);
}

/// Of the position of a message and the state of the file: the bag is not read to find cached frames.
std::uint64_t digest_of(const BagFile& bag, const MessageReference& reference) {
  return content_hash(bag.connection(reference).topic + " " + std::to_string(reference.message.chunk) + " " +
                          std::to_string(reference.message.offset),
                      bag.state() + reference.file);
}

ImageSource source_of(const std::shared_ptr<const BagImages>& images) {
  return {.color =
              [images](std::size_t frame) {
                return decode_message(*images->bag, images->color[frame],
                                      [](const auto& image, const std::string& place) {
                                        return decode_color_message(image, place);
                                      });
              },
          .depth =
              [images](std::size_t frame) {
                return decode_message(*images->bag, images->depth[frame],
                                      [](const auto& image, const std::string& place) {
                                        return decode_depth_message(image, place);
                                      });
              },
          .digest =
              [images](std::size_t frame) {
                return FrameDigest{
                    .color = digest_of(*images->bag, images->color[frame]),
                    .depth = images->depth.empty() ? 0 : digest_of(*images->bag, images->depth[frame])};
              }};
}

std::vector<Timestamp> times_of(const std::vector<StampedImage>& images) {
  std::vector<Timestamp> times;
  times.reserve(images.size());
  for (const StampedImage& image : images) times.push_back(image.t);
  return times;
}

/// Pairs of images less than 20 ms apart; without depth, all color images.
void add_frames(SequenceContent& content, const BagStreams& streams,
                const std::shared_ptr<const BagFile>& bag) {
  auto images = std::make_shared<BagImages>();
  images->bag = bag;
  const auto add = [&](const StampedImage& color, const StampedImage* depth) {
    content.info.frame_times.push_back(color.t);
    images->color.push_back(color.message);
    if (depth != nullptr) images->depth.push_back(depth->message);
    content.frame_files.push_back(
        {.color = bag->place(color.message),
         .depth = depth == nullptr ? std::string() : bag->place(depth->message),
         .depth_offset_s = depth == nullptr ? 0.0 : seconds_between(color.t, depth->t)});
  };
  if (streams.depth.empty()) {
    for (const StampedImage& color : streams.color) add(color, nullptr);
  } else {
    // The pairs are in the order of the second list, which the frame times must follow.
    for (const auto& [in_depth, in_color] :
         eval::associate_tum(times_of(streams.depth), times_of(streams.color), kImageAssociation))
      add(streams.color[in_color], &streams.depth[in_depth]);
  }
  if (images->color.empty())
    throw InputError(bag->path().string(),
                     "no depth image is less than 20 ms from a color image; select other topics with "
                     "--topics, or none with \"--topics depth=\"");
  if (const std::size_t unpaired = streams.color.size() - images->color.size(); unpaired > 0)
    content.info.notes.push_back(std::to_string(unpaired) + " of " + std::to_string(streams.color.size()) +
                                 " color images have no depth image less than 20 ms away and are dropped");
  content.images = source_of(images);
}

/// The fixed transforms of a bag, and the names of the frames in them.
struct BagFrames {
  std::vector<NamedTransform> links;
  std::string color;
  std::string depth;
  std::string imu;
};

BagFrames frames_of(const BagFile& bag, const BagTopics& topics, const BagStreams& streams,
                    const RealsenseStreams& realsense) {
  BagFrames frames{.links = read_fixed_transforms(bag),
                   .color = streams.color_frame,
                   .depth = streams.depth_frame,
                   .imu = streams.imu_frame};
  frames.links.insert(frames.links.end(), realsense.links.begin(), realsense.links.end());
  const auto name_of = [](const std::string& topic, const std::string& frame) {
    return realsense_stream(topic).value_or(frame);
  };
  frames.color = name_of(topics.color, frames.color);
  frames.depth = name_of(topics.depth, frames.depth);
  frames.imu = name_of(topics.imu.empty() ? topics.gyro : topics.imu, frames.imu);
  return frames;
}

/// Registered depth may have the nominal calibration of a camera whose color image has an estimated one.
bool is_same_camera(const Camera& a, const Camera& b, bool same_frame) {
  const double tolerance = same_frame ? 0.05 : 0.0;
  const auto differs = [tolerance](double x, double y, double scale) {
    return std::abs(x - y) > tolerance * scale;
  };
  return a.width == b.width && a.height == b.height && !differs(a.fx, b.fx, b.fx) &&
         !differs(a.fy, b.fy, b.fy) && !differs(a.cx, b.cx, b.width) && !differs(a.cy, b.cy, b.height);
}

/// Sets the registration of depth if it is that of another camera than the color image.
void set_depth_camera(SequenceContent& content, const BagFile& bag, const BagTopics& topics,
                      const BagFrames& frames) {
  const bool same_frame = frames.depth == frames.color;
  const std::optional<CameraInfoMessage> info = find_camera_info(bag, topics.depth, frames.depth);
  if (!info) {
    if (!same_frame)
      content.info.warnings.push_back("depth: its frame \"" + frames.depth +
                                      "\" is not that of the color image, \"" + frames.color +
                                      "\", and the bag has no CameraInfo for " + topics.depth +
                                      "; it is taken for registered to the color image, unless a rig.toml "
                                      "states its camera in [depth]");
    return;
  }
  const Camera depth = camera_of(*info, topics.depth, bag.path().string());
  if (is_same_camera(depth, content.info.rig.camera, same_frame)) return;
  const std::optional<Pose> T_c_d =
      same_frame ? Pose{} : find_transform(frames.links, frames.color, frames.depth);
  content.info.depth_camera = DepthCamera{.camera = depth, .T_c_d = T_c_d.value_or(Pose{})};
  content.info.notes.push_back("depth of " + topics.depth + " is registered to the color camera");
  if (!T_c_d)
    content.info.warnings.push_back(
        "depth: is that of another camera, and no transform of the bag connects \"" + frames.color +
        "\" and \"" + frames.depth + "\"; it is registered as if both were at the same place");
}

/// Sets the camera of the color image, and that of depth.
void set_cameras(SequenceContent& content, const BagFile& bag, const BagTopics& topics,
                 const BagFrames& frames) {
  const std::optional<CameraInfoMessage> color = find_camera_info(bag, topics.color, frames.color);
  if (!color) {
    content.missing_calibration = "the bag has no calibrated CameraInfo for " + topics.color;
    return;
  }
  Camera& camera = content.info.rig.camera;
  try {
    camera = camera_of(*color, topics.color, "CameraInfo of " + topics.color);
  } catch (const InputError& error) {
    content.missing_calibration = error.what();
    return;
  }
  content.info.notes.push_back("calibration: CameraInfo of " + topics.color);
  if (!topics.depth.empty()) set_depth_camera(content, bag, topics, frames);
}

void set_imu(SequenceContent& content, const BagFrames& frames) {
  content.info.rig.has_imu = true;
  const std::optional<Pose> T_b_c = find_transform(frames.links, frames.imu, frames.color);
  content.extrinsic_known = T_b_c.has_value() && !frames.imu.empty() && !frames.color.empty();
  if (T_b_c) content.info.rig.T_b_c = *T_b_c;
  content.info.notes.emplace_back(
      "imu: default noise densities, unless a rig.toml sets [imu] gyro_noise etc.");
}

void set_ground_truth(SequenceContent& content, const BagFile& bag, const std::string& topic,
                      const BagFrames& frames) {
  eval::LoadedTrajectory truth = read_bag_trajectory(bag, topic);
  if (truth.trajectory.frame == eval::kGnssFrame) {
    content.info.notes.emplace_back(
        "ground truth: positions of a GNSS antenna, whose orientations and distance to the camera are "
        "unknown");
    content = with_ground_truth(std::move(content), std::move(truth));
    return;
  }
  // OpenLORIS: the poses of /gt are those of the base of the robot.
  std::string frame = truth.trajectory.frame;
  if (frame.empty()) frame = "base_link";
  const std::optional<Pose> T_c_f = find_transform(frames.links, frames.color, frame);
  if (T_c_f) content.info.ground_truth.T_c_f = *T_c_f;
  if (!T_c_f)
    content.info.notes.push_back(
        "ground truth: the bag has no transform from its frame to the camera; it is compared as if it were "
        "the pose of the camera");
  truth.trajectory.frame = T_c_f ? frame : topic;
  content = with_ground_truth(std::move(content), std::move(truth));
}

}  // namespace

SequenceContent read_bag_sequence(const std::filesystem::path& path, std::span<const std::string> requested,
                                  FaultLog& faults) {
  const auto bag = std::make_shared<const BagFile>(path);
  const BagTopics topics = select_topics(*bag, requested);
  const BagStreams streams = read_bag_streams(*bag, topics, faults);
  const RealsenseStreams realsense = read_realsense_streams(*bag);
  const BagFrames frames = frames_of(*bag, topics, streams, realsense);
  SequenceContent content;
  content.info.name = path.stem().string();
  content.info.folder = path;
  content.info.notes.push_back("topics: " + topics_text(topics));
  content.info.warnings = bag->warnings();
  content.info.warnings.insert(content.info.warnings.end(), streams.warnings.begin(), streams.warnings.end());
  if (!topics.unclear_depth.empty())
    content.info.warnings.push_back(
        "depth: no topic is named as depth; " + topics.unclear_depth +
        " has images of 16 bits: if they are depth, select it with --topics depth=" + topics.unclear_depth);
  if (streams.color.empty()) throw InputError(path.string(), "contains no readable image of " + topics.color);
  add_frames(content, streams, bag);
  content.info.rig.depth_units_per_m = streams.float_depth
                                           ? kFloatDepthUnitsPerM
                                           : std::min(realsense.depth_units_per_m, kRealsenseMaxDepthUnits);
  set_cameras(content, *bag, topics, frames);
  content.info.imu = streams.imu;
  if (!streams.imu.empty()) set_imu(content, frames);
  if (!topics.truth.empty()) faults.guard([&] { set_ground_truth(content, *bag, topics.truth, frames); });
  return content;
}

SequenceContent with_metric_accelerations(SequenceContent content) {
  if (content.info.imu.empty()) return content;
  constexpr double kGravity = 9.80665;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double norms = 0.0;
  for (const ImuSample& sample : content.info.imu) {
    sum += sample.accel_b;
    norms += sample.accel_b.norm();
  }
  const double mean_norm = norms / static_cast<double>(content.info.imu.size());
  if (mean_norm < 0.8 || mean_norm > 1.2) return content;
  const Eigen::Vector3d force_c = content.info.rig.T_b_c.R().transpose() * sum;
  const bool inverted = content.extrinsic_known && force_c.y() > 0.7 * force_c.norm();
  for (ImuSample& sample : content.info.imu) sample.accel_b *= inverted ? -kGravity : kGravity;
  content.info.warnings.push_back(
      "imu: the mean acceleration is " + std::to_string(mean_norm) +
      ", that is, the unit is g; accelerations are converted to m/s^2" +
      (inverted ? ", and their sign is inverted, as gravity points up in the images" : ""));
  return content;
}

const SequenceFormat kBagFormat{.name = "bag",
                                .signature = "the extension .bag, .mcap or .db3, or metadata.yaml of rosbag2",
                                .recognize = eval::is_bag,
                                .read = [](const std::filesystem::path& path, FaultLog& faults) {
                                  return read_bag_sequence(path, {}, faults);
                                }};

}  // namespace stillpoint::datasets
