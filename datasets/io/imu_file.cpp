// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/imu_file.h"

#include "datasets/io/text_table.h"

namespace stillpoint::datasets {
namespace {

Eigen::Vector3d vector_at(const TextTable& table, const TextRow& row, std::size_t field) {
  return {table.number(row, field), table.number(row, field + 1), table.number(row, field + 2)};
}

/// Reads one sample per row with `parse(table, row)` and checks the order of the timestamps.
template <class Sample, class Parse>
std::vector<Sample> read_samples(const std::filesystem::path& file, FaultLog& faults, const Parse& parse) {
  const TextTable table(file);
  std::vector<Sample> samples;
  samples.reserve(table.rows().size());
  table.for_each(faults, [&](const TextRow& row) {
    const Sample sample = parse(table, row);
    if (!samples.empty()) table.require_increasing(row, samples.back().t, sample.t);
    samples.push_back(sample);
  });
  faults.guard([&] {
    if (samples.empty()) table.fail("contains no samples; remove the file to run without this sensor");
  });
  return samples;
}

}  // namespace

std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, TimeUnit unit, FaultLog& faults) {
  return read_samples<ImuSample>(file, faults, [unit](const TextTable& table, const TextRow& row) {
    const Timestamp t = unit == TimeUnit::kSeconds ? table.seconds(row, 0) : table.nanoseconds(row, 0);
    return ImuSample{.t = t, .gyro_b = vector_at(table, row, 1), .accel_b = vector_at(table, row, 4)};
  });
}

std::vector<VectorSample> read_vector_file(const std::filesystem::path& file, FaultLog& faults) {
  return read_samples<VectorSample>(file, faults, [](const TextTable& table, const TextRow& row) {
    return VectorSample{.t = table.seconds(row, 0), .value = vector_at(table, row, 1)};
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
      const double weight = seconds_between(a.t, sample.t) / seconds_between(a.t, b.t);
      value = (1.0 - weight) * a.value + weight * b.value;
    }
    merged.push_back(ImuSample{.t = sample.t, .gyro_b = sample.value, .accel_b = value});
  }
  return merged;
}

}  // namespace stillpoint::datasets
