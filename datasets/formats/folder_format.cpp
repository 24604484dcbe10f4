// SPDX-License-Identifier: BSD-3-Clause
/// Plain image folders: color/NAME.{png,jpg} and depth/NAME.png, pinhole calibration as JSON. Names are
/// numbers of frames, or times, with which imu.txt, imu.csv and groundtruth.txt are read.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/image_lists.h"
#include "datasets/io/imu_file.h"
#include "eval/io/text_reader.h"
#include "eval/trajectory/association.h"

namespace stillpoint::datasets {
namespace {

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

/// A name as texts and the numbers between them: "frame10_1.5" has the texts "frame", "_", "" and the numbers
/// "10", "1.5".
struct NameParts {
  std::vector<std::string> texts{""};
  std::vector<std::string> numbers;
};

NameParts parts_of(const std::string& name) {
  const auto digits_end = [&](std::size_t begin) {
    return std::min(name.find_first_not_of("0123456789", begin), name.size());
  };
  NameParts parts;
  for (std::size_t at = 0; at < name.size();) {
    std::size_t end = digits_end(at);
    if (end == at) {
      parts.texts.back() += name[at++];
      continue;
    }
    if (end < name.size() && name[end] == '.' && digits_end(end + 1) > end + 1) end = digits_end(end + 1);
    parts.numbers.push_back(name.substr(at, end - at));
    parts.texts.emplace_back();
    at = end;
  }
  return parts;
}

/// The numbers at one place of all names.
using NumberColumn = std::vector<std::string>;

/// The numbers that differ between names with the same texts; all numbers of a single name.
std::vector<NumberColumn> number_columns(const std::vector<NameParts>& names) {
  std::vector<NumberColumn> columns;
  const auto has_other_texts = [&](const NameParts& name) { return name.texts != names.front().texts; };
  if (names.empty() || std::ranges::any_of(names, has_other_texts)) return columns;
  for (std::size_t i = 0; i < names.front().numbers.size(); ++i) {
    NumberColumn column;
    for (const NameParts& name : names) column.push_back(name.numbers[i]);
    const bool differ = std::ranges::any_of(column, [&](const auto& text) { return text != column.front(); });
    if (differ || names.size() == 1) columns.push_back(std::move(column));
  }
  return columns;
}

bool has_decimals(const NumberColumn& column) {
  return std::ranges::any_of(column, [](const auto& text) { return text.find('.') != std::string::npos; });
}

/// The largest integer stands for what does not fit.
std::vector<std::int64_t> integers_of(const NumberColumn& column) {
  std::vector<std::int64_t> integers;
  for (const std::string& text : column) {
    std::int64_t& integer = integers.emplace_back();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
    if (error != std::errc() || end != text.data() + text.size())
      integer = std::numeric_limits<std::int64_t>::max();
  }
  return integers;
}

/// Seconds with decimals; empty if one of the numbers is too large.
std::vector<Timestamp> seconds_of(const NumberColumn& column) {
  std::vector<Timestamp> times;
  for (const std::string& text : column) {
    const std::optional<Timestamp> t = eval::parse_stamp(text);
    if (!t) return {};
    times.push_back(*t);
  }
  return times;
}

constexpr std::int64_t kYear2001_ns = 1'000'000'000'000'000'000;
constexpr std::int64_t kYear2128_ns = 5 * kYear2001_ns;

/// Times since 1970, in s with decimals, or integers in s, ms, us or ns, which the range from 2001 to 2128
/// tells apart; empty if one of the numbers is none.
std::vector<Timestamp> times_since_1970(const NumberColumn& column) {
  const auto is_in_range = [](std::int64_t t, std::int64_t unit_ns) {
    return t >= kYear2001_ns / unit_ns && t < kYear2128_ns / unit_ns;
  };
  std::vector<Timestamp> times;
  if (has_decimals(column)) {
    times = seconds_of(column);
    if (!std::ranges::all_of(times, [&](Timestamp t) { return is_in_range(t.ns, 1); })) return {};
    return times;
  }
  for (const std::int64_t integer : integers_of(column)) {
    constexpr std::array<std::int64_t, 4> kUnits_ns{1'000'000'000, 1'000'000, 1'000, 1};
    const auto unit = std::ranges::find_if(kUnits_ns, [&](auto ns) { return is_in_range(integer, ns); });
    if (unit == kUnits_ns.end()) return {};
    times.push_back(Timestamp{integer * *unit});
  }
  return times;
}

/// The times in names, and their kind: those since 1970, else the only number that differs, else the order of
/// the names.
/// @throws InputError if that number is neither a time nor that of a frame
std::pair<NameKind, std::vector<Timestamp>> times_in(const std::vector<NameParts>& names,
                                                     const std::filesystem::path& folder) {
  const std::vector<NumberColumn> columns = number_columns(names);
  for (const NumberColumn& column : columns) {
    if (auto times = times_since_1970(column); !times.empty()) return {NameKind::kStamp, std::move(times)};
  }
  if (columns.size() != 1) {
    std::vector<std::int64_t> order(names.size());
    std::iota(order.begin(), order.end(), 0);
    return {NameKind::kOther, times_of_frames(order, folder)};
  }
  if (has_decimals(columns.front())) {
    if (auto times = seconds_of(columns.front()); !times.empty()) return {NameKind::kStamp, std::move(times)};
  }
  return {NameKind::kNumber, times_of_frames(integers_of(columns.front()), folder)};
}

/// One kind of name for all images.
NamedImages named_images(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files = visible_files(folder);
  std::erase_if(files, [](const std::filesystem::path& file) { return !is_image(file); });
  std::vector<NameParts> names;
  for (const std::filesystem::path& file : files) names.push_back(parts_of(file.stem().string()));
  const auto [kind, times] = times_in(names, folder);
  NamedImages named{.kind = kind, .images = {}};
  for (std::size_t i = 0; i < times.size(); ++i) named.images.push_back({times[i], files[i]});
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

/// Whether a 3x3 camera matrix is in row-major order, as other programs write it: its last row is 0 0 1.
bool is_row_major(const std::vector<double>& K) {
  return (K.at(2) != 0.0 || K.at(5) != 0.0) && K.at(6) == 0.0 && K.at(7) == 0.0;
}

constexpr double kFrameRate_hz = 30.0;  ///< of `times_of_frames`

/// A JSON file of Open3D.
struct CameraFile {
  std::string name;
  Camera camera;
  double depth_units_per_m = 1000.0;
  double frame_rate_hz = kFrameRate_hz;
};

/// Units per meter, as Open3D writes them; less than 1 are meters per unit, as librealsense states them.
double depth_units_per_m(double depth_scale) {
  return depth_scale > 0.0 && depth_scale < 1.0 ? 1.0 / depth_scale : depth_scale;
}

/// Open3D's format: width, height, and the 3x3 `intrinsic_matrix` in column-major order; of a RealSense
/// camera also `depth_scale` and `fps`.
CameraFile read_camera(const std::filesystem::path& file, const nlohmann::json& root) {
  try {
    const std::vector<double> K = root.at("intrinsic_matrix").get<std::vector<double>>();
    const bool row_major = is_row_major(K);
    CameraFile result{.name = file.filename().string(),
                      .camera = Camera{.width = root.at("width").get<int>(),
                                       .height = root.at("height").get<int>(),
                                       .fx = K.at(0),
                                       .fy = K.at(4),
                                       .cx = K.at(row_major ? 2 : 6),
                                       .cy = K.at(row_major ? 5 : 7),
                                       .model = CameraModel::kRadialTangential,
                                       .distortion = {}}};
    if (root.contains("depth_scale"))
      result.depth_units_per_m = depth_units_per_m(root.at("depth_scale").get<double>());
    if (root.contains("fps")) result.frame_rate_hz = root.at("fps").get<double>();
    const Camera& camera = result.camera;
    const bool is_positive = camera.width > 0 && camera.height > 0 && camera.fx > 0.0 && camera.fy > 0.0 &&
                             result.depth_units_per_m > 0.0 && result.frame_rate_hz > 0.0;
    if (is_positive) return result;
  } catch (const std::exception&) {  // missing key, wrong type or too few numbers: same message for all
  }
  throw InputError(
      file.string(),
      "is not a camera file; expected width, height and a column-major 3x3 intrinsic_matrix, and "
      "depth_scale (units per meter) and fps, if they are there, greater than 0");
}

/// The only JSON file with an `intrinsic_matrix`; others, as config.json of Open3D, are no cameras.
/// @throws InputError if there are several
std::optional<CameraFile> find_camera(const std::filesystem::path& folder) {
  std::optional<CameraFile> found;
  nlohmann::json found_root;
  for (const std::filesystem::path& file : visible_files(folder)) {
    if (file.extension() != ".json") continue;
    require_regular_file(file);
    std::ifstream in(file);
    const nlohmann::json root = nlohmann::json::parse(in, nullptr, false);
    if (!root.is_object() || !root.contains("intrinsic_matrix")) continue;
    if (found && found_root["intrinsic_matrix"] != root["intrinsic_matrix"])
      throw InputError(file.string(), "has another intrinsic_matrix than " + found->name +
                                          "; move the one that is not of the color images to another folder");
    if (found) continue;
    found = read_camera(file, root);
    found_root = root;
  }
  return found;
}

std::string times_note(NameKind names, double frame_rate_hz) {
  if (names == NameKind::kStamp) return "timestamps: the names of the images";
  const std::string number =
      names == NameKind::kNumber ? "file number" : "position of the name in their order";
  return fmt::format("timestamps: {} / {:g} s, as the images have none", number, frame_rate_hz);
}

/// The camera, the unit of depth, and the times of images that are numbered at another rate than 30 Hz.
SequenceContent with_camera_file(SequenceContent content, const CameraFile& file, NameKind names) {
  content.info.rig.camera = file.camera;
  content.info.rig.depth_units_per_m = file.depth_units_per_m;
  content.info.notes.push_back("calibration: " + file.name);
  if (names == NameKind::kStamp || file.frame_rate_hz == kFrameRate_hz) return content;
  for (Timestamp& t : content.info.frame_times)
    t.ns = std::llround(static_cast<double>(t.ns) * kFrameRate_hz / file.frame_rate_hz);
  return content;
}

SequenceContent read_folder(const std::filesystem::path& folder, FaultLog& faults) {
  SequenceContent content;
  content.info.name = folder.filename().string();
  content.info.folder = folder;
  const NameKind names = add_folder_images(content);
  add_other_sensors(content, names, faults);
  const std::optional<CameraFile> camera = find_camera(folder);
  if (camera) content = with_camera_file(std::move(content), *camera, names);
  content.missing_calibration = "the folder has no JSON file with the intrinsic_matrix of the camera";
  content.info.notes.push_back(
      fmt::format("depth: {:g} raw units per meter, unless a rig.toml sets [depth] scale",
                  content.info.rig.depth_units_per_m));
  content.info.notes.push_back(times_note(names, camera.value_or(CameraFile{}).frame_rate_hz));
  return content;
}

bool recognize_folder(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth");
}

}  // namespace

const SequenceFormat kFolderFormat{
    .name = "folder", .signature = "color/ and depth/", .recognize = recognize_folder, .read = read_folder};

}  // namespace stillpoint::datasets
