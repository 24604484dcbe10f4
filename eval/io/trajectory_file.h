// SPDX-License-Identifier: BSD-3-Clause
/// Reads trajectories of all supported formats, and writes those with one pose per row (s or ns, m):
///   TUM RGB-D benchmark   `t[s] tx ty tz qx qy qz qw`
///   EuRoC MAV CSV         `t[ns], px, py, pz, qw, qx, qy, qz`
/// A header line that names the columns overrides their order and the unit of the stamps, see
/// column_header.h. Other lines that begin with '#' and further columns (velocity, biases) are ignored;
/// fields are separated by spaces, tabs, commas or semicolons; quaternions are normalized. The readers of the
/// other formats use `parse_pose` and `TrajectoryBuilder`, too. Bags of ROS 1 and ROS 2 are only recognized
/// here; `stillpoint eval` reads their poses as BAG:/TOPIC.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/fields.h"
#include "core/types/trajectory.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {

/// Numbers of rows of a trajectory file that were skipped or moved. The ground truth of TUM fr2 and of EuRoC
/// V1_02 repeats stamps; systems with several threads write poses out of order.
struct RowRepairs {
  std::size_t skipped = 0;    ///< without a pose: not finite, the quaternion 0 0 0 0, or no chain of /tf
  std::size_t repeated = 0;   ///< with the stamp of an earlier row, which is used instead
  std::size_t reordered = 0;  ///< up to `kMaxDisorder_s` earlier than a row before them; sorted by time
  std::size_t unstamped = 0;  ///< of a bag, with the stamp 0; the time of their recording is used
  /// Why rows of this format are skipped.
  std::string_view skip_reason = "NaN or a zero quaternion";
};

/// Rows that are further from their place by time are an error: the file may contain several runs.
inline constexpr double kMaxDisorder_s = 1.0;

/// One sentence for each kind of repair, without a full stop; empty if there are none.
[[nodiscard]] std::vector<std::string> repair_texts(const RowRepairs& repairs);

enum class QuaternionOrder { kXyzw, kWxyz };

/// How certain the order of the columns of the quaternions is.
enum class OrderSource {
  kNone,     ///< the file has no such columns (matrices, bags)
  kNamed,    ///< by the names in the header
  kFormat,   ///< by the definition of the format
  kAssumed,  ///< nothing in the file tells
};

enum class TrajectoryFormat { kTum, kEuroc, kKitti, kOpenloris, kSevenScenes, kNmea };
constexpr auto enum_names(TrajectoryFormat) {
  return EnumNames<TrajectoryFormat, 6>{{{TrajectoryFormat::kTum, "tum"},
                                         {TrajectoryFormat::kEuroc, "euroc"},
                                         {TrajectoryFormat::kKitti, "kitti"},
                                         {TrajectoryFormat::kOpenloris, "openloris"},
                                         {TrajectoryFormat::kSevenScenes, "7scenes"},
                                         {TrajectoryFormat::kNmea, "nmea"}}};
}

/// Contents of a trajectory file.
struct LoadedTrajectory {
  Trajectory trajectory;
  RowRepairs repairs;
  QuaternionOrder order = QuaternionOrder::kXyzw;  ///< in which the file was read
  OrderSource order_source = OrderSource::kNone;
  std::optional<TrajectoryFormat> format = std::nullopt;  ///< of `read_trajectory`; nullopt of other readers
};

/// The trajectory as if its quaternions had been read in the other order.
[[nodiscard]] Trajectory with_other_order(const Trajectory& trajectory, QuaternionOrder read);

/// Whether the path is a bag by its name: a file .bag, .mcap or .db3, a folder with metadata.yaml and one of
/// these files, as `ros2 bag` writes it, or a folder with the parts of a split bag of ROS 1.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

/// The parts of a bag that `rosbag record --split` wrote, in their order: NAME_0.bag, NAME_1.bag ..., with or
/// without the dates of their beginnings before the numbers. They are all bags of the folder, which has no
/// subfolders, unlike an extracted dataset.
/// @return two or more; empty for any other path
[[nodiscard]] std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& folder);

struct TrajectorySource {
  std::filesystem::path path;
  std::optional<TrajectoryFormat> format = std::nullopt;  ///< nullopt: detected from the content
  std::filesystem::path times = {};                       ///< file with the time stamps, for KITTI
  int sequence = 0;                                       ///< sequence number, for OpenLORIS; 0: the only one
};

/// Reads a trajectory. Format detection: a folder is 7-Scenes; a file that begins with a sentence is NMEA; a
/// file with a "key: value" line is OpenLORIS; a header that names stamps in nanoseconds, or a stamp with 16
/// digits or more, is EuRoC; rows of 12 numbers without a header are KITTI, unless the fifth to the eighth
/// are a quaternion and the first eleven no matrix; other rows are TUM. Rows with nanoseconds and without a
/// header are written with qw first and commas by EuRoC tools, and with qx first and blanks by ORB-SLAM3: the
/// order follows from the separator, and is marked as assumed. So is that of TUM rows with commas:
/// VINS-Fusion writes qw first.
/// @throws InputError for unreadable or malformed input, KITTI without times, or several sequences without a
/// sequence number
[[nodiscard]] LoadedTrajectory read_trajectory(const TrajectorySource& source);

/// The format of a text by the rules of `read_trajectory`.
/// @param text contents of the file
/// @param name of the file, for messages
/// @throws InputError if the header names a unit of stamps that no format has
[[nodiscard]] TrajectoryFormat detect_format(std::string_view text, const std::string& name = "");

/// Reads an estimated trajectory. Rows without a pose and rows that repeat a stamp are skipped, rows that are
/// slightly out of order are sorted; all are counted.
/// @param file path of the file
/// @param frame name of the body frame of the poses
/// @throws InputError with file:line for a malformed row or a stamp more than `kMaxDisorder_s` earlier than
/// one before it; with the file name if it is unreadable or has no poses
[[nodiscard]] LoadedTrajectory read_tum(const std::filesystem::path& file, const std::string& frame = "");

/// The same for a text in memory.
/// @param text contents of the file
/// @param name of the file, for error messages
/// @param frame name of the body frame of the poses
[[nodiscard]] LoadedTrajectory parse_tum(std::string_view text, const std::string& name,
                                         const std::string& frame = "");
[[nodiscard]] LoadedTrajectory parse_euroc(std::string_view text, const std::string& name);

/// Reads the ground truth of a dataset: like `read_tum`, but a row without a pose or with a quaternion whose
/// norm differs from 1 by more than 0.01 is a fault, too.
/// @param file path of the file
/// @param frame name of the body frame of the poses
/// @param faults throws at the first fault, or collects the faults of all rows
[[nodiscard]] LoadedTrajectory read_tum_ground_truth(const std::filesystem::path& file,
                                                     const std::string& frame, FaultLog& faults);
[[nodiscard]] LoadedTrajectory read_euroc_ground_truth(const std::filesystem::path& file,
                                                       const std::string& frame, FaultLog& faults);

/// Writes a TUM trajectory with 9 decimals and a header line with the names of the columns.
/// @throws InputError if the file cannot be written
void write_tum(const Trajectory& trajectory, const std::filesystem::path& file);

/// The text that `write_tum` writes.
[[nodiscard]] std::string format_tum(const Trajectory& trajectory);

/// The trajectory in the EuRoC format with 9 decimals, without velocities and biases.
[[nodiscard]] std::string format_euroc(const Trajectory& trajectory);

/// Which rows are accepted.
enum class PoseCheck {
  kEstimate,     ///< the norm of the quaternion is within 0.1 of 1; a row without a pose is skipped
  kGroundTruth,  ///< the norm of the quaternion is within 0.01 of 1; every row must be a pose
};

/// Columns of tx ty tz qx qy qz qw.
using PoseColumns = std::array<std::size_t, 7>;

/// Seven columns from `first` on: position, then quaternion.
[[nodiscard]] PoseColumns consecutive_columns(std::size_t first, QuaternionOrder order);

/// Parses a pose and normalizes its quaternion.
/// @return nullopt if the row has no pose (a value that is not finite, or a zero quaternion) and may be
/// skipped
/// @throws InputError if a field is not a number, the quaternion is not a rotation, or a coordinate exceeds
/// 1e9 m
[[nodiscard]] std::optional<Pose> parse_pose(const TextRow& row, const PoseColumns& columns,
                                             PoseCheck check = PoseCheck::kEstimate);

/// Collects the poses of a file in order of time.
class TrajectoryBuilder {
 public:
  /// @param rows an estimate of their number: memory that grows is copied, and takes twice as much meanwhile
  explicit TrajectoryBuilder(std::size_t rows = 0) { loaded_.trajectory.poses.reserve(rows); }

  /// Adds the pose of a row. A row without a pose, and one with the stamp of an earlier row, is counted and
  /// skipped; one that is up to `kMaxDisorder_s` earlier than the latest pose is counted and sorted in.
  /// @throws InputError if it is even earlier
  void add(const TextRow& row, Timestamp t, const std::optional<Pose>& pose);

  [[nodiscard]] bool is_empty() const { return loaded_.trajectory.poses.empty(); }

  /// @param file its name, for messages
  /// @throws InputError if no pose was added
  void require_poses(const std::string& file) const;

  /// @param file with the stamps, for messages
  /// @throws InputError if half of the poses are further than an hour from the next one, or there are more
  /// than five rows per stamp
  void require_plausible_stamps(const std::string& file) const;

  [[nodiscard]] LoadedTrajectory release() { return std::move(loaded_); }

 private:
  void sort_in(const TextRow& row, const StampedPose& pose);

  LoadedTrajectory loaded_;
};

}  // namespace stillpoint::eval
