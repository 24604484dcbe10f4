// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/sensor_yaml.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "datasets/io/lens_model.h"
#include "eval/io/matrix_files.h"

namespace stillpoint::datasets {
namespace {

/// The text of the file; the first line that OpenCV writes (`%YAML:1.0`) is blanked: it is not valid YAML.
std::string read_text(const std::filesystem::path& file) {
  require_regular_file(file);
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw InputError(file.string(), "cannot be opened; the calibration of the sequence is missing");
  }
  std::ostringstream content;
  content << in.rdbuf();
  std::string text = content.str();
  if (text.starts_with("%YAML:")) text.erase(0, std::min(text.find('\n'), text.size()));
  return text;
}

/// The entries of a list, or of the lists in it: Kalibr writes matrices as lists of rows.
std::vector<YAML::Node> flattened(const YAML::Node& list) {
  std::vector<YAML::Node> entries;
  for (const YAML::Node& entry : list) {
    if (entry.IsSequence()) {
      for (const YAML::Node& part : entry) entries.push_back(part);
    } else {
      entries.push_back(entry);
    }
  }
  return entries;
}

}  // namespace

SensorYaml::SensorYaml(const std::filesystem::path& file) : file_(file.string()) {
  const std::string text = read_text(file);
  try {
    node_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(file_, error.mark.line + 1, "is not valid YAML (" + error.msg + ")");
  }
  if (!node_.IsMap()) throw InputError(file_, "contains no map of values; copy the file again");
}

std::vector<std::string> SensorYaml::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) throw InputError(file_, prefix_ + ": has a key that is no text");
    keys.push_back(entry.first.Scalar());
  }
  return keys;
}

bool SensorYaml::has(const std::string& key) const { return static_cast<bool>(node_[key]); }

YAML::Node SensorYaml::require(const std::string& key) const {
  YAML::Node value = std::as_const(node_)[key];
  if (!value || value.IsNull()) fail(key, "is missing");
  return value;
}

SensorYaml SensorYaml::child(const std::string& key) const {
  YAML::Node value = require(key);
  if (!value.IsMap()) fail(key, "must be a map");
  return SensorYaml(file_, prefix_ + key + ".", value);
}

std::vector<SensorYaml> SensorYaml::list(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsSequence()) fail(key, "must be a list");
  std::vector<SensorYaml> entries;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!value[i].IsMap()) fail(key, "must be a list of maps");
    entries.push_back(SensorYaml(file_, prefix_ + key + "[" + std::to_string(i) + "].", value[i]));
  }
  return entries;
}

std::string SensorYaml::text(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsScalar()) fail(key, "must be a single value");
  return value.Scalar();
}

std::vector<std::string> SensorYaml::texts(const std::string& key) const {
  const YAML::Node value = require(key);
  if (!value.IsSequence()) fail(key, "must be a list");
  std::vector<std::string> result;
  for (const YAML::Node& entry : value) {
    if (!entry.IsScalar()) fail(key, "must be a list of single values");
    result.push_back(entry.Scalar());
  }
  return result;
}

double SensorYaml::number(const std::string& key) const {
  double value = 0.0;
  if (!YAML::convert<double>::decode(require(key), value) || !std::isfinite(value)) {
    fail(key, "must be a finite number");
  }
  return value;
}

double SensorYaml::positive(const std::string& key) const {
  const double value = number(key);
  if (!(value > 0.0)) fail(key, "must be greater than 0");
  return value;
}

int SensorYaml::positive_int(const std::string& key) const { return positive_int(key, number(key)); }

int SensorYaml::positive_int(const std::string& key, double value) const {
  if (value < 1.0 || value > 65535.0 || value != std::floor(value)) {
    fail(key, "must be an integer from 1 to 65535");
  }
  return static_cast<int>(value);
}

std::vector<double> SensorYaml::numbers(const std::string& key) const {
  YAML::Node value = require(key);
  if (value.IsMap()) value.reset(YAML::Node(value["data"]));
  if (!value.IsSequence()) fail(key, "must be a list of numbers");
  std::vector<double> result;
  for (const YAML::Node& entry : flattened(value)) {
    double number = 0.0;
    if (!YAML::convert<double>::decode(entry, number) || !std::isfinite(number)) {
      fail(key, "must contain finite numbers only");
    }
    result.push_back(number);
  }
  return result;
}

Pose SensorYaml::pose(const std::string& key) const {
  const std::vector<double> values = numbers(key);
  if (values.size() != 16) fail(key, "must have 16 numbers, not " + std::to_string(values.size()));
  const std::optional<Pose> result = eval::rigid_pose(std::span<const double, 16>(values));
  if (!result) fail(key, "is not a rigid transform");
  return *result;
}

Camera SensorYaml::with_distortion(Camera camera) const {
  const std::string key = has("distortion_coeffs") ? "distortion_coeffs" : "distortion_coefficients";
  return with_lens(camera, {.name = text("distortion_model"), .coefficients = numbers(key)},
                   file_ + ": \"" + prefix_ + "distortion_model\"");
}

Camera SensorYaml::camera() const {
  if (has("camera_model") && text("camera_model") != "pinhole")
    fail("camera_model", "is \"" + text("camera_model") +
                             "\", which is not supported; calibrate with pinhole-radtan or pinhole-equi");
  const std::vector<double> size = numbers("resolution");
  if (size.size() != 2) fail("resolution", "must be width and height");
  const std::vector<double> values = numbers("intrinsics");
  if (values.size() != 4 || values[0] <= 0.0 || values[1] <= 0.0)
    fail("intrinsics", "must be the four numbers fx, fy, cx, cy");
  return with_distortion(Camera{.width = positive_int("resolution", size[0]),
                                .height = positive_int("resolution", size[1]),
                                .fx = values[0],
                                .fy = values[1],
                                .cx = values[2],
                                .cy = values[3]});
}

ImuNoise SensorYaml::imu_noise() const {
  return ImuNoise{.gyro_noise = positive("gyroscope_noise_density"),
                  .accel_noise = positive("accelerometer_noise_density"),
                  .gyro_walk = positive("gyroscope_random_walk"),
                  .accel_walk = positive("accelerometer_random_walk")};
}

void SensorYaml::fail(const std::string& key, const std::string& problem) const {
  throw InputError(file_, "\"" + prefix_ + key + "\" " + problem);
}

}  // namespace stillpoint::datasets
