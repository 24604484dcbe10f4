// SPDX-License-Identifier: BSD-3-Clause
// Several recordings of one device.
#include <algorithm>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/calibration/calibrate.h"

namespace stillpoint {
namespace {

/// An entry of a rig file.
struct StatedField {
  std::string name;
  std::vector<double> values;
};

std::vector<double> numbers_of(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return {rows.data(), rows.data() + rows.size()};
}

std::vector<double> numbers_of(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = matrix;
  return {rows.data(), rows.data() + rows.size()};
}

/// Size and intrinsics of a camera.
void add_camera(const std::string& section, const Camera& camera, std::vector<StatedField>& fields) {
  fields.push_back({section + " width", {static_cast<double>(camera.width)}});
  fields.push_back({section + " height", {static_cast<double>(camera.height)}});
  fields.push_back({section + " fx", {camera.fx}});
  fields.push_back({section + " fy", {camera.fy}});
  fields.push_back({section + " cx", {camera.cx}});
  fields.push_back({section + " cy", {camera.cy}});
}

std::vector<StatedField> stated_fields(const CalibrationInput& input) {
  const Rig& rig = input.stated.rig;
  std::vector<StatedField> fields;
  add_camera("[camera]", rig.camera, fields);
  fields.push_back(
      {"[camera] model (0: radial-tangential, 1: kannala-brandt)", {static_cast<double>(rig.camera.model)}});
  fields.push_back({"[camera] distortion", {rig.camera.distortion.begin(), rig.camera.distortion.end()}});
  fields.push_back({"[camera] rolling_shutter_s", {rig.rolling_shutter_s}});
  fields.push_back({"[depth] scale", {rig.depth_units_per_m}});
  fields.push_back({"[depth] offset", {rig.depth_offset}});
  fields.push_back({"delay of the depth", {input.stated.depth_delay_s}});
  if (!input.depth_is_registered) {
    add_camera("[depth]", input.stated.depth_camera, fields);
    fields.push_back({"[depth] T_c_d", numbers_of(input.stated.T_c_d)});
  }
  if (input.imu.empty()) return fields;
  fields.push_back({"[imu] T_b_c", numbers_of(rig.T_b_c)});
  fields.push_back({"[imu] gyro_noise", {rig.imu_noise.gyro_noise}});
  fields.push_back({"[imu] accel_noise", {rig.imu_noise.accel_noise}});
  fields.push_back({"[imu] gyro_walk", {rig.imu_noise.gyro_walk}});
  fields.push_back({"[imu] accel_walk", {rig.imu_noise.accel_walk}});
  fields.push_back({"[imu] time_offset_s", {rig.time_offset_s}});
  fields.push_back({"[imu] gyro_axes", numbers_of(rig.imu_axes.gyro)});
  fields.push_back({"[imu] accel_axes", numbers_of(rig.imu_axes.accel)});
  return fields;
}

std::string text_of(const std::vector<double>& values) {
  std::ostringstream text;
  text.precision(12);
  for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? ", " : "") << values[i];
  return values.size() == 1 ? text.str() : "[" + text.str() + "]";
}

/// Last time of a recording.
Timestamp end_of(const CalibrationInput& input) {
  Timestamp end = input.imu.empty() ? Timestamp{} : input.imu.back().t;
  for (const CalibrationSection& section : input.sections)
    end = std::max(end, section.keyframes.back().state.t);
  return end;
}

Timestamp begin_of(const CalibrationInput& input) {
  const Timestamp first = input.sections.front().keyframes.front().state.t;
  return input.imu.empty() ? first : std::min(first, input.imu.front().t);
}

}  // namespace

std::string stated_difference(const CalibrationInput& a, const CalibrationInput& b) {
  if (a.imu.empty() != b.imu.empty()) return "only one of them has inertial data";
  if (a.depth_is_registered != b.depth_is_registered) return "only one of them has registered depth images";
  const std::vector<StatedField> fields = stated_fields(a), others = stated_fields(b);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].values != others[i].values)
      return fields[i].name + " is " + text_of(fields[i].values) + " and " + text_of(others[i].values);
  }
  return {};
}

void append_recording(CalibrationInput& all, CalibrationInput next) {
  constexpr double kGap_s = 3600.0;  // no interval of inertial data contains both
  if (const std::string difference = stated_difference(all, next); !difference.empty())
    throw InputError("calibration", "the recordings are not of one device: " + difference);
  if (all.sections.empty() || next.sections.empty())
    throw InputError("calibration", "a recording has no keyframes; leave it out, or correct the rig");
  const double shift_s = seconds_between(begin_of(next), end_of(all)) + kGap_s;
  for (CalibrationSection& section : next.sections) {
    for (CalibrationKeyframe& keyframe : section.keyframes)
      keyframe.state.t = after(keyframe.state.t, shift_s);
    all.sections.push_back(std::move(section));
  }
  for (ImuSample& sample : next.imu) {
    sample.t = after(sample.t, shift_s);
    all.imu.push_back(sample);
  }
}

}  // namespace stillpoint
