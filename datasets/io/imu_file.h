// SPDX-License-Identifier: BSD-3-Clause
/// IMU samples from text files: one file for both sensors, or separate gyroscope and accelerometer files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "core/base/fault_log.h"
#include "core/types/imu_sample.h"
#include "eval/io/text_table.h"

namespace stillpoint::datasets {

/// Reads rows `t wx wy wz ax ay az` [rad/s, m/s^2] (column order of EuRoC).
/// @return strictly increasing in time, not empty
/// @throws InputError if the file is missing, empty, unsorted, or a row is not seven finite numbers
[[nodiscard]] std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, eval::TimeUnit unit,
                                                   FaultLog& faults);

/// A timestamped 3-vector.
struct VectorSample {
  Timestamp t;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

/// Reads rows `t x y z` with t in seconds; otherwise like `read_imu_file`.
[[nodiscard]] std::vector<VectorSample> read_vector_file(const std::filesystem::path& file, FaultLog& faults);

/// One IMU sample for each gyroscope sample within the time span of `accel`; the acceleration is interpolated
/// linearly between the two neighboring accelerometer samples.
/// @param gyro, accel strictly increasing in time
[[nodiscard]] std::vector<ImuSample> merge_onto_gyro(std::span<const VectorSample> gyro,
                                                     std::span<const VectorSample> accel);

}  // namespace stillpoint::datasets
