// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render_sequence.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/sequence_writer.h"
#include "datasets/synthetic/stage.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Calls `work(index)` for all indices below `count`, each once, from several threads; the first error ends
/// all.
/// @return false if it was stopped
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

/// A folder that vanishes unless it is kept.
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
  void keep_as(const fs::path& name) {
    std::error_code error;
    fs::rename(path_, name, error);
    if (error)
      throw InputError(name.string(), "cannot be made (" + error.message() + "); choose another folder");
  }

 private:
  fs::path path_;
};

/// What is done with each frame.
class FrameWork {
 public:
  FrameWork(const SynthRequest& request, const Stage& stage, const std::vector<Timestamp>& times,
            const SequenceWriter& writer)
      : request_(request),
        stage_(stage),
        times_(times),
        writer_(writer),
        tracer_(stage.scene.world),
        renderer_(stage.scene.world, tracer_, stage.rig.camera),
        seen_(times.size()) {}

  /// Safe for different frames at once.
  void render(std::size_t index) {
    const Timestamp t = times_[index];
    const RenderedFrame frame = draw(t);
    const double gain = stage_.scene.gain * exposure_gain(request_.color, seconds_between(times_.front(), t));
    const std::uint64_t color_key = random_key(request_.seed, RandomStream::kColorNoise, index);
    const std::uint64_t depth_key = random_key(request_.seed, RandomStream::kDepthNoise, index);
    writer_.write_pictures(
        t, develop(frame, stage_.rig.camera, request_.color, gain, color_key),
        measure_depth(frame.depth_m, frame.width, frame.height, request_.depth, depth_key));
    if (request_.labels) writer_.write_labels(t, label_picture(frame), motion_picture(frame));
    seen_[index] = seen_objects(frame);
  }

  /// What is seen in each frame, once all are rendered.
  [[nodiscard]] const std::vector<std::vector<SeenObject>>& seen() const { return seen_; }

 private:
  [[nodiscard]] RenderedFrame draw(Timestamp t) const {
    const double span_s = std::max(1e-3, request_.color.exposure_s + request_.rolling_shutter_s);
    const Shot shot = shot_at(request_, stage_, t, span_s);
    if (stage_.actors.empty()) return renderer_.render(shot, nullptr);
    const double middle_s = seconds_between(stage_.epoch, t);
    const MoverFrame movers =
        assemble_movers(stage_.actors, middle_s - 0.5 * span_s, middle_s + 0.5 * span_s);
    return renderer_.render(shot, &movers);
  }

  static cv::Mat label_picture(const RenderedFrame& frame) {
    cv::Mat labels(frame.height, frame.width, CV_8UC1);
    std::transform(frame.object.begin(), frame.object.end(), labels.begin<std::uint8_t>(),
                   [](std::uint16_t object) { return static_cast<std::uint8_t>(object); });
    return labels;
  }

  /// Speeds [cm/s], cut at 255.
  static cv::Mat motion_picture(const RenderedFrame& frame) {
    cv::Mat motion(frame.height, frame.width, CV_8UC1);
    std::transform(frame.speed_m_per_s.begin(), frame.speed_m_per_s.end(), motion.begin<std::uint8_t>(),
                   [](float speed) { return cv::saturate_cast<std::uint8_t>(100.0F * speed); });
    return motion;
  }

  const SynthRequest& request_;
  const Stage& stage_;
  const std::vector<Timestamp>& times_;
  const SequenceWriter& writer_;
  RayTracer tracer_;
  FrameRenderer renderer_;
  std::vector<std::vector<SeenObject>> seen_;
};

void write_boxes(const SynthRequest& request, const Stage& stage, const std::vector<Timestamp>& times,
                 const std::vector<std::vector<SeenObject>>& seen, const SequenceWriter& writer) {
  const auto reports = simulate_detector(seen, request.detector, request.width, request.height, request.seed);
  std::vector<DetectionSet> detections, truth;
  for (std::size_t i = 0; i < times.size(); ++i) {
    truth.push_back({times[i], DetectionState::kPresent, true_detections(seen[i], stage.actors)});
    detections.push_back({times[i], DetectionState::kPresent, reports[i]});
  }
  writer.write_boxes("true_boxes.txt", truth);
  writer.write_boxes("detections.txt", detections);
}

}  // namespace

bool render_sequence(const SynthRequest& request, const fs::path& folder, const RenderControl& control) {
  check_request(request);
  if (fs::exists(folder))
    throw InputError(folder.string(), "exists already; remove it or choose another folder");
  const Stage stage = make_stage(request);
  const std::vector<Timestamp> times = frame_times(request, stage);

  TemporaryFolder partial(folder.string() + ".partial-" + std::to_string(::getpid()));
  const SequenceWriter writer(partial.path(), request.layout, request.labels);
  FrameWork work(request, stage, times, writer);
  const auto render = [&work](int index) { work.render(static_cast<std::size_t>(index)); };
  if (!for_each_frame(static_cast<int>(times.size()), control, render)) return false;
  if (!stage.actors.empty()) write_boxes(request, stage, times, work.seen(), writer);
  writer.write_lists(times);
  writer.write_request(request);
  writer.write_rig(stage.rig, request);
  writer.write_inertia(stage.inertia);
  writer.write_ground_truth(camera_truth(request, stage));
  partial.keep_as(folder);
  return true;
}

}  // namespace stillpoint
