// SPDX-License-Identifier: BSD-3-Clause
/// ICL-NUIM (Handa et al., ICRA 2014), the archives in the layout of TUM RGB-D: rgb/, depth/,
/// associations.txt.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "eval/io/matrix_files.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kIclDepthUnitsPerM = 5000.0;
constexpr std::string_view kIclTruth = ".freiburg";  ///< extension of the ground truth

/// Published with fy = -480: the y axis of the published camera and poses points up. With images whose rows
/// go down and fy = 480, the camera frame c' is mirrored: p_c' = F p_c, F = diag(1, -1, 1).
constexpr Camera kIclCamera{.width = 640,
                            .height = 480,
                            .fx = 481.2,
                            .fy = 480.0,
                            .cx = 319.5,
                            .cy = 239.5,
                            .model = CameraModel::kRadialTangential,
                            .distortion = {}};

/// @param index a frame number, read as a number of seconds
/// @return nullopt unless it is that of a frame
std::optional<Timestamp> time_of_index(Timestamp index) {
  constexpr std::int64_t kOne = 1'000'000'000;
  if (index.ns < 0 || index.ns % kOne != 0 || index.ns / kOne > eval::kMaxFrameNumber) return std::nullopt;
  return eval::time_of_frame(index.ns / kOne);
}

/// Rows `index depth index color`, or color first; the indices are frame numbers.
void add_frame_pairs(SequenceContent& content, FaultLog& faults) {
  const std::filesystem::path& folder = content.info.folder;
  const std::filesystem::path file = associations_file(folder);
  const std::string text = eval::read_text_file(file);
  eval::for_each_row(text, file.string(), faults, [&](const eval::TextRow& row) {
    const std::size_t color = color_stamp_column(row);
    const std::optional<Timestamp> t = time_of_index(row.time(color, eval::TimeUnit::kSeconds));
    if (!t) throw row.error("the index " + std::string(row.fields[color]) + " is no frame number");
    if (!content.info.frame_times.empty()) row.require_increasing(content.info.frame_times.back(), *t);
    content.info.frame_times.push_back(*t);
    content.frame_files.push_back({.color = listed_image(folder, row.fields[color + 1]),
                                   .depth = listed_image(folder, row.fields[3 - color])});
  });
  if (content.frame_files.empty()) throw InputError(file.string(), "contains no images; copy the file again");
}

/// The mirrored pose T_w'_c' = F T_w_c F, a rigid transform.
Pose mirrored(const Pose& T_w_c) {
  const Eigen::Vector3d F(1.0, -1.0, 1.0);
  const Eigen::Quaterniond& q = T_w_c.q;
  // F R F: the rotation axis changes its x and z components.
  return {Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()), F.cwiseProduct(T_w_c.p)};
}

/// `truth` with times instead of the frame numbers.
eval::LoadedTrajectory with_times(eval::LoadedTrajectory truth, const std::filesystem::path& file) {
  for (StampedPose& pose : truth.trajectory.poses) {
    const std::optional<Timestamp> t = time_of_index(pose.t);
    if (!t)
      throw InputError(file.string(), "the stamp " + eval::format_stamp(pose.t) +
                                          " is no frame number, which the images have; write the number of "
                                          "the frame of each pose");
    pose.t = *t;
  }
  return truth;
}

/// livingRoomN.gt.freiburg or trajN.gt.freiburg: rows of TUM with the frame number instead of the time.
std::optional<std::filesystem::path> ground_truth_file(const std::filesystem::path& folder) {
  for (const std::filesystem::path& file : visible_files(folder)) {
    if (file.extension() == kIclTruth) return file;
  }
  const std::filesystem::path file = folder / "groundtruth.txt";
  return std::filesystem::exists(file) ? std::optional(file) : std::nullopt;
}

SequenceContent read_icl(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  add_frame_pairs(content, faults);
  content.info.rig.camera = kIclCamera;
  content.info.rig.depth_units_per_m = kIclDepthUnitsPerM;
  content.info.notes.emplace_back("timestamps: frame number / 30 s, as the frames have none");
  content.info.notes.emplace_back(
      "calibration: that of ICL-NUIM with fy = 480 for the published -480, unless a rig.toml sets [camera]");
  if (const std::optional<std::filesystem::path> file = ground_truth_file(folder)) {
    content = with_ground_truth(std::move(content),
                                with_times(eval::read_tum_ground_truth(*file, "camera", faults), *file));
    if (file->extension() != kIclTruth) {
      content.mirrored_truth = mirrored;  // other recordings have this layout, too
    } else {
      for (StampedPose& pose : content.info.ground_truth.trajectory.poses) pose.T_w_f = mirrored(pose.T_w_f);
      content.info.notes.emplace_back("ground truth: mirrored as the camera of the format");
    }
  }
  return content;
}

bool recognize_icl(const std::filesystem::path& folder) {
  return std::filesystem::exists(associations_file(folder)) && !std::filesystem::exists(folder / "rgb.txt") &&
         std::filesystem::is_directory(folder / "rgb") && std::filesystem::is_directory(folder / "depth");
}

}  // namespace

const SequenceFormat kIclNuimFormat{.name = "icl-nuim",
                                    .signature = "associations.txt, rgb/ and depth/, no rgb.txt",
                                    .recognize = recognize_icl,
                                    .read = read_icl};

}  // namespace stillpoint::datasets
