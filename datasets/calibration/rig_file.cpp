// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/rig_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "datasets/calibration/rig_yaml.h"
#include "datasets/io/lens_model.h"
#include "eval/io/matrix_files.h"
#include "eval/io/text_reader.h"

namespace stillpoint::datasets {

bool are_plausible_axes(const Eigen::Matrix3d& axes) {
  constexpr double kMostDifference = 0.2;
  return (axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kMostDifference;
}

namespace {

/// One table of the file; every access checks type and range.
class Section {
 public:
  Section(std::string file, const toml::table* table) : file_(std::move(file)), table_(table) {}

  void allow_only(std::initializer_list<std::string_view> keys) const {
    if (table_ == nullptr) return;
    for (const auto& [key, node] : *table_) {
      if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
      std::string expected;
      for (const std::string_view name : keys) expected += (expected.empty() ? "" : ", ") + std::string(name);
      throw InputError(file_, key.source().begin.line,
                       "unknown key \"" + std::string(key.str()) + "\"; expected one of: " + expected);
    }
  }

  [[nodiscard]] const toml::node* find(std::string_view key) const {
    return table_ == nullptr ? nullptr : table_->get(key);
  }

  [[nodiscard]] double number(std::string_view key, double fallback) const {
    const toml::node* const node = find(key);
    return node == nullptr ? fallback : number_of(*node, key);
  }

  [[nodiscard]] double positive(std::string_view key, double fallback) const {
    const toml::node* const node = find(key);
    if (node == nullptr) return fallback;
    const double value = number_of(*node, key);
    if (!(value > 0.0)) fail(*node, key, "must be greater than 0");
    return value;
  }

  [[nodiscard]] int image_size(std::string_view key, int fallback) const {
    const toml::node* const node = find(key);
    if (node == nullptr) return fallback;
    const std::optional<std::int64_t> value = node->value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > 65535) fail(*node, key, "must be an integer from 1 to 65535");
    return static_cast<int>(*value);
  }

  [[nodiscard]] std::vector<double> numbers(const toml::node& node, std::string_view key) const {
    const toml::array* const array = node.as_array();
    if (array == nullptr) fail(node, key, "must be a list of numbers");
    std::vector<double> values;
    for (const toml::node& entry : *array) values.push_back(number_of(entry, key));
    return values;
  }

  /// File, line and key, for messages.
  [[nodiscard]] std::string place(const toml::node& node, std::string_view key) const {
    return fmt::format("{}:{}: \"{}\"", file_, node.source().begin.line, key);
  }

  [[noreturn]] void fail(const toml::node& node, std::string_view key, const std::string& problem) const {
    throw InputError(place(node, key) + " " + problem);
  }

  void require(const std::vector<std::string_view>& keys) const {
    for (const std::string_view key : keys) {
      if (find(key) != nullptr) continue;
      throw InputError(
          file_, table_->source().begin.line,
          "\"" + std::string(key) + "\" is missing; the format of the sequence does not know it");
    }
  }

  [[nodiscard]] bool is_empty() const { return table_ == nullptr; }

 private:
  [[nodiscard]] double number_of(const toml::node& node, std::string_view key) const {
    const std::optional<double> value = node.value<double>();
    if (!node.is_number() || !value || !std::isfinite(*value)) fail(node, key, "must be a finite number");
    return *value;
  }

  std::string file_;
  const toml::table* table_;
};

/// Whether the file is YAML by its extension, or its first line that is no comment: a directive or "key:".
bool is_yaml(const std::filesystem::path& file) {
  if (file.extension() == ".yaml" || file.extension() == ".yml") return true;
  const std::string text = eval::read_text_file(file);
  eval::LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t begin = line->find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || (*line)[begin] == '#') continue;
    const std::size_t colon = line->find(':');
    return (*line)[begin] == '%' || line->starts_with("---") ||
           (colon != std::string_view::npos && line->substr(0, colon).find('=') == std::string_view::npos);
  }
  return false;
}

toml::table parse(const std::filesystem::path& file) {
  try {
    return toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    throw InputError(
        file.string(), error.source().begin.line,
        "is not valid TOML (" + std::string(error.description()) +
            "); if this is another format, write its values into a rig.toml: --rig reads TOML, and "
            "YAML of Kalibr, OpenVINS, EuRoC, OpenCV, ROS, ORB-SLAM and VINS");
  }
}

Section section(const std::string& file, const toml::table& root, std::string_view name) {
  const toml::node* const node = root.get(name);
  if (node != nullptr && !node->is_table()) {
    throw InputError(file, node->source().begin.line, "\"" + std::string(name) + "\" must be a table");
  }
  return Section(file, node == nullptr ? nullptr : node->as_table());
}

CameraModel model_of(const Section& camera, CameraModel fallback) {
  const toml::node* const node = camera.find("model");
  if (node == nullptr) return fallback;
  const std::optional<std::string> name = node->value_exact<std::string>();
  for (const auto& [model, spelling] : enum_names(CameraModel{})) {
    if (name == spelling) return model;
  }
  camera.fail(*node, "model", "must be \"radial-tangential\" or \"kannala-brandt\"");
}

std::string_view model_name(CameraModel model) {
  for (const auto& [value, name] : enum_names(CameraModel{})) {
    if (value == model) return name;
  }
  STILLPOINT_CHECK(false && "a camera model without name");
  return {};
}

/// A camera that the format does not know must be given completely: 0 is no sensible default of a value.
void require_complete(const Section& section, const Camera& known) {
  if (section.is_empty() || known.width > 0 || known.fx > 0.0) return;
  section.require({"width", "height", "fx", "fy", "cx", "cy"});
}

Camera override_intrinsics(const Section& section, Camera camera) {
  camera.width = section.image_size("width", camera.width);
  camera.height = section.image_size("height", camera.height);
  camera.fx = section.positive("fx", camera.fx);
  camera.fy = section.positive("fy", camera.fy);
  camera.cx = section.number("cx", camera.cx);
  camera.cy = section.number("cy", camera.cy);
  return camera;
}

Camera override_camera(const Section& section, const Camera& known) {
  section.allow_only({"width", "height", "fx", "fy", "cx", "cy", "model", "distortion", "rolling_shutter_s"});
  Camera camera = override_intrinsics(section, known);
  camera.model = model_of(section, camera.model);
  const toml::node* const distortion = section.find("distortion");
  if (distortion == nullptr) return camera;
  return with_lens(camera,
                   {.name = std::string(model_name(camera.model)),
                    .coefficients = section.numbers(*distortion, "distortion")},
                   section.place(*distortion, "distortion"));
}

Pose pose_of(const Section& section, std::string_view key) {
  const toml::node& node = *section.find(key);
  const std::vector<double> values = section.numbers(node, key);
  if (values.size() != 16) section.fail(node, key, "must have 16 numbers (4x4, row-major)");
  const std::optional<Pose> pose = eval::rigid_pose(std::span<const double, 16>(values));
  if (!pose) section.fail(node, key, "is not a rigid transform; the last row must be 0 0 0 1");
  return *pose;
}

/// Axes of an inertial sensor.
Eigen::Matrix3d axes_of(const Section& section, std::string_view key, const Eigen::Matrix3d& fallback) {
  const toml::node* const node = section.find(key);
  if (node == nullptr) return fallback;
  const std::vector<double> values = section.numbers(*node, key);
  if (values.size() != 9) section.fail(*node, key, "must have 9 numbers (3x3, row-major)");
  Eigen::Matrix3d axes = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
  if (!are_plausible_axes(axes))
    section.fail(
        *node, key,
        "must be within 0.2 of the identity matrix: relative scales beside 1 on the diagonal, angles in "
        "radians beside it");
  return axes;
}

constexpr double kLargestDepthOffset = 0.2;  // [1/m]: 20 % at 1 m

/// The camera of depth images that are not registered; must be given completely.
std::optional<DepthCamera> depth_camera_of(const Section& depth) {
  depth.allow_only({"scale", "offset", "width", "height", "fx", "fy", "cx", "cy", "T_c_d"});
  const std::vector<std::string_view> keys = {"width", "height", "fx", "fy", "cx", "cy", "T_c_d"};
  const auto is_given = [&](std::string_view key) { return depth.find(key) != nullptr; };
  if (std::ranges::none_of(keys, is_given)) return {};
  depth.require(keys);
  return DepthCamera{.camera = override_intrinsics(depth, Camera{}), .T_c_d = pose_of(depth, "T_c_d")};
}

}  // namespace

OverriddenRig apply_rig_file(const std::filesystem::path& file, const Rig& rig) {
  std::error_code ignored;
  require_regular_file(file);
  if (!std::filesystem::exists(file, ignored)) throw InputError(file.string(), "no such rig file");
  if (is_yaml(file)) return apply_rig_yaml(file, rig);
  const toml::table root = parse(file);
  if (root.empty())
    throw InputError(file.string(), "is empty; add [camera], [imu] or [depth], or remove the file");
  Section(file.string(), &root).allow_only({"camera", "depth", "imu"});
  const Section camera = section(file.string(), root, "camera");
  const Section depth = section(file.string(), root, "depth");
  const Section imu = section(file.string(), root, "imu");
  imu.allow_only({"T_b_c", "gyro_noise", "accel_noise", "gyro_walk", "accel_walk", "time_offset_s",
                  "gyro_axes", "accel_axes"});

  OverriddenRig result{.rig = rig,
                       .has_extrinsic = imu.find("T_b_c") != nullptr,
                       .depth_camera = depth_camera_of(depth),
                       .notes = {}};
  result.rig.camera = override_camera(camera, rig.camera);
  const toml::node* const shutter = camera.find("rolling_shutter_s");
  result.rig.rolling_shutter_s = camera.number("rolling_shutter_s", rig.rolling_shutter_s);
  if (result.rig.rolling_shutter_s < 0.0 && shutter != nullptr) {
    camera.fail(*shutter, "rolling_shutter_s", "must not be negative");
  }
  result.rig.depth_units_per_m = depth.positive("scale", rig.depth_units_per_m);
  result.rig.depth_offset = depth.number("offset", rig.depth_offset);
  if (std::abs(result.rig.depth_offset) > kLargestDepthOffset)
    depth.fail(*depth.find("offset"), "offset", "must be within 0.2: it is in 1/m, of the inverse depth");
  if (result.has_extrinsic) result.rig.T_b_c = pose_of(imu, "T_b_c");
  result.rig.imu_noise = ImuNoise{.gyro_noise = imu.positive("gyro_noise", rig.imu_noise.gyro_noise),
                                  .accel_noise = imu.positive("accel_noise", rig.imu_noise.accel_noise),
                                  .gyro_walk = imu.positive("gyro_walk", rig.imu_noise.gyro_walk),
                                  .accel_walk = imu.positive("accel_walk", rig.imu_noise.accel_walk)};
  result.rig.time_offset_s = imu.number("time_offset_s", rig.time_offset_s);
  result.rig.imu_axes = {.gyro = axes_of(imu, "gyro_axes", rig.imu_axes.gyro),
                         .accel = axes_of(imu, "accel_axes", rig.imu_axes.accel)};
  require_complete(camera, rig.camera);
  return result;
}

std::string rig_file_text(const Rig& rig, bool with_extrinsic) {
  const Camera& camera = rig.camera;
  std::string text = fmt::format(
      "[camera]\nwidth = {}\nheight = {}\nfx = {:.17g}\nfy = {:.17g}\ncx = {:.17g}\ncy = {:.17g}\nmodel = "
      "\"{}\"\n"
      "distortion = [{:.17g}]\nrolling_shutter_s = {:.17g}\n\n[depth]\nscale = {:.17g}\n",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, model_name(camera.model),
      fmt::join(camera.coefficients(), ", "), rig.rolling_shutter_s, rig.depth_units_per_m);
  if (!rig.has_imu) return text;
  text += "\n[imu]\n";
  if (with_extrinsic) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = rig.T_b_c.matrix();
    text += fmt::format("T_b_c = [{:.17g}]\n", fmt::join(rows.data(), rows.data() + 16, ", "));
  }
  return text + fmt::format(
                    "gyro_noise = {:.17g}\naccel_noise = {:.17g}\ngyro_walk = {:.17g}\naccel_walk = {:.17g}\n"
                    "time_offset_s = {:.17g}\n",
                    rig.imu_noise.gyro_noise, rig.imu_noise.accel_noise, rig.imu_noise.gyro_walk,
                    rig.imu_noise.accel_walk, rig.time_offset_s);
}

}  // namespace stillpoint::datasets
