// SPDX-License-Identifier: BSD-3-Clause
/// The files that `stillpoint eval` and `trajectory` read: their formats, covariances and orders of
/// quaternions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/compare/conventions.h"
#include "eval/io/covariance_file.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {

/// Files as the user names them.
struct PoseFilePaths {
  std::string ground_truth;            ///< a file, BAG:/TOPIC, sequence folder, preset or folder of a run
  std::vector<std::string> estimates;  ///< files, BAG:/TOPIC or folders of runs
  std::vector<std::string> formats;    ///< "nmea" of all, "gt=nmea" and "est=tum" of one; else detected
  std::string times;                   ///< of a KITTI trajectory; empty without
  int sequence = 0;                    ///< in an OpenLORIS file; 0 for the only one
  std::string covariance;              ///< of the estimate; empty for further columns, or messages of a bag
};

/// A file of poses, and its path as the user wrote it.
struct PoseFile {
  std::string path;
  eval::LoadedTrajectory loaded;
  std::optional<eval::CovarianceTable> covariances = std::nullopt;  ///< of an estimate
};

/// Reads the ground truth, and meanwhile the estimates: for long files, reading is most of the work. Skipped
/// and sorted rows are logged.
/// @return the ground truth first
/// @throws InputError of the first file with a problem, for one covariance file and several estimates, or for
/// times or a sequence number that no file needs
[[nodiscard]] std::vector<PoseFile> read_pose_files(const PoseFilePaths& paths);

enum class FileRole { kTruth, kEstimate };

/// Reads one file; an estimate with its covariances. Skipped and sorted rows, and an order of quaternions
/// that nothing states, are logged.
/// @throws InputError for unreadable or malformed input, or for times or a sequence number that an estimate
/// does not need
[[nodiscard]] PoseFile read_pose_file(const PoseFilePaths& paths, const std::string& path, FileRole role);

/// The files, ground truth first, with their quaternions in the order in which they are consistent.
/// @throws InputError if that contradicts the format or the header of one, or another estimate
[[nodiscard]] std::vector<PoseFile> with_consistent_orders(std::vector<PoseFile> files, double offset_s);

}  // namespace stillpoint::bench
