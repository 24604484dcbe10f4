// SPDX-License-Identifier: BSD-3-Clause
/// Plain image folders: color/NAME.{png,jpg} and depth/NAME.png, pinhole calibration as JSON. Names are
/// numbers of frames, or times, with which imu.txt, imu.csv and groundtruth.txt are read.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/text_reader.h"
#include "eval/trajectory/association.h"

namespace stillpoint::datasets {
namespace {

constexpr std::int64_t kFramesPerSecond = 30;

bool is_image(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".tif" ||
         extension == ".tiff" || extension == ".exr";
}

/// What the names of image files tell about time.
enum class NameKind { kStamp, kNumber, kOther };

struct NamedImage {
  Timestamp t;
  std::filesystem::path file;
};

/// The images of a folder in order of time.
struct NamedImages {
  NameKind kind = NameKind::kOther;
  std::vector<NamedImage> images;
};

/// "12" of "frame_0012": the number at the end of a name, and the text in front of it.
struct NumberedName {
  std::string prefix;
  std::int64_t number = 0;
};

std::optional<NumberedName> numbered_name(const std::string& stem) {
  const std::size_t last = stem.find_last_not_of("0123456789");
  const std::size_t begin = last == std::string::npos ? 0 : last + 1;
  NumberedName name{.prefix = stem.substr(0, begin)};
  const auto [end, error] = std::from_chars(stem.data() + begin, stem.data() + stem.size(), name.number);
  if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return name;
}

/// Seconds with decimals, or an integer that is too large for the number of a frame: s, ms, us or ns since
/// 1970.
std::optional<Timestamp> stamp_of(const std::string& stem) {
  if (stem.find('.') != std::string::npos) return eval::parse_stamp(stem);
  const std::optional<Timestamp> integer = eval::parse_nanoseconds(stem);
  if (!integer || integer->ns < 1'000'000'000) return std::nullopt;
  std::int64_t ns = integer->ns;
  while (ns < 100'000'000'000'000'000) ns *= 1000;  // 10^17 ns are 3 years
  return Timestamp{ns};
}

/// One kind of name for all images: stamps, numbers behind a common text, or their natural order.
NamedImages named_images(const std::filesystem::path& folder) {
  NamedImages named;
  std::vector<std::filesystem::path> files = visible_files(folder);
  std::erase_if(files, [](const std::filesystem::path& file) { return !is_image(file); });
  const auto all = [&](const auto& is) { return !files.empty() && std::ranges::all_of(files, is); };
  const auto stem = [](const std::filesystem::path& file) { return file.stem().string(); };
  if (all([&](const auto& file) { return stamp_of(stem(file)).has_value(); })) {
    named.kind = NameKind::kStamp;
  } else if (all([&](const auto& file) {
               const auto name = numbered_name(stem(file));
               return name && name->prefix == numbered_name(stem(files.front()))->prefix;
             })) {
    named.kind = NameKind::kNumber;
  }
  std::int64_t next = 0;
  for (const std::filesystem::path& file : files) {
    const std::int64_t number = named.kind == NameKind::kNumber ? numbered_name(stem(file))->number : next++;
    const Timestamp of_number{(number * 1'000'000'000 + kFramesPerSecond / 2) / kFramesPerSecond};
    named.images.push_back({named.kind == NameKind::kStamp ? *stamp_of(stem(file)) : of_number, file});
  }
  std::ranges::stable_sort(named.images, {}, &NamedImage::t);
  return named;
}

std::vector<Timestamp> times_of(const std::vector<NamedImage>& images) {
  std::vector<Timestamp> times;
  times.reserve(images.size());
  for (const NamedImage& image : images) times.push_back(image.t);
  return times;
}

/// @return how the images are named
NameKind add_folder_images(SequenceContent& content) {
  const std::filesystem::path& folder = content.info.folder;
  const NamedImages color = named_images(folder / "color");
  const NamedImages depth = named_images(folder / "depth");
  for (std::size_t i = 0; i < color.images.size(); ++i) {
    const auto& [t, file] = color.images[i];
    if (i > 0 && t == color.images[i - 1].t)
      throw InputError(file.string(), "has the time or number of " +
                                          color.images[i - 1].file.filename().string() +
                                          "; remove one of the two");
    content.info.frame_times.push_back(t);
    content.frame_files.push_back(
        FrameFiles{.color = file, .depth = folder / "depth" / (file.stem().string() + ".png")});
  }
  if (content.frame_files.empty()) throw InputError(folder.string(), "color/ contains no images");
  if (color.kind == NameKind::kOther || color.kind != depth.kind) return color.kind;
  // By time or number: names may differ in leading zeros, extension, or by the time between both cameras.
  PairedImages paired{.times = {}, .files = {}, .color_images = color.images.size(), .missing = 0};
  for (const auto& [in_depth, in_color] :
       eval::associate_tum(times_of(depth.images), times_of(color.images), kImageAssociation)) {
    paired.times.push_back(color.images[in_color].t);
    paired.files.push_back(
        FrameFiles{.color = color.images[in_color].file,
                   .depth = depth.images[in_depth].file,
                   .depth_offset_s = seconds_between(color.images[in_color].t, depth.images[in_depth].t)});
  }
  const bool complete = paired.times.size() == color.images.size() || color.kind == NameKind::kStamp;
  if (complete && !paired.times.empty()) content = with_frames(std::move(content), paired);
  return color.kind;
}

/// imu.txt (s) or imu.csv (ns), and groundtruth.txt, if the names of the images are times.
void add_other_sensors(SequenceContent& content, NameKind names, FaultLog& faults) {
  const std::filesystem::path& folder = content.info.folder;
  const std::filesystem::path truth = folder / "groundtruth.txt";
  const bool has_txt = std::filesystem::exists(folder / "imu.txt");
  const bool has_imu = has_txt || std::filesystem::exists(folder / "imu.csv");
  if (names != NameKind::kStamp) {
    if (has_imu || std::filesystem::exists(truth))
      content.info.notes.emplace_back(
          "imu and ground truth are not read: the names of the images are no times in s, ms, us or ns");
    return;
  }
  if (has_imu) {
    content.info.imu = has_txt ? read_imu_file(folder / "imu.txt", eval::TimeUnit::kSeconds, faults)
                               : read_imu_file(folder / "imu.csv", eval::TimeUnit::kNanoseconds, faults);
    content.info.rig.has_imu = true;
    content.extrinsic_known = false;
    content.info.notes.emplace_back(
        "imu: default noise densities, unless a rig.toml sets [imu] gyro_noise etc.");
  }
  if (std::filesystem::exists(truth))
    content = with_ground_truth(std::move(content), eval::read_tum_ground_truth(truth, "camera", faults));
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

SequenceContent read_folder(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  const NameKind names = add_folder_images(content);
  add_other_sensors(content, names, faults);
  for (const std::filesystem::path& file : visible_files(folder)) {
    if (file.extension() != ".json") continue;
    content.info.rig.camera = read_camera(file);
    content.info.notes.push_back("calibration: " + file.filename().string());
    break;
  }
  content.missing_calibration = "the folder has no JSON file with the camera";
  content.info.notes.push_back("depth: 1000 raw units per meter, unless a rig.toml sets [depth] scale");
  content.info.notes.push_back(names == NameKind::kStamp
                                   ? "timestamps: the names of the images"
                                   : "timestamps: file number / 30 s, as the images have none");
  return content;
}

bool recognize_folder(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth");
}

}  // namespace

const SequenceFormat kFolderFormat{
    .name = "folder", .signature = "color/ and depth/", .recognize = recognize_folder, .read = read_folder};

}  // namespace stillpoint::datasets
