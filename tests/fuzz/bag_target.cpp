// SPDX-License-Identifier: BSD-3-Clause
/// Fuzz target that reads arbitrary bytes as a ROS 1 bag, as an MCAP file, and as every message. A reader may
/// throw InputError only.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/bags/bag_topics.h"
#include "datasets/bags/messages.h"
#include "datasets/formats/bag_format.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

template <class Parse>
void ignore_input_error(const Parse& parse) {
  try {
    parse();
  } catch (const InputError&) {  // rejected
  }
}

void read_messages(const BagFile& bag) {
  for (const MessageReference& reference : bag.messages()) {
    ignore_input_error([&] { static_cast<void>(bag.payload(reference, 64)); });
  }
}

/// Reads the file as all commands do.
void read_as_bag(const std::filesystem::path& path) {
  const BagFile bag(path);
  read_messages(bag);
  for (const BagConnection& connection : bag.connections())
    ignore_input_error([&] { static_cast<void>(read_bag_trajectory(bag, connection.topic)); });
  ignore_input_error([&] { static_cast<void>(read_bag_trajectory(bag, "/tf:a.b")); });
  const BagTopics topics = select_topics(bag, {});
  FaultLog faults(FaultLog::Mode::kCollect);
  static_cast<void>(read_bag_streams(bag, topics, faults));
}

void parse_as_every_message(std::string_view bytes, WireFormat format) {
  const SerializedMessage message{.bytes = bytes, .format = format, .place = "fuzz"};
  ignore_input_error([&] { static_cast<void>(parse_image(message)); });
  ignore_input_error([&] { static_cast<void>(parse_compressed_image(message)); });
  ignore_input_error([&] { static_cast<void>(parse_camera_info(message)); });
  ignore_input_error([&] { static_cast<void>(parse_imu(message)); });
  ignore_input_error([&] { static_cast<void>(parse_nav_sat_fix(message)); });
  ignore_input_error([&] { static_cast<void>(parse_transforms(message)); });
  ignore_input_error([&] { static_cast<void>(parse_transform(message)); });
  for (const char* type : {"geometry_msgs/PoseStamped", "nav_msgs/Odometry"})
    ignore_input_error([&] { static_cast<void>(parse_pose(message, type)); });
  ignore_input_error([&] {
    const ImageMessage image = parse_image(message);
    ignore_input_error([&] { static_cast<void>(decode_color_message(image, "fuzz")); });
    static_cast<void>(decode_depth_message(image, "fuzz"));
  });
}

}  // namespace
}  // namespace stillpoint::datasets

/// The first byte selects the reader.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stillpoint;
  static const TemporaryFolder folder;
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      datasets::ignore_input_error([&] { datasets::read_as_bag(folder.write("a.bag", bytes)); });
      break;
    case 1:
      datasets::ignore_input_error([&] { datasets::read_as_bag(folder.write("a.mcap", bytes)); });
      break;
    case 2:
      datasets::parse_as_every_message(bytes, datasets::WireFormat::kRos1);
      break;
    default:
      datasets::parse_as_every_message(bytes, datasets::WireFormat::kCdr);
      break;
  }
  return 0;
}
