// SPDX-License-Identifier: BSD-3-Clause
/// CID-SIMS (Zhang et al., IJRR 2024): RealSense D455 and wheels. color/, depth/ with the time in the file
/// names, imu.txt, pose.txt (camera in world).
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/trajectory/association.h"

namespace stillpoint::datasets {
namespace {

constexpr eval::AssociationOptions kCidAssociation{.max_difference_s = 0.02};
constexpr double kCidDepthUnitsPerM = 1000.0;

/// The images of a folder whose names are times in seconds, sorted by time.
std::vector<StampedFile> stamped_images(const std::filesystem::path& folder) {
  std::vector<StampedFile> images;
  for (const std::filesystem::path& file : visible_files(folder)) {
    const std::optional<Timestamp> t = eval::parse_stamp(file.stem().string());
    if (t && is_image(file)) images.push_back({.t = *t, .file = file});
  }
  std::ranges::sort(images, {}, &StampedFile::t);
  if (images.empty())
    throw InputError(
        folder.string(),
        "contains no image with a name of SECONDS.png or SECONDS.jpg; extract the archive again");
  return images;
}

std::vector<Timestamp> times_in(const std::vector<StampedFile>& images) {
  std::vector<Timestamp> times;
  times.reserve(images.size());
  for (const StampedFile& image : images) times.push_back(image.t);
  return times;
}

void add_cid_frames(SequenceContent& content) {
  const std::vector<StampedFile> color = stamped_images(content.info.folder / "color");
  const std::vector<StampedFile> depth = stamped_images(content.info.folder / "depth");
  for (const auto& [in_depth, in_color] :
       eval::associate_tum(times_in(depth), times_in(color), kCidAssociation)) {
    content.info.frame_times.push_back(color[in_color].t);
    content.frame_files.push_back({.color = color[in_color].file,
                                   .depth = depth[in_depth].file,
                                   .depth_offset_s = seconds_between(color[in_color].t, depth[in_depth].t)});
  }
  if (content.frame_files.empty())
    throw InputError(content.info.folder.string(), "no depth image is less than 20 ms from a color image");
}

/// The file has angular rate before acceleration, or after it. Gravity tells which: its 9.8 m/s^2 exceed the
/// mean rate.
void add_cid_imu(SequenceContent& content, FaultLog& faults) {
  std::vector<ImuSample>& samples = content.info.imu;
  samples = read_imu_file(content.info.folder / "imu.txt", eval::TimeUnit::kSeconds, faults);
  double gyro = 0.0;
  double accel = 0.0;
  for (const ImuSample& sample : samples) {
    gyro += sample.gyro_b.norm();
    accel += sample.accel_b.norm();
  }
  if (gyro > accel) {
    for (ImuSample& sample : samples) std::swap(sample.gyro_b, sample.accel_b);
    content.info.notes.emplace_back("imu.txt: the acceleration is in front of the angular rate");
  }
  content.info.rig.has_imu = true;
  content.extrinsic_known = false;
}

SequenceContent read_cid_sims(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  add_cid_frames(content);
  content.info.rig.depth_units_per_m = kCidDepthUnitsPerM;
  content.missing_calibration =
      "the archives of CID-SIMS have it in a separate file, and it differs between them";
  if (std::filesystem::exists(folder / "imu.txt")) add_cid_imu(content, faults);
  return with_ground_truth(std::move(content),
                           eval::read_tum_ground_truth(folder / "pose.txt", "camera", faults));
}

bool recognize_cid_sims(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth") &&
         std::filesystem::exists(folder / "pose.txt");
}

}  // namespace

const SequenceFormat kCidSimsFormat{.name = "cid-sims",
                                    .signature = "color/, depth/ and pose.txt",
                                    .recognize = recognize_cid_sims,
                                    .read = read_cid_sims};

}  // namespace stillpoint::datasets
