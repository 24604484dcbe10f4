// SPDX-License-Identifier: BSD-3-Clause
/// Inertial samples from text files: one file of six numbers, or gyroscope and accelerometer apart.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "core/types/imu_sample.h"
#include "datasets/fault_log.h"

namespace stillpoint {

enum class TimeUnit { kSeconds, kNanoseconds };

/// Reads rows `t wx wy wz ax ay az` [rad/s, m/s^2] (EuRoC's order).
/// @return strictly rising, not empty
/// @throws InputError if the file is missing, empty, unsorted, or a row is not seven finite numbers
[[nodiscard]] std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, TimeUnit unit,
                                                   FaultLog& faults);

/// Three components at a time.
struct VectorSample {
  Timestamp t;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

/// Reads rows `t x y z` with t in seconds; otherwise like `read_imu_file`.
[[nodiscard]] std::vector<VectorSample> read_vector_file(const std::filesystem::path& file, FaultLog& faults);

/// One sample for each gyroscope sample that lies within the accelerometer's span; the acceleration is
/// interpolated linearly between its two neighbours.
/// @param gyro, accel strictly rising
[[nodiscard]] std::vector<ImuSample> merge_onto_gyro(std::span<const VectorSample> gyro,
                                                     std::span<const VectorSample> accel);

}  // namespace stillpoint
