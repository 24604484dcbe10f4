// SPDX-License-Identifier: BSD-3-Clause
/// Calibration files in the YAML dialect of OpenCV and EuRoC, and other YAML files that consist of a map.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/rig.h"

namespace stillpoint::datasets {

/// A map node of a calibration file; every access checks that the value exists and is valid.
class SensorYaml {
 public:
  /// Accepts a first line `%YAML:1.0` and `!!opencv-matrix` tags.
  /// @throws InputError if the file is missing or is not a YAML map
  explicit SensorYaml(const std::filesystem::path& file);

  /// Each of the following throws an InputError that names file and key if the value is missing or invalid.
  [[nodiscard]] SensorYaml child(const std::string& key) const;
  [[nodiscard]] std::vector<SensorYaml> list(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;  ///< a list of single values
  [[nodiscard]] double number(const std::string& key) const;                   ///< finite
  [[nodiscard]] double positive(const std::string& key) const;                 ///< finite, greater than 0
  [[nodiscard]] int positive_int(const std::string& key) const;
  /// A list of finite numbers, or of rows of numbers: the value of `key` itself, or of its entry `data`.
  [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
  /// A 4x4 matrix of 16 numbers in row-major order.
  [[nodiscard]] Pose pose(const std::string& key) const;
  /// `camera` with model and coefficients from `distortion_model`, and `distortion_coefficients` or, as
  /// Kalibr writes it, `distortion_coeffs`.
  [[nodiscard]] Camera with_distortion(Camera camera) const;
  /// A camera of Kalibr or EuRoC: `resolution`, `intrinsics` (fx fy cx cy) and distortion. Of the models that
  /// may be named by `camera_model`, only pinhole.
  [[nodiscard]] Camera camera() const;
  /// The four densities of an IMU in a file of Kalibr or EuRoC; greater than 0.
  [[nodiscard]] ImuNoise imu_noise() const;

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> keys() const;  ///< in the order of the file
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;

 private:
  SensorYaml(std::string file, std::string prefix, const YAML::Node& node)
      : file_(std::move(file)), prefix_(std::move(prefix)), node_(node) {}
  [[nodiscard]] YAML::Node require(const std::string& key) const;
  [[nodiscard]] int positive_int(const std::string& key, double value) const;

  std::string file_;
  std::string prefix_;  ///< dotted path of the parent keys, for messages
  YAML::Node node_;
};

}  // namespace stillpoint::datasets
