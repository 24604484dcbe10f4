// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/imu_file.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace stillpoint::datasets {
namespace {

/// The three numbers from `field` on.
Eigen::Vector3d vector_at(const eval::TextRow& row, std::size_t field, const SensorRange& range) {
  Eigen::Vector3d vector;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::size_t index = field + static_cast<std::size_t>(axis);
    vector[axis] = row.finite_number(index);
    if (std::abs(vector[axis]) <= range.limit) continue;
    throw row.error(
        fmt::format("the {} {:g} exceeds {} {}, the range of such sensors; is it in {}? convert the file or "
                    "remove the row",
                    range.quantity, vector[axis], range.limit, range.unit, range.likely_unit));
  }
  return vector;
}

/// Reads one sample per row with `parse(row)` and checks the order of the timestamps.
template <class Sample, class Parse>
std::vector<Sample> read_samples(const std::filesystem::path& file, FaultLog& faults, const Parse& parse) {
  const std::string text = eval::read_text_file(file);
  const std::string name = file.string();
  std::vector<Sample> samples;
  eval::for_each_row(text, name, faults, [&](const eval::TextRow& row) {
    const Sample sample = parse(row);
    if (!samples.empty()) row.require_increasing(samples.back().t, sample.t);
    samples.push_back(sample);
  });
  faults.guard([&] {
    if (samples.empty()) {
      throw InputError(name, "contains no samples; remove the file to run without this sensor");
    }
  });
  return samples;
}

}  // namespace

std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, eval::TimeUnit unit,
                                     FaultLog& faults) {
  return read_samples<ImuSample>(file, faults, [unit](const eval::TextRow& row) {
    return ImuSample{.t = row.time(0, unit),
                     .gyro_b = vector_at(row, 1, kGyroscopeRange),
                     .accel_b = vector_at(row, 4, kAccelerometerRange)};
  });
}

std::vector<VectorSample> read_vector_file(const std::filesystem::path& file, const SensorRange& range,
                                           FaultLog& faults) {
  return read_samples<VectorSample>(file, faults, [&range](const eval::TextRow& row) {
    return VectorSample{.t = row.time(0, eval::TimeUnit::kSeconds), .value = vector_at(row, 1, range)};
  });
}

std::vector<ImuSample> merge_onto_gyro(std::span<const VectorSample> gyro,
                                       std::span<const VectorSample> accel) {
  std::vector<ImuSample> merged;
  if (accel.empty()) return merged;
  merged.reserve(gyro.size());
  std::size_t left = 0;  // the last accelerometer sample not later than the gyroscope sample
  for (const VectorSample& sample : gyro) {
    if (sample.t < accel.front().t || sample.t > accel.back().t) continue;
    while (left + 1 < accel.size() && accel[left + 1].t <= sample.t) ++left;
    const VectorSample& a = accel[left];
    Eigen::Vector3d value = a.value;
    if (left + 1 < accel.size()) {
      const VectorSample& b = accel[left + 1];
      if (a.t < sample.t && seconds_between(a.t, b.t) > kMaxAccelInterval_s) continue;
      const double weight = seconds_between(a.t, sample.t) / seconds_between(a.t, b.t);
      value = (1.0 - weight) * a.value + weight * b.value;
    }
    merged.push_back(ImuSample{.t = sample.t, .gyro_b = sample.value, .accel_b = value});
  }
  return merged;
}

}  // namespace stillpoint::datasets
