// SPDX-License-Identifier: BSD-3-Clause
/// Plain image folders: color/NAME.{png,jpg} and depth/NAME.png, pinhole calibration as JSON, no ground
/// truth.
#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "datasets/formats/formats.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kFramesPerSecond = 30;

bool is_image(const std::filesystem::path& file) {
  return file.extension() == ".png" || file.extension() == ".jpg" || file.extension() == ".jpeg";
}

std::vector<std::filesystem::path> sorted_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The file name as a number, so that a missing image results in a gap in time.
std::optional<std::int64_t> number_of(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return number;
}

void add_folder_images(SequenceContent& content) {
  std::int64_t last = -1;
  for (const std::filesystem::path& color : sorted_files(content.info.folder / "color")) {
    if (!is_image(color)) continue;
    const std::int64_t number = number_of(color).value_or(last + 1);
    if (number <= last)
      throw InputError(color.string(),
                       "the numbered file names are not in increasing order; rename the files");
    last = number;
    content.info.frame_times.push_back(
        Timestamp{(number * 1'000'000'000 + kFramesPerSecond / 2) / kFramesPerSecond});
    content.frame_files.push_back(FrameFiles{
        .color = color, .depth = content.info.folder / "depth" / (color.stem().string() + ".png")});
  }
  if (content.frame_files.empty())
    throw InputError(content.info.folder.string(), "color/ contains no images");
}

/// Open3D's format: width, height, and the 3x3 `intrinsic_matrix` in column-major order.
Camera read_camera(const std::filesystem::path& file) {
  require_regular_file(file);
  std::ifstream in(file);
  const nlohmann::json root = nlohmann::json::parse(in, nullptr, false);
  try {
    const std::vector<double> K = root.at("intrinsic_matrix").get<std::vector<double>>();
    const Camera camera{.width = root.at("width").get<int>(),
                        .height = root.at("height").get<int>(),
                        .fx = K.at(0),
                        .fy = K.at(4),
                        .cx = K.at(6),
                        .cy = K.at(7),
                        .model = CameraModel::kRadialTangential,
                        .distortion = {}};
    if (camera.width > 0 && camera.height > 0 && camera.fx > 0.0 && camera.fy > 0.0) return camera;
  } catch (const std::exception&) {  // missing key, wrong type or too few numbers: same message for all
  }
  throw InputError(file.string(),
                   "is not a camera file; expected width, height and a column-major 3x3 intrinsic_matrix");
}

SequenceContent read_folder(const std::filesystem::path& folder, FaultLog&) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  add_folder_images(content);
  for (const std::filesystem::path& file : sorted_files(folder)) {
    if (file.extension() != ".json") continue;
    content.info.rig.camera = read_camera(file);
    content.info.notes.push_back("calibration: " + file.filename().string());
    break;
  }
  content.missing_calibration = "the folder has no JSON file with the camera";
  content.info.notes.push_back("depth: 1000 raw units per meter, unless a rig.toml sets [depth] scale");
  content.info.notes.push_back("timestamps: file number / 30 s, as the images have none");
  return content;
}

bool recognize_folder(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth");
}

}  // namespace

const SequenceFormat kFolderFormat{
    .name = "folder", .signature = "color/ and depth/", .recognize = recognize_folder, .read = read_folder};

}  // namespace stillpoint::datasets
