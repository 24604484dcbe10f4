// SPDX-License-Identifier: BSD-3-Clause
/// TUM RGB-D benchmark (Sturm et al., IROS 2012) and folders with the same layout.
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

constexpr double kTumDepthUnitsPerM = 5000.0;

/// Names of folders of the Bonn RGB-D Dynamic dataset contain this.
constexpr std::string_view kBonn = "rgbd_bonn";

/// Color camera of one of the three Kinects of the benchmark, or of a dataset in its layout.
struct KinectCalibration {
  std::string_view name;
  Camera camera;
};

/// The first three: from the page "File Formats" of the benchmark, section on intrinsic calibration (not the
/// ROS default; the published depth images are already scale-corrected).
const std::array<KinectCalibration, 4>& kinects() {
  static const std::array<KinectCalibration, 4> kAll{
      {{"freiburg1",
        {.width = 640,
         .height = 480,
         .fx = 517.3,
         .fy = 516.5,
         .cx = 318.6,
         .cy = 255.3,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}}},
       {"freiburg2",
        {.width = 640,
         .height = 480,
         .fx = 520.9,
         .fy = 521.0,
         .cx = 325.1,
         .cy = 249.7,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}}},
       {"freiburg3",
        {.width = 640,
         .height = 480,
         .fx = 535.4,
         .fy = 539.2,
         .cx = 320.1,
         .cy = 247.6,
         .model = CameraModel::kRadialTangential,
         .distortion = {}}},
       {kBonn,  // Palazzolo et al., IROS 2019
        {.width = 640,
         .height = 480,
         .fx = 542.822841,
         .fy = 542.576870,
         .cx = 315.593520,
         .cy = 237.756098,
         .model = CameraModel::kRadialTangential,
         .distortion = {0.039903, -0.099343, -0.000730, -0.000144, 0.0}}}}};
  return kAll;
}

void set_calibration(SequenceContent& content) {
  Rig& rig = content.info.rig;
  rig.depth_units_per_m = kTumDepthUnitsPerM;
  for (const KinectCalibration& kinect : kinects()) {
    if (content.info.name.find(kinect.name) == std::string::npos) continue;
    rig.camera = kinect.camera;
    content.info.notes.push_back("calibration: published values of " + std::string(kinect.name));
    return;
  }
  content.missing_calibration =
      "the folder name contains none of freiburg1, freiburg2, freiburg3, rgbd_bonn, whose cameras are known";
}

void add_imu(SequenceContent& content, FaultLog& faults) {
  const std::filesystem::path txt = content.info.folder / "imu.txt";
  const std::filesystem::path csv = content.info.folder / "imu.csv";
  if (std::filesystem::exists(txt)) {
    content.info.imu = read_imu_file(txt, eval::TimeUnit::kSeconds, faults);
  } else if (std::filesystem::exists(csv)) {
    content.info.imu = read_imu_file(csv, eval::TimeUnit::kNanoseconds, faults);
  } else {
    return;
  }
  content.info.rig.has_imu = true;
  content.extrinsic_known = false;
  content.info.notes.emplace_back(
      "imu: default noise densities, unless a rig.toml sets [imu] gyro_noise etc.");
}

constexpr double kMaxFrameNumber = 1e7;   // larger numbers are stamps
constexpr double kMinNanoseconds = 1e15;  // larger numbers are no seconds

/// Whether the first row of associate.py begins with a time; ICL-NUIM has frame numbers there.
bool has_stamps(const std::filesystem::path& associations) {
  if (!std::filesystem::is_regular_file(associations)) return false;
  const std::string text = eval::read_text_file(associations);
  eval::RowReader rows(text, "");
  const std::optional<eval::TextRow> row = rows.next();
  if (!row || row->fields.size() < 4) return false;
  const std::optional<double> first = eval::parse_number(row->fields[0]);
  return first && (*first > kMaxFrameNumber || row->fields[0].find('.') != std::string_view::npos);
}

Timestamp association_time(const eval::TextRow& row, std::size_t field) {
  const bool is_ns = row.finite_number(field) > kMinNanoseconds;
  return row.time(field, is_ns ? eval::TimeUnit::kNanoseconds : eval::TimeUnit::kSeconds);
}

/// Rows `stamp image stamp image` as associate.py writes them. Rows
/// whose images are not less than 20 ms apart are dropped, as by `pair_images`.
PairedImages read_associations(const std::filesystem::path& file, FaultLog& faults) {
  const std::string text = eval::read_text_file(file);
  const std::string name = file.string();
  PairedImages images;
  eval::for_each_row(text, name, faults, [&](const eval::TextRow& row) {
    const std::size_t color = color_stamp_column(row);
    const std::size_t depth = 2 - color;
    const Timestamp t = association_time(row, color);
    const double depth_offset_s = seconds_between(t, association_time(row, depth));
    ++images.color_images;
    if (std::abs(depth_offset_s) >= kImageAssociation.max_difference_s) return;
    if (!images.times.empty()) row.require_increasing(images.times.back(), t);
    images.times.push_back(t);
    images.files.push_back(FrameFiles{.color = listed_image(file.parent_path(), row.text(color + 1)),
                                      .depth = listed_image(file.parent_path(), row.text(depth + 1)),
                                      .depth_offset_s = depth_offset_s});
  });
  if (images.color_images == 0) throw InputError(name, "lists no images; is the sequence complete?");
  if (images.times.empty())
    throw InputError(name,
                     "no depth image is less than 20 ms from its color image; pair the images again, or "
                     "correct the stamps if the clocks of both cameras differ");
  return images;
}

/// Without the lists of all images, those of associate.py.
PairedImages read_images(const std::filesystem::path& folder, FaultLog& faults) {
  const bool has_lists =
      std::filesystem::exists(folder / "rgb.txt") && std::filesystem::exists(folder / "depth.txt");
  if (!has_lists && std::filesystem::exists(associations_file(folder)))
    return read_associations(associations_file(folder), faults);
  // The lists of the Bonn dataset name images that its archives lack.
  const bool is_bonn = folder.filename().string().find(kBonn) != std::string::npos;
  return pair_images(folder / "rgb.txt", folder / "depth.txt", faults,
                     is_bonn ? MissingImages::kDrop : MissingImages::kKeep);
}

SequenceContent read_tum(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  content = with_frames(std::move(content), read_images(folder, faults));
  set_calibration(content);
  add_imu(content, faults);
  if (std::filesystem::exists(folder / "groundtruth.txt")) {
    content = with_ground_truth(std::move(content),
                                eval::read_tum_ground_truth(folder / "groundtruth.txt", "camera", faults));
  }
  return content;
}

bool recognize_tum(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "rgb.txt") || has_stamps(associations_file(folder));
}

}  // namespace

const SequenceFormat kTumFormat{.name = "tum",
                                .signature = "rgb.txt, or associations.txt with stamps",
                                .recognize = recognize_tum,
                                .read = read_tum};

}  // namespace stillpoint::datasets
