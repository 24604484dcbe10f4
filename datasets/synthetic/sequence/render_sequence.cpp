// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/io/detections_file.h"
#include "datasets/io/image_io.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/sequence/scene_setup.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCameraFrame = "d400_color_optical_frame";

std::string exact_stamp(Timestamp t) { return fmt::format("{}.{:09}", t.ns / 1000000000, t.ns % 1000000000); }

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out)
    throw InputError(file.string(), "cannot be written; check free disk space and folder permissions");
}

const char* color_folder(SequenceLayout layout) { return layout == SequenceLayout::kTum ? "rgb" : "color"; }
const char* depth_folder(SequenceLayout layout) {
  return layout == SequenceLayout::kTum ? "depth" : "aligned_depth";
}

std::string image_list(const char* folder, const std::vector<Timestamp>& frames) {
  std::string text;
  for (const Timestamp t : frames) text += fmt::format("{0} {1}/{0}.png\n", image_stamp(t), folder);
  return text;
}

std::string camera_yaml(const char* name, const Camera& camera, double frames_per_s) {
  return fmt::format(
      "{}:\n  width: {}\n  height: {}\n  fps: {}\n  distortion_model: radial-tangential\n"
      "  distortion_coefficients:\n    data: [{}]\n  intrinsics:\n    data: [{}, {}, {}, {}]\n",
      name, camera.width, camera.height, frames_per_s, fmt::join(camera.coefficients(), ", "), camera.fx,
      camera.cx, camera.fy, camera.cy);
}

std::string imu_yaml(const char* name, double rate_hz, double density, double walk) {
  return fmt::format(
      "{0}:\n  fps: {1}\n  imu_intrinsic:\n    data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n"
      "  noise_variances:\n    data: [{2}, {2}, {2}]\n  bias_variances:\n    data: [{3}, {3}, {3}]\n",
      name, rate_hz, density * density, walk * walk);
}

std::string matrix_text(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return fmt::format("{:.12g}", fmt::join(rows.data(), rows.data() + 16, ", "));
}

std::string transform_yaml(const char* child, const Pose& T_parent_child) {
  return fmt::format(
      "  - parent_frame: {}\n    child_frame: {}\n    matrix:\n      rows: 4\n      cols: 4\n      data: "
      "[{}]\n",
      kCameraFrame, child, matrix_text(T_parent_child));
}

std::string axis_text(const std::string& header, const std::vector<datasets::VectorSample>& samples) {
  std::string text = header;
  for (const datasets::VectorSample& sample : samples) {
    text += fmt::format("{} {:.9f} {:.9f} {:.9f}\n", exact_stamp(sample.t), sample.value.x(),
                        sample.value.y(), sample.value.z());
  }
  return text;
}

}  // namespace

std::string image_stamp(Timestamp t) {
  const std::int64_t us = t.ns / 1000;
  return fmt::format("{}.{:06}", us / 1000000, us % 1000000);
}

SequenceWriter::SequenceWriter(const fs::path& folder, SequenceLayout layout, bool labels)
    : folder_(folder), layout_(layout) {
  std::vector<fs::path> needed{folder / color_folder(layout), folder / depth_folder(layout)};
  if (labels) needed.insert(needed.end(), {folder / "labels", folder / "motion"});
  for (const fs::path& path : needed) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error)
      throw InputError(path.string(), "cannot be created (" + error.message() + "); choose another folder");
  }
}

void SequenceWriter::write_images(const ImageStamps& stamps, const cv::Mat& color,
                                  const cv::Mat& depth) const {
  datasets::write_png(folder_ / color_folder(layout_) / (image_stamp(stamps.color) + ".png"), color);
  datasets::write_png(folder_ / depth_folder(layout_) / (image_stamp(stamps.depth) + ".png"), depth);
}

void SequenceWriter::write_labels(Timestamp t, const cv::Mat& labels, const cv::Mat& motion) const {
  const std::string name = image_stamp(t) + ".png";
  datasets::write_png(folder_ / "labels" / name, labels);
  datasets::write_png(folder_ / "motion" / name, motion);
}

void SequenceWriter::write_lists(const FrameTimes& frames) const {
  const bool tum = layout_ == SequenceLayout::kTum;
  write_text(folder_ / (tum ? "rgb.txt" : "color.txt"), image_list(color_folder(layout_), frames.color));
  write_text(folder_ / (tum ? "depth.txt" : "aligned_depth.txt"),
             image_list(depth_folder(layout_), frames.depth));
}

void SequenceWriter::write_rig(const Rig& rig, const SynthRequest& request) const {
  const Camera& camera = rig.camera;
  const ImuNoise& noise = rig.imu_noise;
  if (layout_ == SequenceLayout::kTum) {
    write_text(
        folder_ / "rig.toml",
        fmt::format("[camera]\nwidth = {}\nheight = {}\nfx = {:.9f}\nfy = {:.9f}\ncx = {:.9f}\ncy = {:.9f}\n"
                    "model = \"radial-tangential\"\ndistortion = [0.0, 0.0, 0.0, 0.0, 0.0]\n\n"
                    "[depth]\nscale = {:.1f}\n",
                    camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                    rig.depth_units_per_m));
    return;
  }
  write_text(
      folder_ / "sensors.yaml",
      camera_yaml(kCameraFrame, camera, request.frames_per_s) +
          camera_yaml("d400_aligned_depth_optical_frame", camera, request.frames_per_s) +
          imu_yaml("d400_accelerometer", request.imu.accel_rate_hz, noise.accel_noise, noise.accel_walk) +
          imu_yaml("d400_gyroscope", request.imu.gyro_rate_hz, noise.gyro_noise, noise.gyro_walk));
  const Pose T_c_b = rig.T_b_c.inverse();
  write_text(folder_ / "trans_matrix.yaml", "trans_matrix:\n" + transform_yaml("d400_accelerometer", T_c_b) +
                                                transform_yaml("d400_gyroscope", T_c_b) +
                                                transform_yaml("base_link", Pose{}));
}

void SequenceWriter::write_imu(const ImuRecord& record) const {
  if (layout_ == SequenceLayout::kTum) return;  // a TUM folder has no gyroscope
  write_text(folder_ / "d400_gyroscope.txt", axis_text("#Time Gx Gy Gz\n", record.gyro));
  write_text(folder_ / "d400_accelerometer.txt", axis_text("#Time Ax Ay Az\n", record.accel));
}

void SequenceWriter::write_ground_truth(const Trajectory& camera_path) const {
  std::string text = "# timestamp tx ty tz qx qy qz qw (camera in world)\n";
  for (const StampedPose& pose : camera_path.poses) {
    const Eigen::Vector3d& p = pose.T_w_f.p;
    const Eigen::Quaterniond& q = pose.T_w_f.q;
    text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", exact_stamp(pose.t), p.x(),
                        p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  write_text(folder_ / "groundtruth.txt", text);
}

void SequenceWriter::write_request(const SynthRequest& request) const {
  write_text(folder_ / "request.toml", request_text(request));
}

void SequenceWriter::write_boxes(const std::string& file, const std::vector<DetectionSet>& sets) const {
  write_text(folder_ / file, datasets::detections_text(sets));
}

namespace {

/// Calls `work(index)` once for every index below `count`, from several threads. The first exception stops
/// all threads and is rethrown.
/// @return false if stopped by `control`
template <class Work>
bool for_each_frame(int count, const RenderControl& control, const Work& work) {
  std::atomic<int> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  int done = 0;
  std::exception_ptr error;
  const auto run = [&] {
    while (!stopped) {
      if (control.stop_requested && control.stop_requested()) stopped = true;
      const int index = next++;
      if (stopped || index >= count) return;
      try {
        work(index);
        const std::scoped_lock lock(mutex);
        if (control.progress) control.progress(++done, count);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
        stopped = true;
      }
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = control.threads > 0 ? static_cast<unsigned>(control.threads) : cores;
  {
    std::vector<std::jthread> pool;
    for (unsigned i = 0; i < threads; ++i) pool.emplace_back(run);
  }
  if (error) std::rethrow_exception(error);
  return !stopped;
}

/// A folder that is removed on destruction unless it was renamed.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  void rename_to(const fs::path& name) {
    std::error_code error;
    fs::rename(path_, name, error);
    if (error)
      throw InputError(name.string(), "cannot be created (" + error.message() + "); choose another folder");
  }

 private:
  fs::path path_;
};

/// One state of the static world, ready to be rendered.
struct WorldRenderer {
  WorldRenderer(const World& world, const Camera& camera) : tracer(world), renderer(world, tracer, camera) {}
  RayTracer tracer;
  FrameRenderer renderer;
};

/// Renders and writes single frames.
class SequenceRenderer {
 public:
  SequenceRenderer(const SynthRequest& request, const SceneSetup& setup, const FrameTimes& times,
                   const SequenceWriter& writer)
      : request_(request),
        setup_(setup),
        times_(times),
        writer_(writer),
        initial_(setup.scene.world, setup.rig.camera),
        visible_(times.color.size()) {
    if (setup.scene.change) changed_.emplace(setup.scene.change->world, setup.rig.camera);
  }

  /// Thread-safe for different frames.
  void render(std::size_t index, const RenderControl& control) {
    const Timestamp t = times_.color[index];
    const RenderedFrame frame = render_ideal_frame(t);
    const double gain =
        setup_.scene.gain * exposure_gain(request_.color, seconds_between(times_.color.front(), t));
    const std::uint64_t color_key = random_key(request_.seed, RandomStream::kColorNoise, index);
    const std::uint64_t depth_key = random_key(request_.seed, RandomStream::kDepthNoise, index);
    const cv::Mat color = simulate_color(frame, setup_.rig.camera, request_.color, {gain, color_key});
    const cv::Mat depth =
        simulate_depth({frame.depth_m, frame.width, frame.height}, request_.depth, depth_key);
    writer_.write_images({t, times_.depth[index]}, color, depth);
    if (control.on_images) control.on_images(index, color, depth);
    if (request_.labels) writer_.write_labels(t, label_image(frame), speed_image(frame));
    visible_[index] = visible_objects(frame);
  }

  /// Visible objects of each frame; complete once all frames are rendered.
  [[nodiscard]] const std::vector<std::vector<VisibleObject>>& visible() const { return visible_; }

 private:
  [[nodiscard]] RenderedFrame render_ideal_frame(Timestamp t) const {
    const double span_s = std::max(1e-3, request_.color.exposure_s + request_.rolling_shutter_s);
    const Exposure exposure = exposure_at(request_, setup_, t, span_s);
    const double middle_s = seconds_between(setup_.epoch, t);
    const FrameRenderer& renderer =
        changed_ && middle_s >= setup_.change_s ? changed_->renderer : initial_.renderer;
    if (setup_.actors.empty()) return renderer.render(exposure, nullptr);
    const MoverFrame movers =
        assemble_movers(setup_.actors, middle_s - 0.5 * span_s, middle_s + 0.5 * span_s);
    return renderer.render(exposure, &movers);
  }

  static cv::Mat label_image(const RenderedFrame& frame) {
    cv::Mat labels(frame.height, frame.width, CV_8UC1);
    std::transform(frame.object.begin(), frame.object.end(), labels.begin<std::uint8_t>(),
                   [](std::uint16_t object) { return static_cast<std::uint8_t>(object); });
    return labels;
  }

  /// Speeds [cm/s], saturated at 255.
  static cv::Mat speed_image(const RenderedFrame& frame) {
    cv::Mat motion(frame.height, frame.width, CV_8UC1);
    std::transform(frame.speed_m_per_s.begin(), frame.speed_m_per_s.end(), motion.begin<std::uint8_t>(),
                   [](float speed) { return cv::saturate_cast<std::uint8_t>(100.0F * speed); });
    return motion;
  }

  const SynthRequest& request_;
  const SceneSetup& setup_;
  const FrameTimes& times_;
  const SequenceWriter& writer_;
  WorldRenderer initial_;
  std::optional<WorldRenderer> changed_;
  std::vector<std::vector<VisibleObject>> visible_;
};

/// One set per frame.
struct SequenceBoxes {
  std::vector<DetectionSet> truth;
  std::vector<DetectionSet> detections;  ///< of the simulated detector; without boxes in a static scene
};

SequenceBoxes boxes_of(const SynthRequest& request, const SceneSetup& setup,
                       const std::vector<Timestamp>& times,
                       const std::vector<std::vector<VisibleObject>>& visible) {
  std::vector<std::vector<Detection>> reports(times.size());
  if (!setup.actors.empty()) {
    reports = simulate_detector(visible, request.detector, {request.width, request.height}, request.seed);
  }
  SequenceBoxes boxes;
  for (std::size_t i = 0; i < times.size(); ++i) {
    boxes.truth.push_back({times[i], DetectionState::kPresent, true_detections(visible[i], setup.actors)});
    boxes.detections.push_back({times[i], DetectionState::kPresent, reports[i]});
  }
  return boxes;
}

}  // namespace

bool render_sequence(const SynthRequest& request, const fs::path& folder, const RenderControl& control) {
  check_request(request);
  if (fs::exists(folder))
    throw InputError(folder.string(), "already exists; remove it or choose another folder");
  const SceneSetup setup = make_scene_setup(request);
  const FrameTimes times = frame_times(request, setup);

  TemporaryFolder partial(folder.string() + ".partial-" + std::to_string(::getpid()));
  const SequenceWriter writer(partial.path(), request.layout, request.labels);
  SequenceRenderer work(request, setup, times, writer);
  const auto render = [&](int index) { work.render(static_cast<std::size_t>(index), control); };
  if (!for_each_frame(static_cast<int>(times.color.size()), control, render)) return false;
  const SequenceBoxes boxes = boxes_of(request, setup, times.color, work.visible());
  writer.write_boxes("true_boxes.txt", boxes.truth);
  writer.write_boxes("detections.txt", boxes.detections);
  writer.write_lists(times);
  writer.write_request(request);
  writer.write_rig(setup.rig, request);
  writer.write_imu(setup.imu);
  writer.write_ground_truth(camera_ground_truth(request, setup, times.color));
  partial.rename_to(folder);
  return true;
}

fs::path cached_sequence(const SynthRequest& request, const RenderControl& control) {
  check_request(request);
  // The last path component is the name shown in tables: preset and seed. The key is the parent folder.
  const std::string name = request.preset + "_" + std::to_string(request.seed);
  fs::path folder = datasets::cache_folder() / "synthetic" / request_key(request) / name;
  if (fs::exists(folder / "detections.txt")) return folder;
  fs::remove_all(folder);  // static scenes that were rendered before version 0.3 have no boxes
  try {
    if (!render_sequence(request, folder, control)) return {};
  } catch (const InputError&) {
    if (!fs::is_directory(folder)) throw;  // rendered concurrently by another process: identical result
  }
  return folder;
}

}  // namespace stillpoint::synth
