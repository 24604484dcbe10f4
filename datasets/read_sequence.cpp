// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/read_sequence.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/calibration/rig_file.h"
#include "datasets/formats/bag_format.h"
#include "datasets/formats/formats.h"
#include "datasets/io/detections_file.h"
#include "datasets/io/image_io.h"
#include "datasets/sequence_plausibility.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

/// The first name of a bag in the folder, in alphabetical order; empty without one.
std::string first_bag_in(const std::filesystem::path& folder) {
  std::string first;
  std::error_code ended;
  for (std::filesystem::directory_iterator entry(folder, ended), end; !ended && entry != end;
       entry.increment(ended)) {
    const std::string name = entry->path().filename().string();
    if (eval::is_bag(entry->path()) && (first.empty() || name < first)) first = name;
  }
  return first;
}

const SequenceFormat& find_format(const std::filesystem::path& folder, const std::string& requested) {
  std::string signatures;
  for (const SequenceFormat* const format : kSequenceFormats) {
    if (requested.empty() ? format->recognize(folder) : format->name == requested) return *format;
    signatures += "; " + std::string(format->name) + " has " + std::string(format->signature);
  }
  if (!requested.empty()) {
    throw InputError("unknown format \"" + requested + "\"; expected one of: " + sequence_format_names());
  }
  if (const std::string bag = first_bag_in(folder); !bag.empty())
    throw InputError(folder.string(),
                     "is a folder of bags without the metadata.yaml of rosbag2; name one of them, such as " +
                         bag +
                         "; the parts of a split recording are NAME_0.bag, NAME_1.bag, ... in a folder of "
                         "their own");
  throw InputError(folder.string(), "is not a sequence of a supported format" + signatures);
}

/// Absolute path of the folder without a trailing slash or dot, so that `filename()` is the sequence name.
std::filesystem::path normalized_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored) &&
      !(eval::is_bag(folder) && std::filesystem::exists(folder, ignored))) {
    if (!std::filesystem::is_regular_file(folder, ignored))
      throw InputError(folder.string(), "no such folder or bag");
    const std::string extension = folder.extension().string();
    if (extension == ".zstd" || extension == ".zst")
      throw InputError(folder.string(), "is compressed as a whole; decompress it with `zstd -d`");
    if (extension == ".gz" || extension == ".bz2" || extension == ".xz" || extension == ".zip" ||
        extension == ".tar" || extension == ".tgz" || extension == ".7z")
      throw InputError(folder.string(), "is an archive; extract it, and name its folder or bag");
    throw InputError(folder.string(),
                     "is a file, but no bag (.bag, .mcap or .db3); name the folder of the sequence");
  }
  const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

/// Applies a rig file to what is known of the calibration.
void apply_rig(SequenceContent& content, const std::filesystem::path& file) {
  const OverriddenRig overridden = apply_rig_file(file, content.info.rig);
  content.info.rig = overridden.rig;
  content.extrinsic_known |= overridden.has_extrinsic;
  std::string read;
  for (const std::string& note : overridden.notes) read += (read.empty() ? ": " : ", ") + note;
  content.info.notes.push_back("calibration: overridden by " + file.string() + read);
  if (!overridden.depth_camera) return;
  content.info.depth_camera = overridden.depth_camera;
  content.info.notes.emplace_back("depth is registered to the color camera by [depth] of this file");
}

/// Whether a rig file states another camera than the format, not only a better calibration of the same one.
bool is_other_camera(const Camera& camera, const Camera& of_format) {
  constexpr double kMaxDifference = 0.05;  // of the focal length; calibrations of one camera differ by less
  const auto differ = [](double a, double b) { return std::abs(a - b) > kMaxDifference * b; };
  return camera.width != of_format.width || camera.height != of_format.height ||
         differ(camera.fx, of_format.fx) || differ(camera.fy, of_format.fy);
}

/// Converts the ground truth if the camera of the format, which it is of, is that of the rig.
void convert_truth(SequenceContent& content, const Camera& of_format) {
  std::vector<StampedPose>& poses = content.info.ground_truth.trajectory.poses;
  if (content.mirrored_truth == nullptr || poses.empty()) return;
  const bool is_other = is_other_camera(content.info.rig.camera, of_format);
  content.info.notes.push_back(is_other
                                   ? "ground truth: as in its file, because a rig file replaces the camera"
                                   : "ground truth: mirrored as the camera of the format");
  if (is_other) return;
  for (StampedPose& pose : poses) pose.T_w_f = content.mirrored_truth(pose.T_w_f);
}

/// Applies the rig.toml of the sequence if there is one, then the requested file: what that does not contain,
/// as the YAML of other programs the unit of depth, keeps the value of the sequence.
void override_rig(SequenceContent& content, const std::filesystem::path& requested) {
  const Camera camera_of_format = content.info.rig.camera;
  const std::filesystem::path local = companion_file(content.info.folder, "rig.toml");
  std::error_code ignored;
  if (std::filesystem::exists(local, ignored) && !std::filesystem::equivalent(local, requested, ignored))
    apply_rig(content, local);
  if (!requested.empty()) apply_rig(content, requested);
  convert_truth(content, camera_of_format);
}

/// A valid line of a rig.toml: the camera of TUM freiburg3.
constexpr std::string_view kExampleCamera =
    "camera = { width = 640, height = 480, fx = 535.4, fy = 539.2, cx = 320.1, cy = 247.6 }";

/// Applies the axes of the rig to the samples, once, when all rig files are read. Without them the samples
/// keep their bits.
void correct_axes(SequenceInfo& info) {
  if (info.rig.imu_axes == ImuAxes{}) return;
  for (ImuSample& sample : info.imu) sample = info.rig.imu_axes.corrected(sample);
}

/// Refuses intrinsics of another image size, and those in other units.
/// @param place of the calibration, for messages
void require_possible_camera(const Camera& camera, const std::string& place) {
  constexpr double kLeastFocal = 0.02;   // of the image size; a field of view of 175 deg has a fiftieth
  constexpr double kMaxAspect = 2.0;     // of fx and fy: columns or rows that are binned alone
  constexpr double kLeastMargin = 0.05;  // of the image size: lenses are near the center, crops less so
  if (camera.fx < kLeastFocal * camera.width || camera.fy < kLeastFocal * camera.height) {
    throw InputError(
        place, fmt::format("the focal lengths {:g} and {:g} are too short for an image of {} x {} pixels; "
                           "if they are relative to its size, write fx and cx times its width, and fy "
                           "and cy times its height, into a rig.toml",
                           camera.fx, camera.fy, camera.width, camera.height));
  }
  if (camera.fx > kMaxAspect * camera.fy || camera.fy > kMaxAspect * camera.fx)
    throw InputError(place, fmt::format("the focal lengths fx = {:g} and fy = {:g} differ by more than a "
                                        "factor of {:g}; correct them in a rig.toml",
                                        camera.fx, camera.fy, kMaxAspect));
  const auto is_inside = [](double center, int size) {
    return center >= kLeastMargin * size && center <= (1.0 - kLeastMargin) * size;
  };
  if (!is_inside(camera.cx, camera.width) || !is_inside(camera.cy, camera.height))
    throw InputError(place, fmt::format("the principal point ({:g}, {:g}) is at the border or outside of the "
                                        "image of {} x {} pixels; correct cx and cy, or width and height, in "
                                        "a rig.toml",
                                        camera.cx, camera.cy, camera.width, camera.height));
}

/// A value of the calibration.
struct CalibratedValue {
  std::string_view name;
  double value = 0.0;
  std::string_view unit;
  std::string_view likely_unit;  ///< if it is too large
};

void require_at_most(double limit, const CalibratedValue& value, const std::string& place) {
  if (std::abs(value.value) <= limit) return;
  throw InputError(place,
                   fmt::format("the {} of {:g} {} is larger than {:g} {}; if it is in {}, convert it, "
                               "else correct it, in a rig.toml",
                               value.name, value.value, value.unit, limit, value.unit, value.likely_unit));
}

/// Refuses values that no device has, which other units cause.
void require_possible_rig(const SequenceInfo& info, const std::string& place) {
  constexpr double kMaxReadout_s = 0.1;     // the interval of a camera of 10 Hz
  constexpr double kMaxTimeOffset_s = 1.0;  // the estimate is bounded to 0.15 s
  constexpr double kMaxDistance_m = 3.0;    // of camera and IMU in a car
  const Rig& rig = info.rig;
  require_possible_camera(rig.camera, place);
  require_at_most(kMaxReadout_s, {"readout time of the rolling shutter", rig.rolling_shutter_s, "s", "ms"},
                  place);
  require_at_most(kMaxTimeOffset_s, {"time offset of the IMU", rig.time_offset_s, "s", "ms"}, place);
  require_at_most(kMaxDistance_m, {"distance of camera and IMU", rig.T_b_c.p.norm(), "m", "mm"}, place);
  if (!info.depth_camera) return;
  require_possible_camera(info.depth_camera->camera, place);
  require_at_most(kMaxDistance_m,
                  {"distance of color and depth camera", info.depth_camera->T_c_d.p.norm(), "m", "mm"},
                  place);
}

/// @param requested the rig file of the options, or empty
void check_rig(const SequenceContent& content, const std::filesystem::path& requested) {
  const Camera& camera = content.info.rig.camera;
  const std::string rig_file = companion_file(content.info.folder, "rig.toml").string();
  if (camera.width <= 0 || camera.height <= 0 || camera.fx <= 0.0 || camera.fy <= 0.0) {
    throw InputError(rig_file, "the camera calibration is missing: " + content.missing_calibration +
                                   "; write your values into this file, as in this example with those of "
                                   "freiburg3: " +
                                   std::string(kExampleCamera));
  }
  const bool has_file = std::filesystem::exists(rig_file);
  require_possible_rig(content.info, !requested.empty() ? requested.string()
                                     : has_file         ? rig_file
                                                        : content.info.folder.string());
  if (content.info.rig.has_imu && !content.extrinsic_known) {
    throw InputError(
        rig_file,
        "the sequence has IMU data but no camera-IMU extrinsic; write the pose of your camera in "
        "the IMU frame into this file, as in this example with the identity: imu = { T_b_c = "
        "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }");
  }
}

/// Depth in the place of color has gray values of 16 bits, too, but not their whole range.
/// @throws InputError if the brightest of three images is darker than a quarter of it, or a frame has one
/// file for both
void require_brightness(const SequenceContent& content) {
  constexpr int kQuarter = 1 << 14;
  const std::vector<FrameFiles>& files = content.frame_files;
  if (content.images || files.empty() || files.front().depth.empty()) return;
  if (files.front().color == files.front().depth)
    throw InputError(files.front().color.string(), "is listed as color and as depth; correct one list");
  std::optional<int> brightest;
  for (const std::size_t i : {std::size_t{0}, files.size() / 2, files.size() - 1})
    brightest = std::max(brightest, largest_deep_gray(files[i].color));
  if (!brightest || *brightest >= kQuarter) return;
  throw InputError(files.front().color.string(),
                   "has 16 bits per channel, of which values up to " + std::to_string(*brightest) +
                       " are used; is it a depth image? scale gray images to the whole range or to 8 bits");
}

/// Frame numbers, and milliseconds to nanoseconds since the start, in the place of seconds: whole numbers
/// that are no seconds since 1970, or far apart.
bool has_whole_numbers(const std::vector<Timestamp>& times) {
  constexpr std::size_t kLeastFrames = 10;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  constexpr std::int64_t kLargest = 100'000'000;
  constexpr double kFarApart_s = 10.0;
  if (times.size() < kLeastFrames) return false;
  const double mean_s = seconds_between(times.front(), times.back()) / static_cast<double>(times.size() - 1);
  return (times.back().ns < kLargest * kSecond_ns || mean_s > kFarApart_s) &&
         std::ranges::all_of(times, [](Timestamp t) { return t.ns % kSecond_ns == 0; });
}

/// `content` with warnings about the repaired rows of the ground truth.
SequenceContent with_warnings(SequenceContent content) {
  for (const std::string& text : eval::repair_texts(content.truth_repairs))
    content.info.warnings.push_back("ground truth: " + text);
  return content;
}

std::string span_text(Timestamp first, Timestamp last) {
  return std::to_string(to_seconds(first)) + " to " + std::to_string(to_seconds(last)) + " s";
}

void require_overlap(const SequenceInfo& info, const std::string& stream, Timestamp first, Timestamp last) {
  if (first <= info.frame_times.back() && last >= info.frame_times.front()) return;
  throw InputError(info.folder.string(), stream + " covers " + span_text(first, last) + ", the images " +
                                             span_text(info.frame_times.front(), info.frame_times.back()) +
                                             ": no overlap in time; are they of the same recording?");
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

void require_size(const std::filesystem::path& file, const cv::Mat& image, const Camera& camera,
                  const std::string& remedy = "correct [camera] in rig.toml") {
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw InputError(file.string(), "is " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                                      ", but the calibration is for " + std::to_string(camera.width) + "x" +
                                      std::to_string(camera.height) + "; " + remedy);
}

/// Measured inverse depths are larger than the true ones by `offset`; what is then no distance, or too far
/// for 16 bits, is 0.
void subtract_offset(cv::Mat& depth, double units_per_m, double offset) {
  std::transform(depth.begin<std::uint16_t>(), depth.end<std::uint16_t>(), depth.begin<std::uint16_t>(),
                 [=](std::uint16_t raw) -> std::uint16_t {
                   const double units = std::round(raw / (1.0 - offset * raw / units_per_m));
                   const bool valid = units >= 1.0 && units <= std::numeric_limits<std::uint16_t>::max();
                   return valid ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
                 });
}

cv::Mat stored_depth(const SequenceContent& content, std::size_t index) {
  return content.images ? content.images->depth(index) : read_depth(content.frame_files[index].depth);
}

/// Whether an image file can contain floats.
bool may_contain_floats(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension != ".png" && extension != ".jpg" && extension != ".jpeg" && extension != ".pgm";
}

/// The measurements of three depth images of floats; empty if they are of integers.
std::vector<float> samples_of_float_depth(const SequenceContent& content) {
  std::vector<float> samples;
  const std::size_t count = content.frame_files.size();
  if (count == 0) return samples;
  for (const std::size_t i : std::set<std::size_t>{0, count / 2, count - 1}) {
    const std::filesystem::path& file = content.frame_files[i].depth;
    if (file.empty() || (!content.images && !may_contain_floats(file))) continue;
    try {
      const cv::Mat depth = stored_depth(content, i);
      if (depth.type() != CV_32FC1) return {};
      std::copy_if(depth.begin<float>(), depth.end<float>(), std::back_inserter(samples),
                   [](float value) { return std::isfinite(value) && value > 0.0F; });
    } catch (const InputError&) {
      continue;  // reported where the frame is decoded
    }
  }
  return samples;
}

cv::Mat load_depth(const SequenceContent& content, std::size_t index) {
  const std::filesystem::path& file = content.frame_files[index].depth;
  cv::Mat depth = stored_depth(content, index);
  const Rig& rig = content.info.rig;
  if (depth.type() == CV_32FC1) depth = in_depth_units(depth, rig.depth_units_per_m);
  require_size(file, depth, content.info.depth_camera ? content.info.depth_camera->camera : rig.camera,
               "if it is the image of another camera, write width, height, fx, fy, cx, cy and T_c_d of that "
               "camera into [depth] in rig.toml, and it is registered");
  if (content.no_depth_value != 0) {
    std::replace(depth.begin<std::uint16_t>(), depth.end<std::uint16_t>(), content.no_depth_value,
                 std::uint16_t{0});
  }
  if (rig.depth_offset != 0.0) subtract_offset(depth, rig.depth_units_per_m, rig.depth_offset);
  if (!content.info.depth_camera || content.raw_depth) return depth;
  return register_depth(depth, rig.depth_units_per_m, *content.info.depth_camera, rig.camera);
}

std::vector<DetectionSet> read_optional_boxes(const std::filesystem::path& file, FaultLog& faults) {
  return std::filesystem::exists(file) ? read_detections(file, faults) : std::vector<DetectionSet>{};
}

}  // namespace

std::filesystem::path companion_file(const std::filesystem::path& sequence, const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::is_directory(sequence, ignored)) return sequence / name;
  return sequence.parent_path() / (sequence.stem().string() + "." + name);
}

SequenceContent read_sequence(const std::filesystem::path& folder, const OpenOptions& options,
                              FaultLog& faults) {
  const std::filesystem::path root = normalized_folder(folder);
  const SequenceFormat& format = find_format(root, options.format);
  if (!options.topics.empty() && &format != &kBagFormat)
    throw InputError("--topics", root.string() + " is no bag; omit the option");
  SequenceContent content = with_warnings(
      options.topics.empty() ? format.read(root, faults) : read_bag_sequence(root, options.topics, faults));
  require_utf8("sequence name", content.info.name);
  content.info.format = format.name;
  content.info.id = options.id;
  content.info.detections = read_optional_boxes(companion_file(root, "detections.txt"), faults);
  content.info.true_boxes = read_optional_boxes(companion_file(root, "true_boxes.txt"), faults);
  override_rig(content, options.rig_file);
  content.raw_depth = options.raw_depth;
  check_rig(content, options.rig_file);
  if (&format == &kBagFormat) content = with_metric_accelerations(std::move(content));
  correct_axes(content.info);
  check_overlap(content.info, faults);
  faults.guard([&content] { require_brightness(content); });
  if (has_whole_numbers(content.info.frame_times))
    content.info.warnings.push_back(fmt::format(
        "images: the stamps are whole numbers, the first two {} s apart: if these are frame numbers, "
        "or not seconds, convert them to seconds",
        (content.info.frame_times[1].ns - content.info.frame_times[0].ns) / 1'000'000'000));
  if (const auto finding = float_depth_finding(samples_of_float_depth(content)))
    content.info.warnings.push_back("depth: " + *finding);
  for (const std::string& finding : imu_unit_findings(content.info))
    content.info.warnings.push_back("imu: " + finding);
  return content;
}

cv::Mat decode_color(const SequenceContent& content, std::size_t index) {
  STILLPOINT_CHECK(index < content.frame_files.size());
  const std::filesystem::path& file = content.frame_files[index].color;
  const cv::Mat image = content.images ? content.images->color(index) : read_image(file);
  require_size(file, image, content.info.rig.camera);
  return image.channels() == 3 ? image : cv::Mat();
}

Frame decode_frame(const SequenceContent& content, std::size_t index, ColorDecoding color) {
  STILLPOINT_CHECK(index < content.frame_files.size());
  const FrameFiles& files = content.frame_files[index];
  Frame frame;
  frame.id = static_cast<std::int64_t>(index);
  frame.t = content.info.frame_times[index];
  if (color == ColorDecoding::kDeferred && !content.images) {
    const GrayImage gray = read_gray(files.color);
    frame.gray = gray.image;
    if (gray.is_color) frame.decode_color = [&content, index] { return decode_color(content, index); };
  } else {
    const cv::Mat image = content.images ? content.images->color(index) : read_image(files.color);
    frame.gray = to_gray(image);
    if (image.channels() == 3) frame.color = image;
  }
  require_size(files.color, frame.gray, content.info.rig.camera);
  if (!files.depth.empty()) frame.depth = load_depth(content, index);
  frame.depth_units_per_m = content.info.rig.depth_units_per_m;
  return frame;
}

}  // namespace stillpoint::datasets
