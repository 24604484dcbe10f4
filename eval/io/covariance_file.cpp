// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/covariance_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "core/base/error.h"
#include "core/geometry/decompositions.h"
#include "eval/io/column_header.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kColumnsOfPose = 8;  ///< stamp, position, quaternion
constexpr std::int64_t kMaxDistance_ns = 1'000'000;
constexpr double kMaxNegative = 1e-6;  ///< of an eigenvalue, relative to the largest
constexpr std::size_t kNanosecondDigits = 16;

bool is_layout(std::size_t columns) {
  return columns == 6 || columns == 12 || columns == 21 || columns == 36;
}

bool is_semidefinite(const Eigen::Matrix3d& matrix) {
  if (!matrix.allFinite() || !matrix.isApprox(matrix.transpose(), 1e-6)) return matrix.isZero();
  const Eigen::Vector3d values = eigenvalues(matrix);
  return values[0] >= -kMaxNegative * values[2];
}

/// Of the numbers xx xy xz yy yz zz.
Eigen::Matrix3d symmetric(const double* n) {
  Eigen::Matrix3d matrix;
  matrix << n[0], n[1], n[2], n[1], n[3], n[4], n[2], n[4], n[5];
  return matrix;
}

StampedCovariance covariance_in(Timestamp t, const std::vector<double>& numbers) {
  StampedCovariance result{.t = t};
  if (numbers.size() == 12) {
    result.rotation = symmetric(numbers.data());
    result.position = symmetric(numbers.data() + 6);
    return result;
  }
  std::array<double, 36> matrix{};
  std::size_t next = 0;
  for (std::size_t row = 0; row < 6; ++row) {
    const std::size_t begin = numbers.size() == 36 ? 0 : row;
    const std::size_t end = numbers.size() == 6 ? row + 1 : 6;
    for (std::size_t column = begin; column < end; ++column) {
      matrix[6 * row + column] = numbers[next];
      if (numbers.size() != 36) matrix[6 * column + row] = numbers[next];
      ++next;
    }
  }
  return covariance_of(t, matrix);
}

/// The covariance of a row from the column `first` on; nullopt if it is none.
std::optional<StampedCovariance> covariance_of_row(const TextRow& row, std::size_t first) {
  const std::string_view stamp = row.fields.empty() ? std::string_view() : row.fields.front();
  const bool is_ns = stamp.substr(0, stamp.find('.')).size() >= kNanosecondDigits;
  std::vector<double> numbers;
  for (std::size_t i = first; i < row.fields.size(); ++i) {
    const std::optional<double> number = parse_number(row.fields[i]);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  if (!is_layout(numbers.size())) return std::nullopt;
  const StampedCovariance result =
      covariance_in(row.time(0, is_ns ? TimeUnit::kNanoseconds : TimeUnit::kSeconds), numbers);
  if (!is_semidefinite(result.position) || !is_semidefinite(result.rotation)) return std::nullopt;
  return result;
}

bool is_zero(const StampedCovariance& covariance) {
  return covariance.position.isZero(0.0) && covariance.rotation.isZero(0.0);
}

InputError no_covariance(const TextRow& row) {
  return row.error("is no covariance: it has a negative variance, or is not finite");
}

/// Whether the row names columns instead of containing numbers.
bool is_header(const TextRow& row) { return row.fields.empty() || !parse_number(row.fields.front()); }

/// Whether the header names a column of the pose where covariances would be.
bool has_pose_behind(std::string_view text) {
  const TableHeader header = find_header(text);
  return std::ranges::any_of(columns_of(header, Quantity::kQuaternion),
                             [](std::size_t column) { return column >= kColumnsOfPose; });
}

}  // namespace

StampedCovariance covariance_of(Timestamp t, std::span<const double, 36> matrix) {
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> pose(matrix.data());
  return {.t = t, .position = pose.topLeftCorner<3, 3>(), .rotation = pose.bottomRightCorner<3, 3>()};
}

std::optional<CovarianceTable> find_covariances(std::string_view text, const std::string& name) {
  if (has_pose_behind(text)) return std::nullopt;
  CovarianceTable table;
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) {
    if (table.rows.empty() && is_header(*row)) continue;
    if (row->fields.size() <= kColumnsOfPose || !is_layout(row->fields.size() - kColumnsOfPose))
      return std::nullopt;
    const std::optional<StampedCovariance> covariance = covariance_of_row(*row, kColumnsOfPose);
    if (!covariance) return std::nullopt;
    table.rows.push_back(*covariance);
    table.columns = row->fields.size() - kColumnsOfPose;
  }
  table.rotation_of_body = table.columns == 12;
  if (std::ranges::all_of(table.rows, is_zero)) return std::nullopt;
  return table;
}

std::optional<InputError> fault_in_covariances(std::string_view text, const std::string& name) {
  std::optional<InputError> fault;
  if (has_pose_behind(text)) return fault;
  std::size_t others = 0;
  std::size_t covariances = 0;
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) {
    if (covariances + others == 0 && is_header(*row)) continue;
    const bool is_covariance =
        row->fields.size() > kColumnsOfPose && covariance_of_row(*row, kColumnsOfPose).has_value();
    ++(is_covariance ? covariances : others);
    if (!is_covariance && !fault) fault = no_covariance(*row);
  }
  return covariances > others ? fault : std::nullopt;
}

CovarianceTable parse_covariances(std::string_view text, const std::string& name) {
  CovarianceTable table;
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) {
    if (table.rows.empty() && is_header(*row)) continue;
    if (row->fields.empty() || !is_layout(row->fields.size() - 1))
      throw row->error("has " + std::to_string(row->fields.size()) +
                       " fields; expected a stamp and 6, 12, 21 or 36 numbers of a covariance");
    const std::optional<StampedCovariance> covariance = covariance_of_row(*row, 1);
    if (!covariance) throw no_covariance(*row);
    table.rows.push_back(*covariance);
    table.columns = row->fields.size() - 1;
  }
  table.rotation_of_body = table.columns == 12;
  if (table.rows.empty()) throw InputError(name, "contains no covariances");
  return table;
}

std::vector<StampedCovariance> at_poses(const Trajectory& trajectory, CovarianceTable table) {
  std::ranges::stable_sort(table.rows, {}, &StampedCovariance::t);
  std::vector<StampedCovariance> result;
  result.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) {
    const Timestamp begin{pose.t.ns - kMaxDistance_ns};
    StampedCovariance best{.t = pose.t};
    std::int64_t distance_ns = kMaxDistance_ns;
    for (auto row = std::ranges::lower_bound(table.rows, begin, {}, &StampedCovariance::t);
         row != table.rows.end() && row->t.ns < pose.t.ns + kMaxDistance_ns; ++row) {
      if (std::abs(row->t.ns - pose.t.ns) >= distance_ns) continue;
      distance_ns = std::abs(row->t.ns - pose.t.ns);
      best = *row;
    }
    if (table.rotation_of_body) {
      const Eigen::Matrix3d R = pose.T_w_f.R();
      best.rotation = Eigen::Matrix3d(R * best.rotation * R.transpose());
    }
    result.push_back(best);
  }
  return result;
}

}  // namespace stillpoint::eval
