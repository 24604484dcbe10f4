// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "datasets/synthetic/sequence/sequence_writer.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

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

}  // namespace stillpoint::synth
