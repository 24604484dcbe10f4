// SPDX-License-Identifier: BSD-3-Clause
/// The header line of a table, and the columns of stamps, poses and inertial samples by the names in it, as
/// datasets, systems and ROS tools write them: `#timestamp [ns],p_RS_R_x [m],...,q_RS_w []`,
/// `ts (ns),tx (m),...,qw`, `timestamp tx ty tz qx qy qz qw`, `pose.orientation.x`, `w_RS_S_x [rad s^-1]`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/io/text_reader.h"

namespace stillpoint::eval {

/// The names and units of the columns, in lower case.
struct TableHeader {
  struct Column {
    std::string name;
    std::string unit;  ///< in brackets after the name; empty if there is none
  };

  long line = 0;            ///< counted from 1; 0 if the text has no header
  bool is_comment = false;  ///< begins with "#"
  std::vector<Column> columns;
};

/// The header of a text: a line without a number in front of the first row, or the last comment in front of
/// it that names a time and a position or an angular velocity.
/// @param text contents of the file
/// @return without columns if there is no such line
[[nodiscard]] TableHeader find_header(std::string_view text);

/// Vectors that the columns of a table may have.
enum class Quantity { kPosition, kQuaternion, kAngularVelocity, kAcceleration };

/// Where the time stamps of a table are: in one column, or in one of whole seconds and one of the rest
/// ("header.stamp.secs", "header.stamp.nsecs"; "tv_sec", "tv_usec").
struct TimeColumns {
  std::size_t stamp = 0;            ///< or the whole seconds
  std::optional<std::size_t> rest;  ///< nanoseconds or microseconds since the whole second
  std::int64_t rest_unit_ns = 1;
};

/// The columns of time stamps: those of the message header (`field.header.stamp`) rather than those of the
/// reception (`%time` of rostopic), else two of equal names but for the unit, else the first.
/// @return nullopt without one, or if it is not clear how columns of seconds and nanoseconds are related
[[nodiscard]] std::optional<TimeColumns> time_columns(const TableHeader& header);

/// The stamp of a row.
/// @param row     of the table
/// @param columns where its stamps are
/// @param unit    of a stamp in one column
/// @throws InputError with file and line as `TextRow::time`; if the seconds are not whole, or the rest is a
/// second or more
[[nodiscard]] Timestamp stamp_of(const TextRow& row, const TimeColumns& columns, TimeUnit unit);

/// Unit of the column of time stamps: in brackets behind its name, or the last word of the name ("time_ns",
/// "timestamp_nanoseconds"); seconds of two columns.
/// @param header of the file
/// @param file name of the file, for messages
/// @return nullopt if the header states none
/// @throws InputError for milliseconds and microseconds
[[nodiscard]] std::optional<TimeUnit> time_unit(const TableHeader& header, std::string_view file);

/// Indices of the columns x, y, z of a vector, w of the quaternion behind them.
/// @return empty unless the header names each exactly once
[[nodiscard]] std::vector<std::size_t> columns_of(const TableHeader& header, Quantity quantity);

/// Whether the header names roll, pitch and yaw.
[[nodiscard]] bool names_euler_angles(const TableHeader& header);

/// Unit of the first column of a vector; empty if the header states none, or does not name the vector.
[[nodiscard]] std::string unit_of(const TableHeader& header, Quantity quantity);

/// Whether the columns of the header are those of the rows: as many, or beginning with the time, as the rows
/// may have further columns.
/// @param header as found in `text`
/// @param text contents of the file
[[nodiscard]] bool fits_rows(const TableHeader& header, std::string_view text);

}  // namespace stillpoint::eval
