// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_topics.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::datasets {
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
      summary.image = content_of_format(summary.encoding);
    }
  } catch (const InputError&) {  // kOther
  }
  return summary;
}

int color_rank(const TopicSummary& topic) {
  int rank = topic.type == kImage ? 1 : 0;
  if (contains_any(topic.topic, {"color", "rgb"})) rank += 4;
  if (contains_any(topic.topic, {"infra", "fisheye", "right", "mask", "theora"})) rank -= 8;
  if (contains_any(topic.topic, {"depth", "confidence"})) rank -= 4;
  return rank;
}

int depth_rank(const TopicSummary& topic) {
  int rank = topic.type == kImage ? 1 : 0;
  if (contains_any(topic.topic, {"aligned", "registered"})) rank += 4;
  if (contains_any(topic.topic, {"depth"})) rank += 2;
  return rank;
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
  return role == "truth" ? is_pose_type(topic.type) : topic.type == kImu;
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
  const auto found = std::ranges::find(topics, name, &TopicSummary::topic);
  if (!name.empty() && !frames_of_tf && (found == topics.end() || !fits_role(*found, role)))
    throw InputError("--topics",
                     "\"" + name + "\" is no topic for " + role + "; the bag contains " + list_of(topics));
  if (role == "imu") selected.gyro = selected.accel = "";
  if (role == "gyro" || role == "accel") selected.imu = "";
  *role_of(selected, role) = name;
  return selected;
}

}  // namespace

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
  for (const auto& [name, topic] : topics)
    summaries.push_back(with_encoding(topic.first, bag, *topic.second));
  return summaries;
}

BagTopics select_topics(const BagFile& bag, std::span<const std::string> requested) {
  const std::vector<TopicSummary> topics = summarize_topics(bag);
  BagTopics selected;
  selected.color = best_topic(
      topics, [](const TopicSummary& topic) { return topic.image == ImageContent::kColor; }, color_rank);
  for (const std::string& request : requested) {
    if (request.starts_with("color=")) selected = with_request(selected, request, topics);
  }
  selected.depth = best_topic(
      topics, [](const TopicSummary& topic) { return topic.image == ImageContent::kDepth; }, depth_rank);
  selected.truth = best_topic(topics, names_reference, [](const TopicSummary&) { return 0; });
  selected = with_imu(selected, topics);
  for (const std::string& request : requested) selected = with_request(selected, request, topics);
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
