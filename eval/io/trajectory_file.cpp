// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/trajectory_file.h"

#include <cstdio>

#include "core/base/error.h"
#include "eval/io/pose_row.h"
#include "eval/io/text_reader.h"
#include "eval/io/text_table.h"

namespace stillpoint::eval {
namespace {

/// A format with one pose per row: the stamp, then the pose.
struct RowFormat {
  TimeUnit unit;
  QuaternionOrder order;
  const char* columns;  ///< for messages
};
constexpr RowFormat kTum{TimeUnit::kSeconds, QuaternionOrder::kXyzw, "t tx ty tz qx qy qz qw"};
constexpr RowFormat kEuroc{TimeUnit::kNanoseconds, QuaternionOrder::kWxyz, "ns,px,py,pz,qw,qx,qy,qz"};

/// A text and the name of its file.
struct NamedText {
  std::string_view text;
  const std::string& name;
};

LoadedTrajectory parse_rows(const NamedText& source, const RowFormat& format, PoseCheck check,
                            FaultLog& faults) {
  TrajectoryBuilder builder;
  for_each_row(source.text, source.name, faults, [&](const TextRow& row) {
    if (row.fields.size() < 8) {
      throw row.error("a pose needs 8 numbers, found " + std::to_string(row.fields.size()) + "; expected \"" +
                      format.columns + "\"");
    }
    const Timestamp t = row.time(0, format.unit);
    builder.add(row, t, parse_pose(row, {.first = 1, .order = format.order, .check = check}));
  });
  faults.guard([&] { builder.require_poses(source.name); });
  return builder.release();
}

/// A ground-truth file.
struct TruthFile {
  const std::filesystem::path& path;
  const RowFormat& format;
  const std::string& frame;
};

LoadedTrajectory read_ground_truth(const TruthFile& file, FaultLog& faults) {
  const std::string text = read_text_file(file.path);
  const std::string name = file.path.string();
  LoadedTrajectory loaded = parse_rows({text, name}, file.format, PoseCheck::kGroundTruth, faults);
  loaded.trajectory.frame = file.frame;
  return loaded;
}

std::string rows_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " row" : " rows"); }

}  // namespace

std::vector<std::string> repair_texts(const RowRepairs& repairs) {
  std::vector<std::string> texts;
  if (repairs.skipped > 0) {
    texts.push_back(rows_text(repairs.skipped) + " skipped: no valid pose (nan, or a zero quaternion)");
  }
  if (repairs.repeated > 0) {
    texts.push_back(rows_text(repairs.repeated) +
                    " skipped: the time stamp repeats that of an earlier row, which is used");
  }
  if (repairs.reordered > 0) {
    texts.push_back(rows_text(repairs.reordered) + " sorted by time: earlier than a row before");
  }
  return texts;
}

LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame) {
  return parse_tum(read_text_file(file), file.string(), frame);
}

LoadedTrajectory parse_tum(std::string_view text, const std::string& name, const std::string& frame) {
  FaultLog strict;
  LoadedTrajectory loaded = parse_rows({text, name}, kTum, PoseCheck::kEstimate, strict);
  loaded.trajectory.frame = frame;
  return loaded;
}

LoadedTrajectory parse_euroc(std::string_view text, const std::string& name) {
  FaultLog strict;
  return parse_rows({text, name}, kEuroc, PoseCheck::kEstimate, strict);
}

LoadedTrajectory read_tum_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                       FaultLog& faults) {
  return read_ground_truth({file, kTum, frame}, faults);
}

LoadedTrajectory read_euroc_ground_truth(const std::filesystem::path& file, const std::string& frame,
                                         FaultLog& faults) {
  return read_ground_truth({file, kEuroc, frame}, faults);
}

void write_tum(const Trajectory& trajectory, const std::filesystem::path& file) {
  write_text_file(file, format_tum(trajectory));
}

std::string format_tum(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  text.reserve(text.size() + 110 * trajectory.poses.size());
  char row[320];
  for (const auto& [t, pose] : trajectory.poses) {
    const int length = std::snprintf(row, sizeof row, " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.p.x(),
                                     pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
    STILLPOINT_CHECK(length > 0 && length < static_cast<int>(sizeof row));
    text += format_stamp(t);
    text.append(row, static_cast<std::size_t>(length));
  }
  return text;
}

std::string format_euroc(const Trajectory& trajectory) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
  char row[360];
  for (const auto& [t, pose] : trajectory.poses) {
    std::snprintf(row, sizeof row, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", static_cast<long long>(t.ns),
                  pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z());
    text += row;
  }
  return text;
}

}  // namespace stillpoint::eval
