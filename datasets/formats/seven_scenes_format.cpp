// SPDX-License-Identifier: BSD-3-Clause
/// Microsoft 7-Scenes (Shotton et al., CVPR 2013): `frame-000000.{color.png,depth.png,pose.txt}`.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "eval/io/matrix_files.h"

namespace stillpoint::datasets {
namespace {

constexpr std::uint16_t kNoDepth = 65535;

/// The dataset provides only the focal length of the depth camera, and its poses are those of the depth
/// camera. The color camera is 23 mm beside it. Its calibration was estimated on "redkitchen", frames 0-399,
/// without using the ground-truth poses. Focal length, distortion, rotation and baseline maximize the
/// alignment of depth discontinuities with edges of the color images (this cannot separate the principal
/// point from a rotation). Principal point and rolling-shutter readout time (0.76 of the frame interval)
/// minimize the reprojection error of corners tracked over 5 to 15 frames, with registered depth and one
/// estimated motion per frame pair. Kinects differ slightly from each other; a rig.toml overrides these
/// values.
constexpr Camera kDepthCamera{.width = 640,
                              .height = 480,
                              .fx = 585.0,
                              .fy = 585.0,
                              .cx = 320.0,
                              .cy = 240.0,
                              .model = CameraModel::kRadialTangential,
                              .distortion = {}};
constexpr Camera kColorCamera{.width = 640,
                              .height = 480,
                              .fx = 527.5,
                              .fy = 527.5,
                              .cx = 315.0,
                              .cy = 240.0,
                              .model = CameraModel::kRadialTangential,
                              .distortion = {0.0, -0.068}};
constexpr double kRollingShutter_s = 0.0253;

/// Depth camera to color camera.
Pose depth_to_color() { return Pose{exp_so3({0.0035, 0.0083, 0.0085}), {-0.023, -0.0005, 0.0}}; }

struct NumberedFrame {
  std::int64_t number = 0;
  std::filesystem::path color;
};

/// The frame number in the file name of a color image; empty for other files.
std::optional<std::int64_t> frame_number(const std::string& name) {
  const std::optional<std::int64_t> number = eval::seven_scenes_number(name, ".color.png");
  return number ? number : eval::seven_scenes_number(name, ".color.jpg");
}

std::vector<NumberedFrame> list_frames(const std::filesystem::path& folder) {
  std::vector<NumberedFrame> frames;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::optional<std::int64_t> number = frame_number(entry.path().filename().string());
    if (number) frames.push_back(NumberedFrame{.number = *number, .color = entry.path()});
  }
  std::sort(frames.begin(), frames.end(),
            [](const NumberedFrame& a, const NumberedFrame& b) { return a.number < b.number; });
  return frames;
}

void add_frame(const std::filesystem::path& color, Timestamp t, SequenceContent& content, FaultLog& faults) {
  const std::string name = color.filename().string();
  const std::filesystem::path stem = color.parent_path() / name.substr(0, name.find('.'));
  if (!content.info.frame_times.empty() && content.info.frame_times.back() == t) {
    throw InputError(color.string(), "the frame exists both as PNG and as JPEG; remove one of them");
  }
  content.info.frame_times.push_back(t);
  content.frame_files.push_back(FrameFiles{.color = color, .depth = stem.string() + ".depth.png"});
  const std::filesystem::path pose = stem.string() + ".pose.txt";
  if (!std::filesystem::exists(pose)) return;
  faults.guard([&] {
    content.info.ground_truth.trajectory.poses.push_back(
        StampedPose{t, *eval::read_pose_matrix(pose, eval::PoseCheck::kGroundTruth)});
  });
}

void set_seven_scenes_calibration(SequenceContent& content) {
  content.info.rig.camera = kColorCamera;
  content.info.rig.rolling_shutter_s = kRollingShutter_s;
  content.info.depth_camera = DepthCamera{.camera = kDepthCamera, .T_c_d = depth_to_color()};
  content.info.ground_truth.T_c_f = depth_to_color();
  content.info.notes.emplace_back(
      "calibration: that of 7-Scenes; depth (585 px) is registered to the color camera (527.5 px, baseline "
      "23 mm), "
      "unless a rig.toml sets [camera]");
}

SequenceContent read_seven_scenes(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  content.info.ground_truth.trajectory.frame = "depth_camera";
  const std::vector<NumberedFrame> frames = list_frames(folder);
  std::vector<std::int64_t> numbers;
  for (const NumberedFrame& frame : frames) numbers.push_back(frame.number);
  const std::vector<Timestamp> times = times_of_frames(numbers, folder, NumberMeaning::kFrame);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    faults.guard([&] { add_frame(frames[i].color, times[i], content, faults); });
  }
  if (content.frame_files.empty()) throw InputError(folder.string(), "contains no frame-N.color.png or .jpg");
  set_seven_scenes_calibration(content);
  content.no_depth_value = kNoDepth;
  content.info.notes.emplace_back("timestamps: frame number / 30 s, as the frames have none");
  return content;
}

bool recognize_seven_scenes(const std::filesystem::path& folder) { return !list_frames(folder).empty(); }

}  // namespace

const SequenceFormat kSevenScenesFormat{.name = "7scenes",
                                        .signature = "frame-N.color.png or .jpg",
                                        .recognize = recognize_seven_scenes,
                                        .read = read_seven_scenes};

}  // namespace stillpoint::datasets
