// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_topics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/io/byte_stream.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

/// Channels of an encoding: their number, and the positions of red, green and blue.
struct ColorLayout {
  std::string_view encoding;
  int channels = 1;
  std::array<int, 3> rgb{};
};

/// 8UC3 does not define its order; camera nodes write it from OpenCV, that is, B G R.
constexpr std::array<ColorLayout, 8> kColorLayouts{{{"mono8", 1, {0, 0, 0}},
                                                    {"8UC1", 1, {0, 0, 0}},
                                                    {"rgb8", 3, {0, 1, 2}},
                                                    {"bgr8", 3, {2, 1, 0}},
                                                    {"8UC3", 3, {2, 1, 0}},
                                                    {"rgba8", 4, {0, 1, 2}},
                                                    {"bgra8", 4, {2, 1, 0}},
                                                    {"8UC4", 4, {2, 1, 0}}}};
constexpr std::size_t kCompressedDepthHeader = 12;
constexpr std::uint32_t kMaxImageSize = 65535;  ///< [px] of a side

const ColorLayout* find_layout(std::string_view encoding) {
  const auto found = std::ranges::find(kColorLayouts, encoding, &ColorLayout::encoding);
  return found == kColorLayouts.end() ? nullptr : &*found;
}

/// Whether the pixels are Y and alternating U and V, in this order. The names of ROS 1, and of ROS 2 since
/// Humble.
bool has_luma_first(std::string_view encoding) { return encoding == "yuv422_yuy2" || encoding == "yuyv"; }

/// Whether the pixels are Y and alternating U and V. ROS names the order U Y V Y "yuv422".
bool is_yuv(std::string_view encoding) {
  return encoding.starts_with("yuv422") || encoding == "uyvy" || has_luma_first(encoding);
}

/// @throws InputError unless the rows of `bytes_per_pixel` fit in the data
void require_pixels(const ImageMessage& image, std::uint64_t bytes_per_pixel, std::string_view place) {
  const bool valid = image.width > 0 && image.height > 0 && image.width <= kMaxImageSize &&
                     image.height <= kMaxImageSize && image.step >= image.width * bytes_per_pixel &&
                     image.data.size() >= std::uint64_t{image.step} * image.height;
  if (!valid)
    throw InputError(std::string(place), "its size " + std::to_string(image.width) + "x" +
                                             std::to_string(image.height) +
                                             " does not fit its data; it is damaged, record it again");
}

std::uint8_t clamp_to_byte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

/// ITU-R BT.601 with full range, as OpenCV converts it:
///   R = Y + 1.402 (V - 128),  G = Y - 0.344 (U - 128) - 0.714 (V - 128),  B = Y + 1.772 (U - 128)
cv::Vec3b rgb_of(int y, int u, int v) {
  return {clamp_to_byte(y + 1.402 * (v - 128)),
          clamp_to_byte(y - 0.344136 * (u - 128) - 0.714136 * (v - 128)),
          clamp_to_byte(y + 1.772 * (u - 128))};
}

cv::Mat decode_yuv(const ImageMessage& image, std::string_view place) {
  require_pixels(image, 2, place);
  const std::size_t luma_first = has_luma_first(image.encoding) ? 0 : 1;
  const std::size_t chroma_first = 1 - luma_first;
  cv::Mat rgb(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3);
  for (int row = 0; row < rgb.rows; ++row) {
    const auto* const in =
        reinterpret_cast<const std::uint8_t*>(image.data.data()) + static_cast<std::size_t>(row) * image.step;
    for (int column = 0; column < rgb.cols; ++column) {
      const std::size_t pair = static_cast<std::size_t>(column / 2) * 4;
      // A row of odd width ends without the V of its last pair.
      const std::size_t v_at =
          pair + 2 + chroma_first < image.step ? pair + 2 + chroma_first : pair + chroma_first;
      rgb.at<cv::Vec3b>(row, column) =
          rgb_of(in[static_cast<std::size_t>(column) * 2 + luma_first], in[pair + chroma_first], in[v_at]);
    }
  }
  return rgb;
}

cv::Mat decode_inverse_depth(const cv::Mat& quantized, float a, float b) {
  cv::Mat meters(quantized.size(), CV_32FC1);
  std::transform(quantized.begin<std::uint16_t>(), quantized.end<std::uint16_t>(), meters.begin<float>(),
                 [a, b](std::uint16_t raw) { return raw == 0 ? 0.0F : a / (static_cast<float>(raw) - b); });
  return meters;
}

template <class Number>
cv::Mat depth_values(const ImageMessage& image, int type, std::string_view place) {
  cv::Mat depth(static_cast<int>(image.height), static_cast<int>(image.width), type);
  for (int row = 0; row < depth.rows; ++row) {
    ByteReader reader(image.data.substr(static_cast<std::size_t>(row) * image.step, image.step), place,
                      {.big_endian = image.big_endian});
    for (int column = 0; column < depth.cols; ++column)
      depth.at<Number>(row, column) = reader.number<Number>();
  }
  return depth;
}

/// @param beginning of a message with an image: its PNG may begin anywhere in it
bool is_gray_png_of_16_bits(std::string_view beginning) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::string_view kGrayOf16Bits("\x10\0", 2);  // bit depth and color type
  constexpr std::size_t kBitDepthOffset = 24;
  const std::size_t png = beginning.find(kSignature);
  return png != std::string_view::npos && beginning.substr(png).size() >= kBitDepthOffset + 2 &&
         beginning.substr(png + kBitDepthOffset, 2) == kGrayOf16Bits;
}

}  // namespace

ImageContent content_of_encoding(std::string_view encoding) {
  if (find_layout(encoding) != nullptr || is_yuv(encoding)) return ImageContent::kColor;
  if (encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1") return ImageContent::kDepth;
  return ImageContent::kOther;
}

ImageContent content_of_compressed(std::string_view format, std::string_view beginning) {
  const bool is_depth = format.find("compressedDepth") != std::string_view::npos ||
                        format.starts_with("16UC1") || is_gray_png_of_16_bits(beginning);
  return is_depth ? ImageContent::kDepth : ImageContent::kColor;
}

bool has_float_depth(std::string_view encoding_or_format) { return encoding_or_format.starts_with("32FC1"); }

cv::Mat decode_color_message(const ImageMessage& image, std::string_view place) {
  if (is_yuv(image.encoding)) return decode_yuv(image, place);
  const ColorLayout* const layout = find_layout(image.encoding);
  if (layout == nullptr)
    throw InputError(std::string(place),
                     "the encoding \"" + image.encoding +
                         "\" is not one of a color or gray image; select another topic with --topics");
  require_pixels(image, static_cast<std::uint64_t>(layout->channels), place);
  cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width),
                 layout->channels == 1 ? CV_8UC1 : CV_8UC3);
  for (int row = 0; row < pixels.rows; ++row) {
    const auto* in =
        reinterpret_cast<const std::uint8_t*>(image.data.data()) + static_cast<std::size_t>(row) * image.step;
    std::uint8_t* out = pixels.ptr<std::uint8_t>(row);
    if (layout->channels == 1) {
      std::copy_n(in, image.width, out);
      continue;
    }
    for (int column = 0; column < pixels.cols; ++column, in += layout->channels, out += 3) {
      for (std::size_t i = 0; i < 3; ++i) out[i] = in[layout->rgb[i]];
    }
  }
  return pixels;
}

cv::Mat decode_color_message(const CompressedImageMessage& image, std::string_view place) {
  return decode_image(image.data, std::string(place));
}

cv::Mat decode_depth_message(const ImageMessage& image, std::string_view place) {
  const bool is_float = has_float_depth(image.encoding);
  if (content_of_encoding(image.encoding) != ImageContent::kDepth)
    throw InputError(std::string(place),
                     "the encoding \"" + image.encoding +
                         "\" is not one of a depth image; select another topic with --topics");
  require_pixels(image, is_float ? 4 : 2, place);
  return is_float ? depth_values<float>(image, CV_32FC1, place)
                  : depth_values<std::uint16_t>(image, CV_16UC1, place);
}

cv::Mat decode_depth_message(const CompressedImageMessage& image, std::string_view place) {
  const bool has_header = image.format.find("compressedDepth") != std::string::npos;
  if (image.format.find("rvl") != std::string::npos)
    throw InputError(std::string(place), "depth compressed by RVL is not read; record it as PNG");
  ByteReader reader(image.data, place);
  constexpr std::string_view kPngSignature = "\x89PNG";  // some publishers write no header in front of it
  if (!has_header || image.data.starts_with(kPngSignature)) {
    if (has_float_depth(image.format))
      throw InputError(std::string(place),
                       "has no header in front of the PNG, which tells the scale of its floats");
    return decode_depth(image.data, std::string(place));
  }
  reader.skip(4);
  const float a = reader.number<float>();
  const float b = reader.number<float>();
  const cv::Mat raw = decode_depth(image.data.substr(kCompressedDepthHeader), std::string(place));
  return has_float_depth(image.format) ? decode_inverse_depth(raw, a, b) : raw;
}

namespace {

constexpr std::string_view kImage = "sensor_msgs/Image";
constexpr std::string_view kCompressedImage = "sensor_msgs/CompressedImage";
constexpr std::string_view kImu = "sensor_msgs/Imu";
constexpr std::uint64_t kImageHeadBytes = 1024;  ///< contains header and encoding

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool contains_any(const std::string& topic, std::initializer_list<std::string_view> words) {
  const std::string name = lower_case(topic);
  return std::ranges::any_of(words,
                             [&name](std::string_view word) { return name.find(word) != std::string::npos; });
}

/// "/camera" of "/camera/color/image_raw".
std::string_view first_name(std::string_view topic) { return topic.substr(0, topic.find('/', 1)); }

/// Of the names of two topics from their beginning: 2 of "/robot/front/color/image" and
/// "/robot/front/depth/image".
int common_names(std::string_view a, std::string_view b) {
  int names = 0;
  for (std::size_t i = 1; i < std::min(a.size(), b.size()) && a[i] == b[i]; ++i) names += a[i] == '/' ? 1 : 0;
  return names;
}

/// All connections of one topic.
struct TopicSummary {
  std::string topic;
  std::string type;
  std::size_t messages = 0;
  ImageContent image = ImageContent::kOther;  ///< of its first message
  std::string encoding;                       ///< encoding or format of its first image
};

/// Sets content and encoding from the first message; a message that cannot be parsed is of no use.
TopicSummary with_encoding(TopicSummary summary, const BagFile& bag, const MessageReference& first) {
  const std::string place = bag.place(first);
  const std::string bytes = bag.payload(first, kImageHeadBytes);
  const SerializedMessage message{.bytes = bytes, .format = bag.connection(first).format, .place = place};
  try {
    if (summary.type == kImage) {
      summary.encoding = parse_image_head(message).encoding;
      summary.image = content_of_encoding(summary.encoding);
    } else if (summary.type == kCompressedImage) {
      summary.encoding = parse_compressed_image_head(message).format;
      summary.image = content_of_compressed(summary.encoding, bytes);
    }
  } catch (const InputError&) {  // kOther
  }
  return summary;
}

/// The topics with at least one message, in alphabetical order. Reads the first message of image topics.
std::vector<TopicSummary> summarize_topics(const BagFile& bag) {
  std::map<std::string, std::pair<TopicSummary, const MessageReference*>> topics;
  for (const MessageReference& reference : bag.messages()) {
    const BagConnection& connection = bag.connection(reference);
    const auto [entry, is_new] = topics.try_emplace(
        connection.topic, TopicSummary{.topic = connection.topic, .type = connection.type, .encoding = {}},
        &reference);
    ++entry->second.first.messages;
  }
  std::vector<TopicSummary> summaries;
  summaries.reserve(topics.size());
  for (const auto& [name, topic] : topics)
    summaries.push_back(with_encoding(topic.first, bag, *topic.second));
  return summaries;
}

int color_rank(const TopicSummary& topic) {
  int rank = topic.type == kImage ? 1 : 0;
  if (contains_any(topic.topic, {"color", "rgb"})) rank += 4;
  if (contains_any(topic.topic, {"infra", "fisheye", "right", "mask", "theora"})) rank -= 8;
  if (contains_any(topic.topic, {"depth", "confidence"})) rank -= 4;
  return rank;
}

/// Depth of the camera of the color image comes first.
int depth_rank(const TopicSummary& topic, const std::string& color) {
  int rank = 16 * common_names(topic.topic, color) + (topic.type == kImage ? 1 : 0);
  if (contains_any(topic.topic, {"aligned", "registered"})) rank += 4;
  if (contains_any(topic.topic, {"depth"})) rank += 2;
  return rank;
}

bool is_infrared(const TopicSummary& topic) {
  return contains_any(topic.topic, {"infra", "/ir/", "/ir_", "_ir/", "brightness", "amplitude"}) ||
         lower_case(topic.topic).ends_with("/ir");
}

/// Whether a topic has depth by its encoding and name: infrared brightness has 16 bits, too (mono16, PNG, and
/// 16UC1 by some cameras).
bool measures_depth(const TopicSummary& topic) {
  if (topic.image != ImageContent::kDepth) return false;
  const bool states_depth = topic.encoding.starts_with("16UC1") || topic.encoding.starts_with("32FC1") ||
                            topic.encoding.find("compressedDepth") != std::string::npos;
  return contains_any(topic.topic, {"depth"}) || (states_depth && !is_infrared(topic));
}

/// The first of the best topics for which `is_candidate` is true; empty without one.
template <class Candidate, class Rank>
std::string best_topic(const std::vector<TopicSummary>& topics, const Candidate& is_candidate,
                       const Rank& rank) {
  const TopicSummary* best = nullptr;
  for (const TopicSummary& topic : topics) {
    if (is_candidate(topic) && (best == nullptr || rank(topic) > rank(*best))) best = &topic;
  }
  return best == nullptr ? std::string() : best->topic;
}

BagTopics with_imu(BagTopics selected, const std::vector<TopicSummary>& topics) {
  const auto near_camera = [&](const TopicSummary& topic) {
    return first_name(topic.topic) == first_name(selected.color) ? 1 : 0;
  };
  const auto find = [&](auto accept) {
    return best_topic(
        topics, [&](const TopicSummary& topic) { return topic.type == kImu && accept(topic.topic); },
        near_camera);
  };
  const std::string imu = find([](const std::string& name) {
    return !contains_any(name, {"gyro", "accel"});
  });
  const std::string gyro = find([](const std::string& name) { return contains_any(name, {"gyro"}); });
  const std::string accel = find([](const std::string& name) { return contains_any(name, {"accel"}); });
  const bool pair = !gyro.empty() && !accel.empty();
  const bool pair_is_nearer =
      first_name(gyro) == first_name(selected.color) && first_name(imu) != first_name(selected.color);
  if (pair && (imu.empty() || pair_is_nearer)) {
    selected.gyro = gyro;
    selected.accel = accel;
  } else {
    selected.imu = imu;
  }
  return selected;
}

bool names_reference(const TopicSummary& topic) {
  return is_pose_type(topic.type) &&
         (contains_any(topic.topic, {"ground", "truth", "vicon", "vrpn", "mocap", "optitrack", "qualisys"}) ||
          topic.topic == "/gt" || topic.topic.ends_with("/gt") || topic.topic.starts_with("/gt/"));
}

std::string list_of(const std::vector<TopicSummary>& topics) {
  std::string text;
  for (const TopicSummary& topic : topics) {
    text += (text.empty() ? "" : ", ") + topic.topic + " (" + topic.type +
            (topic.encoding.empty() ? "" : ", " + topic.encoding) + ")";
  }
  return text;
}

std::string* role_of(BagTopics& topics, std::string_view role) {
  if (role == "color") return &topics.color;
  if (role == "depth") return &topics.depth;
  if (role == "imu") return &topics.imu;
  if (role == "gyro") return &topics.gyro;
  if (role == "accel") return &topics.accel;
  return role == "truth" ? &topics.truth : nullptr;
}

bool fits_role(const TopicSummary& topic, std::string_view role) {
  if (role == "color") return topic.image == ImageContent::kColor;
  if (role == "depth") return topic.image == ImageContent::kDepth;
  return role == "truth" ? is_trajectory_type(topic.type) : topic.type == kImu;
}

/// `selected` with one request applied.
BagTopics with_request(BagTopics selected, const std::string& request,
                       const std::vector<TopicSummary>& topics) {
  const std::size_t separator = request.find('=');
  const std::string role = request.substr(0, separator);
  std::string* const target = role_of(selected, role);
  if (separator == std::string::npos || target == nullptr)
    throw InputError(
        "--topics",
        "\"" + request + "\" is not ROLE=TOPIC; the roles are color, depth, imu, gyro, accel and truth");
  const std::string name = request.substr(separator + 1);
  const bool frames_of_tf = role == "truth" && name.starts_with("/tf:");
  const auto found = std::ranges::find_if(topics, [&name](const TopicSummary& topic) {
    return topic.topic == name || topic.topic == "/" + name || "/" + topic.topic == name;
  });
  if (!name.empty() && !frames_of_tf && (found == topics.end() || !fits_role(*found, role)))
    throw InputError("--topics",
                     "\"" + name + "\" is no topic for " + role + "; the bag contains " + list_of(topics));
  if (role == "imu") selected.gyro = selected.accel = "";
  if (role == "gyro" || role == "accel") selected.imu = "";
  *role_of(selected, role) = name.empty() || frames_of_tf ? name : found->topic;
  return selected;
}

}  // namespace

BagTopics select_topics(const BagFile& bag, std::span<const std::string> requested) {
  const std::vector<TopicSummary> topics = summarize_topics(bag);
  BagTopics selected;
  selected.color = best_topic(
      topics, [](const TopicSummary& topic) { return topic.image == ImageContent::kColor; }, color_rank);
  for (const std::string& request : requested) {
    if (request.starts_with("color=")) selected = with_request(selected, request, topics);
  }
  const auto rank_of_depth = [&selected](const TopicSummary& topic) {
    return depth_rank(topic, selected.color);
  };
  selected.depth = best_topic(topics, measures_depth, rank_of_depth);
  selected.truth = best_topic(topics, names_reference, [](const TopicSummary&) { return 0; });
  selected = with_imu(selected, topics);
  for (const std::string& request : requested) selected = with_request(selected, request, topics);
  const bool states_none = std::ranges::find(requested, "depth=") != requested.end();
  if (selected.depth.empty() && !states_none) {
    selected.unclear_depth = best_topic(
        topics,
        [](const TopicSummary& topic) { return topic.image == ImageContent::kDepth && !is_infrared(topic); },
        rank_of_depth);
  }
  if (selected.color.empty())
    throw InputError(bag.path().string(),
                     "contains no color or gray images; its topics are " + list_of(topics));
  return selected;
}

std::string topics_text(const BagTopics& topics) {
  const std::array<std::pair<std::string_view, const std::string*>, 6> roles{{{"color", &topics.color},
                                                                              {"depth", &topics.depth},
                                                                              {"imu", &topics.imu},
                                                                              {"gyro", &topics.gyro},
                                                                              {"accel", &topics.accel},
                                                                              {"truth", &topics.truth}}};
  std::string text;
  for (const auto& [role, topic] : roles) {
    if (!topic->empty()) text += (text.empty() ? "" : ", ") + std::string(role) + " " + *topic;
  }
  return text;
}

}  // namespace stillpoint::datasets
