// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/imu_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "eval/io/column_header.h"

namespace stillpoint::datasets {
namespace {

/// Columns of x, y and z.
using VectorColumns = std::array<std::size_t, 3>;

Eigen::Vector3d vector_at(const eval::TextRow& row, const VectorColumns& columns, const SensorRange& range) {
  Eigen::Vector3d vector;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    vector[axis] = row.finite_number(columns[static_cast<std::size_t>(axis)]);
    if (std::abs(vector[axis]) <= range.limit) continue;
    throw SensorRangeError(
        row.error(fmt::format("the {} {:g} exceeds {} {}, the range of such sensors; is it in {}? convert "
                              "the file or remove the row",
                              range.quantity, vector[axis], range.limit, range.unit, range.likely_unit)),
        range);
  }
  return vector;
}

/// Where the values of a row are.
struct SampleLayout {
  eval::TimeColumns time;
  VectorColumns gyro{1, 2, 3};
  VectorColumns accel{4, 5, 6};
  eval::TimeUnit unit = eval::TimeUnit::kSeconds;
  long header_line = 0;  ///< of a header that is no comment; 0 without one
};

/// A text and the name of its file.
struct NamedText {
  const std::string& text;
  const std::string& name;
};

/// @throws InputError if the unit that the header states for a vector is `other`
void require_unit(const NamedText& source, const eval::TableHeader& header, eval::Quantity quantity,
                  const SensorRange& range) {
  const std::string unit = eval::unit_of(header, quantity);
  constexpr std::array<std::string_view, 4> kDegrees{"deg", "dps", "\u00b0", "\u00ba"};  // degree, ordinal
  const bool is_other =
      quantity == eval::Quantity::kAngularVelocity
          ? std::ranges::any_of(kDegrees, [&](auto part) { return unit.find(part) != std::string::npos; })
          : unit == "g" || unit == "mg" || unit.find("g ") == 0;
  if (!is_other) return;
  throw InputError(source.name, header.line,
                   fmt::format("the header states the unit {} of the {}; convert the file to {}", unit,
                               range.quantity, range.unit));
}

/// By the names in the header, else the columns of EuRoC.
/// @throws InputError if a header that is no comment does not name the columns
SampleLayout imu_layout(const NamedText& source, eval::TimeUnit unit) {
  const eval::TableHeader header = eval::find_header(source.text);
  const std::optional<eval::TimeColumns> time = eval::time_columns(header);
  const std::vector<std::size_t> gyro = eval::columns_of(header, eval::Quantity::kAngularVelocity);
  const std::vector<std::size_t> accel = eval::columns_of(header, eval::Quantity::kAcceleration);
  SampleLayout layout{.unit = unit};
  if (!header.is_comment) layout.header_line = header.line;
  if (time && !gyro.empty() && !accel.empty() && eval::fits_rows(header, source.text)) {
    require_unit(source, header, eval::Quantity::kAngularVelocity, kGyroscopeRange);
    require_unit(source, header, eval::Quantity::kAcceleration, kAccelerometerRange);
    layout.time = *time;
    layout.unit = eval::time_unit(header, source.name).value_or(unit);
    std::copy(gyro.begin(), gyro.end(), layout.gyro.begin());
    std::copy(accel.begin(), accel.end(), layout.accel.begin());
  } else if (layout.header_line > 0) {
    throw InputError(
        source.name, header.line,
        "the header does not name the columns of a stamp, an angular velocity and an acceleration "
        "once each; expected names such as \"t,wx,wy,wz,ax,ay,az\", or no header");
  }
  return layout;
}

/// Reads one sample per row with `parse(row)` and checks the order of the timestamps.
template <class Sample, class Parse>
std::vector<Sample> read_samples(const NamedText& source, FaultLog& faults, const Parse& parse) {
  std::vector<Sample> samples;
  eval::for_each_row(source.text, source.name, faults, [&](const eval::TextRow& row) {
    const std::optional<Sample> parsed = parse(row);
    if (!parsed) return;
    const Sample& sample = *parsed;
    if (!samples.empty()) row.require_increasing(samples.back().t, sample.t);
    samples.push_back(sample);
  });
  faults.guard([&] {
    if (samples.empty()) {
      throw InputError(source.name, "contains no samples; remove the file to run without this sensor");
    }
  });
  return samples;
}

}  // namespace

std::vector<ImuSample> read_imu_file(const std::filesystem::path& file, eval::TimeUnit unit,
                                     FaultLog& faults) {
  const std::string text = eval::read_text_file(file);
  const std::string name = file.string();
  const SampleLayout layout = imu_layout({text, name}, unit);
  return read_samples<ImuSample>(
      {text, name}, faults, [&layout](const eval::TextRow& row) -> std::optional<ImuSample> {
        if (row.line == layout.header_line) return std::nullopt;
        return ImuSample{.t = eval::stamp_of(row, layout.time, layout.unit),
                         .gyro_b = vector_at(row, layout.gyro, kGyroscopeRange),
                         .accel_b = vector_at(row, layout.accel, kAccelerometerRange)};
      });
}

std::vector<VectorSample> read_vector_file(const std::filesystem::path& file, const SensorRange& range,
                                           FaultLog& faults) {
  const std::string text = eval::read_text_file(file);
  const std::string name = file.string();
  return read_samples<VectorSample>({text, name}, faults, [&range](const eval::TextRow& row) {
    return std::optional(
        VectorSample{.t = row.time(0, eval::TimeUnit::kSeconds), .value = vector_at(row, {1, 2, 3}, range)});
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
