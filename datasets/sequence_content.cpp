// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_content.h"

#include <algorithm>

#include "core/base/error.h"
#include "datasets/detections_file.h"
#include "datasets/formats/formats.h"
#include "datasets/image_io.h"
#include "datasets/rig_file.h"

namespace stillpoint {
namespace {

const SequenceFormat& find_format(const std::filesystem::path& folder, const std::string& wanted) {
  std::string names;
  std::string marks;
  for (const SequenceFormat* const format : sequence_formats()) {
    if (wanted.empty() ? format->recognise(folder) : format->name == wanted) return *format;
    names += (names.empty() ? "" : ", ") + std::string(format->name);
    marks += "; " + std::string(format->name) + " has " + std::string(format->mark);
  }
  if (!wanted.empty()) throw InputError("format \"" + wanted + "\"", "is not known; known are " + names);
  throw InputError(folder.string(), "is no sequence of a known format" + marks);
}

/// The folder without a trailing slash or dot, so that it has a name.
std::filesystem::path named_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw InputError(folder.string(), "no such folder");
  }
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

void override_rig(SequenceContent& content, const std::filesystem::path& wanted) {
  const std::filesystem::path own = content.info.folder / "rig.toml";
  const std::filesystem::path file = wanted.empty() && std::filesystem::exists(own) ? own : wanted;
  if (!file.empty()) {
    const OverriddenRig overridden = apply_rig_file(file, content.info.rig);
    content.info.rig = overridden.rig;
    content.extrinsic_known |= overridden.has_extrinsic;
    content.info.notes.push_back("calibration: overridden by " + file.string());
  } else if (!content.calibration_assumed.empty()) {
    content.info.notes.push_back(content.calibration_assumed);
  }
}

void check_rig(const SequenceContent& content) {
  const Camera& camera = content.info.rig.camera;
  const std::string folder = content.info.folder.string();
  if (camera.width <= 0 || camera.height <= 0 || camera.fx <= 0.0 || camera.fy <= 0.0) {
    throw InputError(
        folder,
        "the camera's calibration is unknown; add a rig.toml with [camera] width, height, fx, fy, cx, cy");
  }
  if (content.info.rig.has_imu && !content.extrinsic_known) {
    throw InputError(
        folder, "has inertial data but nothing says where the IMU sits; add a rig.toml with [imu] T_b_c");
  }
}

std::string span_text(Timestamp first, Timestamp last) {
  return std::to_string(to_seconds(first)) + " to " + std::to_string(to_seconds(last)) + " s";
}

void require_overlap(const SequenceInfo& info, const std::string& what, Timestamp first, Timestamp last) {
  if (first <= info.frame_times.back() && last >= info.frame_times.front()) return;
  throw InputError(info.folder.string(), what + " covers " + span_text(first, last) + ", the pictures " +
                                             span_text(info.frame_times.front(), info.frame_times.back()) +
                                             ": no overlap in time; are they of one recording?");
}

void check_overlap(const SequenceInfo& info, FaultLog& faults) {
  const std::vector<StampedPose>& truth = info.ground_truth.trajectory.poses;
  faults.guard([&] {
    if (!info.imu.empty()) require_overlap(info, "the IMU", info.imu.front().t, info.imu.back().t);
  });
  faults.guard([&] {
    if (!truth.empty()) require_overlap(info, "the ground truth", truth.front().t, truth.back().t);
  });
}

void require_size(const std::filesystem::path& file, const cv::Mat& picture, const Camera& camera) {
  if (picture.cols == camera.width && picture.rows == camera.height) return;
  throw InputError(file.string(), "is " + std::to_string(picture.cols) + "x" + std::to_string(picture.rows) +
                                      " where the calibration says " + std::to_string(camera.width) + "x" +
                                      std::to_string(camera.height) + "; correct [camera] in rig.toml");
}

cv::Mat load_depth(const SequenceContent& content, const std::filesystem::path& file) {
  cv::Mat depth = read_depth(file);
  const Rig& rig = content.info.rig;
  require_size(file, depth, content.depth_camera ? content.depth_camera->camera : rig.camera);
  if (content.no_depth_value != 0) {
    std::replace(depth.begin<std::uint16_t>(), depth.end<std::uint16_t>(), content.no_depth_value,
                 std::uint16_t{0});
  }
  if (!content.depth_camera) return depth;
  return register_depth(depth, rig.depth_units_per_m, *content.depth_camera, rig.camera);
}

/// Pictures on disk, decoded when asked for.
class FolderStream : public SensorStream {
 public:
  explicit FolderStream(SequenceContent content) : content_(std::move(content)) {}
  [[nodiscard]] const SequenceInfo& info() const override { return content_.info; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override { return decode_frame(content_, index); }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    const std::filesystem::path& folder = content_.info.folder;
    const std::filesystem::path picture = content_.pictures[index].color.filename();
    for (const char* kind : {"labels", "motion"}) {
      if (!std::filesystem::exists(folder / kind / picture)) return std::nullopt;
    }
    return MotionLabels{.object = read_picture(folder / "labels" / picture),
                        .speed_cm_per_s = read_picture(folder / "motion" / picture)};
  }

 private:
  SequenceContent content_;
};

std::vector<DetectionSet> boxes_if_there(const std::filesystem::path& file, FaultLog& faults) {
  return std::filesystem::exists(file) ? read_detections(file, faults) : std::vector<DetectionSet>{};
}

}  // namespace

SequenceContent read_sequence(const std::filesystem::path& folder, const OpenOptions& options,
                              FaultLog& faults) {
  const std::filesystem::path whole = named_folder(folder);
  const SequenceFormat& format = find_format(whole, options.format);
  SequenceContent content = format.read(whole, faults);
  content.info.format = format.name;
  content.info.detections = boxes_if_there(whole / "detections.txt", faults);
  content.info.true_boxes = boxes_if_there(whole / "true_boxes.txt", faults);
  override_rig(content, options.rig_file);
  check_rig(content);
  check_overlap(content.info, faults);
  return content;
}

Frame decode_frame(const SequenceContent& content, std::size_t index) {
  STILLPOINT_CHECK(index < content.pictures.size());
  const PictureFiles& files = content.pictures[index];
  const cv::Mat picture = read_picture(files.color);
  require_size(files.color, picture, content.info.rig.camera);
  Frame frame;
  frame.id = static_cast<std::int64_t>(index);
  frame.t = content.info.frame_times[index];
  frame.gray = to_gray(picture);
  if (picture.channels() == 3) frame.color = picture;
  if (!files.depth.empty()) frame.depth = load_depth(content, files.depth);
  frame.depth_units_per_m = content.info.rig.depth_units_per_m;
  return frame;
}

std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder, const OpenOptions& options) {
  FaultLog strict;
  return std::make_unique<FolderStream>(read_sequence(folder, options, strict));
}

}  // namespace stillpoint
