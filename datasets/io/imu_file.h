// SPDX-License-Identifier: BSD-3-Clause
/// IMU samples from text files: one file for both sensors, or separate gyroscope and accelerometer files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/types/rig.h"
#include "eval/io/text_reader.h"

namespace stillpoint::datasets {

/// Largest absolute value of an axis that a sensor can output. Values beyond are faults of the file: a wrong
/// unit or defective data.
struct SensorRange {
  double limit = 0.0;
  std::string_view quantity;
  std::string_view unit;
  std::string_view likely_unit;  ///< of files with values beyond the limit
};
/// The largest full scale of inertial measurement units is 4000 deg/s = 70 rad/s.
inline constexpr SensorRange kGyroscopeRange{100.0, "angular velocity", "rad/s", "deg/s"};
/// 100 g; the full scale of inertial measurement units for navigation is at most 40 g.
inline constexpr SensorRange kAccelerometerRange{1000.0, "acceleration", "m/s^2", "mg"};

/// A value beyond the range of its sensor.
class SensorRangeError : public InputError {
 public:
  SensorRangeError(const InputError& error, const SensorRange& range) : InputError(error), range_(range) {}
  [[nodiscard]] const SensorRange& range() const { return range_; }

 private:
  SensorRange range_;
};

/// Reads rows `t wx wy wz ax ay az` [rad/s, m/s^2] (column order of EuRoC), or the columns that a header
/// names (eval/io/column_header.h), in the unit of time that it states.
/// @param unit of the stamps, unless the header states one
/// @return strictly increasing in time, not empty
/// @throws InputError if the file is missing, empty, unsorted, a row is not seven finite numbers, or the
/// header states another unit or names other columns; SensorRangeError
[[nodiscard]] std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, eval::TimeUnit unit,
                                                   FaultLog& faults);

/// A timestamped 3-vector.
struct VectorSample {
  Timestamp t;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

/// Reads rows `t x y z` with t in seconds; otherwise like `read_imu_file`.
[[nodiscard]] std::vector<VectorSample> read_vector_file(const std::filesystem::path& file,
                                                         const SensorRange& range, FaultLog& faults);

/// Accelerometer samples that are further apart are not interpolated; see `merge_onto_gyro`.
inline constexpr double kMaxAccelInterval_s = 0.05;

/// One IMU sample for each gyroscope sample within the time span of `accel`; the acceleration is interpolated
/// linearly between the two neighboring accelerometer samples. Gyroscope samples within an interval longer
/// than `kMaxAccelInterval_s` are dropped, so that a gap of the accelerometer is one of the IMU.
/// @param gyro, accel strictly increasing in time
[[nodiscard]] std::vector<ImuSample> merge_onto_gyro(std::span<const VectorSample> gyro,
                                                     std::span<const VectorSample> accel);

}  // namespace stillpoint::datasets
