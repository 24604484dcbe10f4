// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/bags/messages.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "datasets/sequence_validator.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/small_stream.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kStart_ns = 100'000'000'000;

Timestamp at_ms(std::int64_t ms) { return {kStart_ns + ms * 1'000'000}; }

/// Writes a bag message by message.
class BagBuilder {
 public:
  explicit BagBuilder(const std::filesystem::path& path) : writer_(path, ChunkCompression::kNone) {}

  void image(const std::string& topic, Timestamp t, const std::string& encoding,
             const std::string& frame = "cam") {
    const std::size_t pixel = encoding == "rgb8" || encoding == "8UC3" ? 3
                              : encoding == "mono8"                    ? 1
                              : encoding == "32FC1"                    ? 4
                                                                       : 2;
    std::string data(8 * 6 * pixel, '\1');
    if (encoding == "32FC1") {
      for (std::size_t i = 0; i < 48; ++i) std::memcpy(data.data() + 4 * i, &kTwoMeters, 4);
    }
    write(topic, "sensor_msgs/Image", t,
          serialize(ImageMessage{.header = {.stamp = t, .frame = frame},
                                 .height = 6,
                                 .width = 8,
                                 .encoding = encoding,
                                 .step = static_cast<std::uint32_t>(8 * pixel),
                                 .data = data},
                    writer_.format()));
  }

  /// A gray image whose stamp is not the time of its recording.
  void delayed_image(const std::string& topic, Timestamp stamp, Timestamp recorded) {
    const std::string data(48, '\1');
    write(topic, "sensor_msgs/Image", recorded,
          serialize(ImageMessage{.header = {.stamp = stamp, .frame = "cam"},
                                 .height = 6,
                                 .width = 8,
                                 .encoding = "mono8",
                                 .step = 8,
                                 .data = data},
                    writer_.format()));
  }

  void camera_info(const std::string& topic, double fx, const std::string& model = "plumb_bob",
                   std::vector<double> D = {}) {
    const CameraInfoMessage info{.header = {.stamp = at_ms(0), .frame = "cam"},
                                 .height = 6,
                                 .width = 8,
                                 .distortion_model = model,
                                 .D = std::move(D),
                                 .K = {fx, 0, 4, 0, fx, 3, 0, 0, 1},
                                 .P = {}};
    write(topic, "sensor_msgs/CameraInfo", at_ms(0), serialize(info, writer_.format()));
  }

  void imu(const std::string& topic, Timestamp t, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
    write(topic, "sensor_msgs/Imu", t,
          serialize(ImuMessage{.header = {.stamp = t, .frame = "imu"}, .gyro = gyro, .accel = accel},
                    writer_.format()));
  }

  void transform(const std::string& parent, const std::string& child, const Pose& pose) {
    transform("/tf_static", at_ms(0),
              {.header = {.stamp = at_ms(0), .frame = parent}, .child = child, .pose = pose});
  }

  void transform(const std::string& topic, Timestamp t, const PoseMessage& link) {
    write(topic, "tf2_msgs/TFMessage", t, serialize_transforms(std::span(&link, 1), writer_.format()));
  }

  void pose(const std::string& topic, Timestamp t, double x) {
    const PoseMessage pose{.header = {.stamp = t, .frame = "world"},
                           .child = "",
                           .pose = Pose{Eigen::Quaterniond::Identity(), {x, 0, 0}}};
    write(topic, "geometry_msgs/PoseStamped", t,
          serialize_pose(pose, "geometry_msgs/PoseStamped", writer_.format()));
  }

  void stream_transform(const std::string& topic, const Pose& pose) {
    write(topic, "geometry_msgs/Transform", at_ms(0), serialize_transform(pose, writer_.format()));
  }

  void value(const std::string& topic, float value) {
    write(topic, "std_msgs/Float32", at_ms(0), serialize_float(value, writer_.format()));
  }

  void finish() { writer_.finish(); }

 private:
  static constexpr float kTwoMeters = 2.0F;

  void write(const std::string& topic, const std::string& type, Timestamp t, const std::string& bytes) {
    const auto known = connections_.find(topic);
    const std::uint32_t connection =
        known != connections_.end() ? known->second : writer_.add_connection(topic, type);
    connections_.emplace(topic, connection);
    writer_.write(connection, t, bytes);
  }

  BagWriter writer_;
  std::map<std::string, std::uint32_t> connections_;
};

bool has_note(const SequenceInfo& info, const std::string& text) {
  return std::ranges::any_of(
      info.notes, [&text](const std::string& note) { return note.find(text) != std::string::npos; });
}

/// The sequence of a bag with three color images and what `add` writes.
template <class Add>
SequenceInfo info_of_bag(const Add& add, std::vector<std::string> topics = {}) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/rgb/camera_info", 10.0);
  bag.transform("imu", "cam", Pose{});
  for (int i = 0; i < 3; ++i) bag.image("/rgb/image_raw", at_ms(40 * i), "rgb8");
  add(bag);
  bag.finish();
  return open_sequence(folder.path() / "a.bag", {.format = {}, .rig_file = {}, .topics = std::move(topics)})
      ->info();
}

bool has_warning(const SequenceInfo& info, const std::string& text) {
  return std::ranges::any_of(
      info.warnings, [&text](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

TEST(BagSequence, InfraredBrightnessIsNoDepth) {
  for (const auto& [topic, encoding] : {std::pair("/ir/image_raw", "mono16"),
                                        {"/left/image", "mono16"},
                                        {"/camera/infra1/image_rect_raw", "16UC1"},
                                        {"/ir/image", "16UC1"}}) {
    const SequenceInfo info = info_of_bag([&](BagBuilder& bag) {
      for (int i = 0; i < 3; ++i) bag.image(topic, at_ms(40 * i), encoding);
    });
    EXPECT_FALSE(has_note(info, "depth /")) << topic;
  }
  const SequenceInfo info = info_of_bag([&](BagBuilder& bag) {
    for (int i = 0; i < 3; ++i) bag.image("/depth/image_raw", at_ms(40 * i), "mono16");
  });
  EXPECT_TRUE(has_note(info, "depth /depth/image_raw"));
}

TEST(BagSequence, ImagesOf16BitsThatNoNameTellsAreReported) {
  const auto with_range = [](std::vector<std::string> topics) {
    return info_of_bag(
        [](BagBuilder& bag) {
          for (int i = 0; i < 3; ++i) bag.image("/range/image", at_ms(40 * i), "mono16");
        },
        std::move(topics));
  };
  EXPECT_TRUE(has_warning(with_range({}), "--topics depth=/range/image"));
  EXPECT_TRUE(with_range({"depth="}).warnings.empty());
  EXPECT_TRUE(has_note(with_range({"depth=/range/image"}), "depth /range/image"));
}

TEST(BagSequence, DepthIsThatOfTheCameraOfTheColorImage) {
  const auto topics_of_bag = [](std::vector<std::string> topics) {
    const auto add = [](BagBuilder& bag) {
      for (const char* const camera : {"/front", "/rear"}) {
        bag.image(std::string(camera) + "/color/image_raw", at_ms(0), "rgb8");
        bag.image(std::string(camera) + "/depth/image_raw", at_ms(0), "16UC1");
      }
    };
    return info_of_bag(add, std::move(topics)).notes.front();
  };
  EXPECT_EQ(topics_of_bag({"color=/rear/color/image_raw"}),
            "topics: color /rear/color/image_raw, depth /rear/depth/image_raw");
  EXPECT_EQ(topics_of_bag({}), "topics: color /front/color/image_raw, depth /front/depth/image_raw");
}

/// Focal length and center of the CameraInfo are those of the full image of 16x12 pixels.
TEST(BagSequence, RegionOfInterestAndBinningChangeTheCalibration) {
  const CameraInfoMessage full{.header = {},
                               .height = 12,
                               .width = 16,
                               .distortion_model = "plumb_bob",
                               .D = {},
                               .K = {20, 0, 8, 0, 24, 6, 0, 0, 1},
                               .P = {}};
  CameraInfoMessage binned = full;
  binned.binning_x = binned.binning_y = 2;
  const Camera half = camera_of(binned, "/image_raw", "bag");
  EXPECT_EQ(half.width, 8);
  EXPECT_EQ(half.fy, 12.0);
  EXPECT_EQ(half.cy, 3.0);
  CameraInfoMessage part = full;
  part.region = {.x = 6, .y = 2, .height = 6, .width = 8};
  const Camera cut = camera_of(part, "/image_raw", "bag");
  EXPECT_EQ(cut.height, 6);
  EXPECT_EQ(cut.fx, 20.0);
  EXPECT_EQ(cut.cx, 2.0);
  part.region.x = 9;  // not within the full image
  EXPECT_EQ(camera_of(part, "/image_raw", "bag").cx, 8.0);
}

TEST(BagSequence, OnlyWordsOfTheTopicTellThatImagesAreRectified) {
  const CameraInfoMessage info{.header = {},
                               .height = 6,
                               .width = 8,
                               .distortion_model = "plumb_bob",
                               .D = {0.1, 0, 0, 0, 0},
                               .K = {10, 0, 4, 0, 10, 3, 0, 0, 1},
                               .P = {9, 0, 4, 0, 0, 9, 3, 0, 0, 0, 1, 0}};
  EXPECT_EQ(camera_of(info, "/camera/image_rect_color", "bag").fx, 9.0);
  EXPECT_EQ(camera_of(info, "/direct/image_raw", "bag").fx, 10.0);
}

/// A bag whose depth has the frame and size of the color image, and a CameraInfo with another focal length.
TEST(BagSequence, DepthOfOtherIntrinsicsInTheSameFrameIsRegistered) {
  const auto with_focal_length = [](double fx) {
    return info_of_bag([fx](BagBuilder& bag) {
      bag.camera_info("/depth/camera_info", fx);
      for (int i = 0; i < 3; ++i) bag.image("/depth/image_raw", at_ms(40 * i), "16UC1");
    });
  };
  const SequenceInfo other = with_focal_length(12.5);
  ASSERT_TRUE(other.depth_camera.has_value());
  EXPECT_EQ(other.depth_camera->camera.fx, 12.5);
  EXPECT_TRUE(has_note(other, "is registered to the color camera"));
  EXPECT_FALSE(has_warning(other, "as if both were at the same place"));
  EXPECT_FALSE(with_focal_length(10.2).depth_camera.has_value());  // nominal values of registered depth
}

TEST(BagSequence, DepthInAnotherFrameWithoutCalibrationIsReported) {
  const auto in_frame = [](const std::string& frame) {
    return info_of_bag([&frame](BagBuilder& bag) {
      for (int i = 0; i < 3; ++i) bag.image("/depth/image_raw", at_ms(40 * i), "16UC1", frame);
    });
  };
  EXPECT_TRUE(has_warning(in_frame("tof"), "no CameraInfo for /depth/image_raw"));
  EXPECT_TRUE(in_frame("cam").warnings.empty());
}

TEST(BagSequence, InertialMessagesWithNanAreSkippedAndCounted) {
  const SequenceInfo info = info_of_bag([&](BagBuilder& bag) {
    for (int i = 0; i < 10; ++i)
      bag.imu("/imu", at_ms(10 * i), {i < 3 ? NAN : 0.0, 0, 0}, {0, i == 7 ? INFINITY : -9.8, 0});
  });
  EXPECT_EQ(info.imu.size(), 6U);
  EXPECT_TRUE(has_warning(info, "/imu: 4 messages with NaN or infinite values skipped"));
}

TEST(BagSequence, TopicsMayLackTheirSlash) {
  EXPECT_TRUE(has_note(info_of_bag([](BagBuilder&) {}, {"color=rgb/image_raw"}), "color /rgb/image_raw"));
}

TEST(BagSequence, TwoInertialTopicsAreMerged) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/d400/color/camera_info", 10.0);
  bag.transform("imu", "cam", Pose{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}});
  for (int i = 0; i < 3; ++i) {
    bag.image("/d400/color/image_raw", at_ms(40 * i), "rgb8");
    bag.image("/t265/fisheye1/image_raw", at_ms(40 * i), "mono8");
    bag.image("/d400/aligned_depth_to_color/image_raw", at_ms(40 * i + 3), "16UC1");
    bag.image("/d400/depth/image_raw", at_ms(40 * i + 3), "16UC1");
  }
  for (int i = 0; i < 10; ++i) bag.imu("/d400/gyro/sample", at_ms(10 * i + 5), {0.0, 0.0, 1.0}, {0, 0, 0});
  for (int i = 0; i < 6; ++i)
    bag.imu("/d400/accel/sample", at_ms(20 * i), {0, 0, 0}, {0.0, static_cast<double>(i), 9.8});
  for (int i = 0; i < 10; ++i) bag.imu("/base/imu", at_ms(10 * i), {0, 0, 0}, {0, 0, 0});
  bag.finish();
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path() / "a.bag");
  const SequenceInfo& info = stream->info();
  EXPECT_TRUE(has_note(info,
                       "topics: color /d400/color/image_raw, depth /d400/aligned_depth_to_color/image_raw, "
                       "gyro /d400/gyro/sample, accel /d400/accel/sample"));
  EXPECT_EQ(info.frame_times.size(), 3U);
  ASSERT_EQ(info.imu.size(), 10U);
  EXPECT_NEAR(info.imu[0].accel_b.y(), 0.25, 1e-12);  // at 5 ms, between 0 at 0 ms and 1 at 20 ms
  EXPECT_EQ(info.imu[0].gyro_b.z(), 1.0);
  EXPECT_EQ(info.rig.T_b_c.p.x(), 0.1);
  EXPECT_EQ(info.rig.camera.fx, 10.0);
}

/// Of `camera_x`, the position of the camera in the frame of the IMU on /tf.
std::optional<double> x_of_camera(std::initializer_list<double> camera_x) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/camera_info", 10.0);
  for (int i = 0; i < 10; ++i) {
    if (i < 3) bag.image("/image_raw", at_ms(40 * i), "mono8");
    bag.imu("/imu", at_ms(10 * i), {0, 0, 0}, {0, -9.8, 0});
  }
  for (int i = 0; const double x : camera_x) {
    const Timestamp t = at_ms(10 * i++);
    bag.transform("/tf", t,
                  {.header = {.stamp = t, .frame = "imu"},
                   .child = "cam",
                   .pose = Pose{Eigen::Quaterniond::Identity(), {x, 0, 0}}});
  }
  bag.finish();
  try {
    return open_sequence(folder.path() / "a.bag")->info().rig.T_b_c.p.x();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

TEST(BagSequence, TransformsOfTfThatNeverChangeAreFixed) {
  EXPECT_EQ(x_of_camera({0.1, 0.1, 0.1}), 0.1);
  EXPECT_FALSE(x_of_camera({0.1, 0.1, 0.2}).has_value());
}

/// Recorded by librealsense: streams below /device_0, extrinsics to stream 0, no frames in the headers, depth
/// of its own camera.
TEST(BagSequence, RecordingsOfLibrealsenseAreRead) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  const std::string depth = "/device_0/sensor_0/Depth_0";
  const std::string color = "/device_0/sensor_1/Color_0";
  bag.camera_info(depth + "/info/camera_info", 8.0);
  bag.camera_info(color + "/info/camera_info", 10.0);
  bag.stream_transform(depth + "/tf/0", Pose{});
  bag.stream_transform(color + "/tf/0", Pose{Eigen::Quaterniond::Identity(), {0.015, 0.0, 0.0}});
  bag.stream_transform("/device_0/sensor_2/Gyro_0/tf/0",
                       Pose{Eigen::Quaterniond::Identity(), {0.005, 0.0, 0.0}});
  bag.value("/device_0/sensor_0/option/Depth_Units/value", 0.0001F);
  for (int i = 0; i < 3; ++i) {
    bag.image(color + "/image/data", at_ms(40 * i), "rgb8", "0");
    bag.image(depth + "/image/data", at_ms(40 * i + 1), "mono16", "0");
  }
  for (int i = 0; i < 10; ++i) {
    bag.imu("/device_0/sensor_2/Gyro_0/imu/data", at_ms(10 * i), {0, 0, 0.1}, {0, 0, 0});
    bag.imu("/device_0/sensor_2/Accel_0/imu/data", at_ms(10 * i), {0, 0, 0}, {0, -9.8, 0});
  }
  bag.finish();
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path() / "a.bag");
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.rig.camera.fx, 10.0);
  EXPECT_NEAR(info.rig.T_b_c.p.x(), 0.01, 1e-12);  // color is 10 mm from the gyroscope
  EXPECT_NEAR(info.rig.depth_units_per_m, 10000.0, 1e-2);
  EXPECT_TRUE(has_note(info, "is registered to the color camera"));
  EXPECT_EQ(info.imu.size(), 10U);
  EXPECT_EQ(stream->load_frame(0).depth.cols, 8);
}

TEST(BagSequence, SelectedTopicsOverrideTheSearch) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/a/camera_info", 10.0);
  bag.camera_info("/b/camera_info", 20.0);
  for (int i = 0; i < 3; ++i) {
    bag.image("/a/image_raw", at_ms(40 * i), "rgb8");
    bag.image("/b/image_raw", at_ms(40 * i), "mono8");
    bag.image("/b/depth", at_ms(40 * i), "32FC1");
    bag.pose("/robot/pose", at_ms(40 * i), i);
  }
  bag.finish();
  EXPECT_EQ(open_sequence(folder.path() / "a.bag")->info().rig.camera.fx, 10.0);
  const std::unique_ptr<SensorStream> stream =
      open_sequence(folder.path() / "a.bag", {.topics = {"color=/b/image_raw", "truth=/robot/pose"}});
  EXPECT_EQ(stream->info().rig.camera.fx, 20.0);
  EXPECT_EQ(stream->info().ground_truth.trajectory.poses.size(), 3U);
  EXPECT_EQ(stream->load_frame(1).depth.at<std::uint16_t>(2, 2), 10000);  // 2 m of 5000 units
  EXPECT_EQ(stream->load_frame(1).depth_units_per_m, 5000.0);
  const auto open = [&](const std::string& request) {
    static_cast<void>(open_sequence(folder.path() / "a.bag", {.topics = {request}}));
  };
  expect_input_error([&] { open("color=/b/depth"); }, {"--topics", "/b/depth", "no topic for color",
                                                       "/a/image_raw (sensor_msgs/Image, rgb8)"});
  expect_input_error([&] { open("image=/b/image_raw"); }, {"--topics", "ROLE=TOPIC"});
}

TEST(BagSequence, DepthOfFloatsIsInTheUnitsThatARigFileStates) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/a/camera_info", 10.0);
  for (int i = 0; i < 3; ++i) {
    bag.image("/a/image_raw", at_ms(40 * i), "rgb8");
    bag.image("/a/depth", at_ms(40 * i), "32FC1");
  }
  bag.finish();
  folder.write("a.rig.toml", "depth = { scale = 1000 }\n");
  const Frame frame = open_sequence(folder.path() / "a.bag")->load_frame(1);
  EXPECT_EQ(frame.depth_units_per_m, 1000.0);
  EXPECT_EQ(frame.depth.at<std::uint16_t>(2, 2), 2000);  // 2 m
}

TEST(BagSequence, RepeatedAndUnorderedStampsAreRepairedWithAWarning) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.mcap");
  bag.camera_info("/camera_info", 10.0);
  for (const int ms : {0, 40, 40, 120, 80}) bag.image("/image_raw", at_ms(ms), "mono8");
  bag.finish();
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path() / "a.mcap");
  EXPECT_EQ(stream->info().frame_times, (std::vector<Timestamp>{at_ms(0), at_ms(40), at_ms(80), at_ms(120)}));
  ASSERT_EQ(stream->info().warnings.size(), 2U);
  EXPECT_NE(stream->info().warnings[0].find("1 messages with the time stamp of an earlier one"),
            std::string::npos);
}

TEST(BagSequence, MissingStampsAreReplacedByTheTimeOfRecording) {
  // The camera has a clock of its own that started 90 s ago, and its images arrive 5 ms after their exposure.
  const auto times = [](std::initializer_list<int> without_stamp) {
    const TemporaryFolder folder;
    BagBuilder bag(folder.path() / "a.bag");
    bag.camera_info("/camera_info", 10.0);
    for (int i = 0; i < 5; ++i) {
      const bool has_stamp = std::ranges::find(without_stamp, i) == without_stamp.end();
      const Timestamp stamp{has_stamp ? (10'000 + 40 * i) * std::int64_t{1'000'000} : 0};
      bag.delayed_image("/image_raw", stamp, at_ms(40 * i + 5));
    }
    bag.finish();
    return open_sequence(folder.path() / "a.bag")->info();
  };
  const SequenceInfo all = times({0, 1, 2, 3, 4});
  EXPECT_EQ(all.frame_times[1], at_ms(45));
  EXPECT_TRUE(has_warning(all, "/image_raw: 5 of 5 messages have the stamp 0; the time of their recording"));
  const SequenceInfo some = times({1, 3});
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(some.frame_times[static_cast<std::size_t>(i)].ns, (10'000 + 40 * i) * std::int64_t{1'000'000});
  EXPECT_TRUE(has_warning(some, "/image_raw: 2 of 5 messages have the stamp 0"));
  EXPECT_TRUE(times({}).warnings.empty());
}

/// VCU-RVI has accelerations in g whose sign is inverted.
TEST(BagSequence, AccelerationsInGAreConverted) {
  const auto accel_of = [](const Eigen::Vector3d& recorded) {
    const TemporaryFolder folder;
    BagBuilder bag(folder.path() / "a.bag");
    bag.camera_info("/camera/camera_info", 10.0);
    bag.transform("imu", "cam", Pose{});
    for (int i = 0; i < 3; ++i) bag.image("/camera/image_raw", at_ms(40 * i), "8UC3");
    for (int i = 0; i < 10; ++i) bag.imu("/camera/imu", at_ms(10 * i), {0, 0, 0}, recorded);
    bag.finish();
    const SequenceInfo info = open_sequence(folder.path() / "a.bag")->info();
    EXPECT_EQ(info.warnings.size(), 1U);
    return info.imu[3].accel_b;
  };
  EXPECT_EQ(accel_of({0.0, -1.0, 0.0}), Eigen::Vector3d(0.0, -9.80665, 0.0));
  EXPECT_EQ(accel_of({0.0, 1.0, 0.0}), Eigen::Vector3d(0.0, -9.80665, 0.0));
  EXPECT_EQ(accel_of({0.0, 0.0, 1.0}), Eigen::Vector3d(0.0, 0.0, 9.80665));
}

TEST(BagSequence, MissingCalibrationNamesTheFileToWrite) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.image("/image_raw", at_ms(0), "mono8");
  bag.finish();
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path() / "a.bag")); },
                     {"a.rig.toml", "no calibrated CameraInfo"});
  folder.write("a.rig.toml", "[camera]\nwidth = 8\nheight = 6\nfx = 5\nfy = 5\ncx = 4\ncy = 3\n");
  EXPECT_EQ(open_sequence(folder.path() / "a.bag")->info().rig.camera.fx, 5.0);
}

TEST(BagSequence, DistortionModelsThatAreNotSupportedAreRejected) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/camera_info", 10.0, "fov", {0.9});
  bag.image("/image_raw", at_ms(0), "mono8");
  bag.finish();
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path() / "a.bag")); },
                     {"CameraInfo of /image_raw", "\"fov\"", "rational_polynomial", "a.rig.toml"});
  folder.write("a.rig.toml", "[camera]\nwidth = 8\nheight = 6\nfx = 5\nfy = 5\ncx = 4\ncy = 3\n");
  EXPECT_EQ(open_sequence(folder.path() / "a.bag")->info().rig.camera.fx, 5.0);
}

TEST(BagSequence, TheLensOfAnAzureKinectIsRead) {
  const TemporaryFolder folder;
  const std::vector<double> D = {0.40386, -2.60288, 8.94e-4, -4.2e-5, 1.51188, 0.28428, -2.42072, 1.43544};
  BagBuilder bag(folder.path() / "a.bag");
  bag.camera_info("/camera_info", 10.0, "rational_polynomial", D);
  bag.image("/image_raw", at_ms(0), "mono8");
  bag.finish();
  const Camera camera = open_sequence(folder.path() / "a.bag")->info().rig.camera;
  EXPECT_EQ(camera.model, CameraModel::kRadialTangential);
  EXPECT_TRUE(std::ranges::equal(camera.distortion, D));
}

TEST(BagSequence, ABagWithoutImagesListsItsTopics) {
  const TemporaryFolder folder;
  BagBuilder bag(folder.path() / "a.bag");
  bag.pose("/gt", at_ms(0), 0.0);
  bag.finish();
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path() / "a.bag")); },
                     {"no color or gray images", "/gt (geometry_msgs/PoseStamped)"});
}

TEST(BagSequence, IsChecked) {
  const TemporaryFolder folder;
  SmallStream stream;
  for (ImuSample& sample : stream.info_.imu) sample.accel_b = {0.0, -9.81, 0.0};  // the camera is upright
  export_bag(stream, folder.path() / "a.bag", "bz2");
  const CheckReport report = check_sequence(folder.path() / "a.bag");
  EXPECT_EQ(report.exit_code(), 0) << report_text(report);
  EXPECT_EQ(report.format, "bag");
}

TEST(BagSequence, FramesAreCachedUntilTheBagChanges) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.bag";
  export_bag(SmallStream(), path, "lz4");
  const OpenOptions options{
      .frame_cache = FrameCacheOptions{.folder = folder.path() / "cache", .disk_reserve_bytes = 0}};
  const auto load_all = [&] {
    const std::unique_ptr<SensorStream> stream = open_sequence(path, options);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(stream->load_frame(i).gray.at<std::uint8_t>(0, 0), 10 * i);
  };
  load_all();
  EXPECT_TRUE(open_sequence(path, options)->frames_are_cached());
  load_all();
  std::filesystem::last_write_time(path,
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_FALSE(open_sequence(path, options)->frames_are_cached());
}

}  // namespace
}  // namespace stillpoint::datasets
