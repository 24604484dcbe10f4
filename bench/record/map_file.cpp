// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/map_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>

#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderSize = 16;
constexpr std::size_t kChecksumSize = sizeof(std::uint64_t);

class MapWriter {
 public:
  template <class Number>
  void add_number(Number value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    bytes_.append(raw.data(), raw.size());
  }
  void add_vector(const Eigen::Vector3d& vector) {
    for (const double value : vector) add_number(value);
  }
  void add_pose(const Pose& pose) {
    add_vector(pose.p);
    for (const double value : pose.q.coeffs()) add_number(value);
  }
  void add_keyframe(const Keyframe& keyframe) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    add_number(keyframe.frame);
    add_number(keyframe.t.ns);
    add_pose(keyframe.T_w_b);
    add_pose(keyframe.T_b_c);
    add_vector(keyframe.gravity_b.value_or(Eigen::Vector3d::Constant(kNone)));
    add_number(static_cast<std::uint32_t>(keyframe.features.size()));
    for (const KeyframeFeature& feature : keyframe.features) {
      for (const std::uint64_t word : feature.descriptor) add_number(word);
      for (const float value : feature.p_c) add_number(value);
    }
  }
  [[nodiscard]] std::string take() {
    add_number(content_hash(bytes_));
    return std::move(bytes_);
  }

 private:
  std::string bytes_ = kMapMagic;
};

/// Reads the values behind the header.
class MapReader {
 public:
  MapReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <class Number>
  [[nodiscard]] Number take_number() {
    if (bytes_.size() < sizeof(Number)) throw_damaged();
    Number value;
    std::memcpy(&value, bytes_.data(), sizeof(Number));
    bytes_.remove_prefix(sizeof(Number));
    return value;
  }
  [[nodiscard]] Eigen::Vector3d take_vector() {
    Eigen::Vector3d vector;
    for (double& value : vector) value = take_number<double>();
    return vector;
  }
  [[nodiscard]] Pose take_pose() {
    Pose pose;
    pose.p = take_vector();
    for (double& value : pose.q.coeffs()) value = take_number<double>();
    if (!pose.p.allFinite() || !(std::abs(pose.q.norm() - 1.0) < 1e-6)) throw_damaged();
    return pose;
  }
  [[nodiscard]] Keyframe take_keyframe() {
    Keyframe keyframe;
    keyframe.frame = take_number<std::int64_t>();
    keyframe.t.ns = take_number<std::int64_t>();
    keyframe.T_w_b = take_pose();
    keyframe.T_b_c = take_pose();
    const Eigen::Vector3d gravity = take_vector();
    if (gravity.allFinite()) keyframe.gravity_b = gravity;
    const auto count = take_number<std::uint32_t>();
    if (count > bytes_.size() / sizeof(Descriptor)) throw_damaged();
    keyframe.features.resize(count);
    for (KeyframeFeature& feature : keyframe.features) {
      for (std::uint64_t& word : feature.descriptor) word = take_number<std::uint64_t>();
      for (float& value : feature.p_c) value = take_number<float>();
    }
    return keyframe;
  }
  [[nodiscard]] bool is_empty() const { return bytes_.empty(); }
  [[noreturn]] void throw_damaged() const {
    throw InputError(name_, "is damaged; write it again with `stillpoint run --save-map`");
  }

 private:
  std::string_view bytes_;
  std::string name_;
};

}  // namespace

std::string map_bytes(const KeyframeMap& map) {
  MapWriter writer;
  writer.add_number(kVersion);
  writer.add_number(static_cast<std::uint32_t>(map.keyframes.size()));
  for (const Keyframe& keyframe : map.keyframes) writer.add_keyframe(keyframe);
  return writer.take();
}

std::string map_checksum(const KeyframeMap& map) { return hash_text(content_hash(map_bytes(map))); }

KeyframeMap parse_map(const std::string& bytes, const std::string& name) {
  if (!bytes.starts_with(kMapMagic)) {
    throw InputError(name, "is not a map; specify a file of `stillpoint run --save-map`");
  }
  const std::size_t end = bytes.size() - std::min(bytes.size(), kChecksumSize);
  const std::string_view content = std::string_view(bytes).substr(0, end);
  MapReader reader(content.substr(std::min(end, std::strlen(kMapMagic))), name);
  const auto version = reader.take_number<std::uint32_t>();
  if (version != kVersion) {
    throw InputError(name, "is a map of version " + std::to_string(version) + ", expected " +
                               std::to_string(kVersion) +
                               "; write it again with `stillpoint run --save-map`");
  }
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + end, kChecksumSize);
  if (end < kHeaderSize || checksum != content_hash(content)) reader.throw_damaged();
  KeyframeMap map;
  for (auto left = reader.take_number<std::uint32_t>(); left > 0; --left) {
    map.keyframes.push_back(reader.take_keyframe());
  }
  if (map.keyframes.empty() || !reader.is_empty()) reader.throw_damaged();
  return map;
}

KeyframeMap read_map(const std::filesystem::path& file) {
  require_regular_file(file);
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be read; correct the path");
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return parse_map(bytes, file.string());
}

}  // namespace stillpoint::bench
