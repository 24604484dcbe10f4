// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/sequence_rendering.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/io/detections_file.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "eval/io/text_reader.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLogFile = "rendering.txt";

/// First rows of the log: "frames COUNT", then one row "object NUMBER CLASS" per moving object.
std::string log_header(std::size_t frames, const ObjectClasses& classes) {
  std::string text = fmt::format("frames {}\n", frames);
  for (const auto& [object, name] : classes) text += fmt::format("object {} {}\n", object, name);
  return text;
}

/// Row of a rendered frame: "frame INDEX TIME_NS COUNT", then number, pixels and box of each visible object.
std::string log_row(std::size_t index, Timestamp t, const std::vector<VisibleObject>& visible) {
  std::string text = fmt::format("frame {} {} {}", index, t.ns, visible.size());
  for (const auto& [object, pixels, box] : visible) {
    text += fmt::format(" {} {} {} {} {} {}", object, pixels, box.x_min, box.y_min, box.x_max, box.y_max);
  }
  return text + "\n";
}

/// The visible objects of a row after "frame INDEX TIME_NS"; nullopt if the row was not written to its end.
std::optional<std::vector<VisibleObject>> read_visible(std::istringstream& row) {
  std::size_t count = 0;
  if (!(row >> count)) return std::nullopt;
  std::vector<VisibleObject> visible(count);
  for (auto& [object, pixels, box] : visible)
    row >> object >> pixels >> box.x_min >> box.y_min >> box.x_max >> box.y_max;
  return row ? std::make_optional(std::move(visible)) : std::nullopt;
}

/// The set after it was written to a file and read again.
DetectionSet as_in_file(const DetectionSet& set) {
  FaultLog strict;
  return datasets::parse_detections(datasets::detections_text({&set, 1}), "rendered boxes", strict).front();
}

ObjectClasses classes_of(const std::vector<Actor>& actors) {
  ObjectClasses classes;
  for (const Actor& actor : actors) classes[actor.object] = actor.class_name;
  return classes;
}

cv::Mat label_image(const RenderedFrame& frame) {
  cv::Mat labels(frame.height, frame.width, CV_8UC1);
  std::transform(frame.object.begin(), frame.object.end(), labels.begin<std::uint8_t>(),
                 [](std::uint16_t object) { return static_cast<std::uint8_t>(object); });
  return labels;
}

/// Speeds [cm/s], saturated at 255.
cv::Mat speed_image(const RenderedFrame& frame) {
  cv::Mat motion(frame.height, frame.width, CV_8UC1);
  std::transform(frame.speed_m_per_s.begin(), frame.speed_m_per_s.end(), motion.begin<std::uint8_t>(),
                 [](float speed) { return cv::saturate_cast<std::uint8_t>(100.0F * speed); });
  return motion;
}

}  // namespace

/// The scene, and what renders it; `render` is thread-safe.
class SequenceRendering::Scenery {
 public:
  explicit Scenery(const SynthRequest& request)
      : request_(request),
        setup_(make_scene_setup(request)),
        times_(frame_times(request, setup_)),
        initial_(setup_.scene.world, setup_.rig.camera) {
    if (setup_.scene.change) changed_.emplace(setup_.scene.change->world, setup_.rig.camera);
  }

  [[nodiscard]] const SceneSetup& setup() const { return setup_; }
  [[nodiscard]] const FrameTimes& times() const { return times_; }

  /// Writes the images of a frame. @return visible objects
  std::vector<VisibleObject> render(std::size_t index, const SequenceWriter& writer,
                                    const ImageCallback& on_images) const {
    const Timestamp t = times_.color[index];
    const BuffersOfFrame buffers(*this);
    const RenderedFrame& frame = render_ideal_frame(t, *buffers);
    const double gain =
        setup_.scene.gain * exposure_gain(request_.color, seconds_between(times_.color.front(), t));
    const std::uint64_t color_key = random_key(request_.seed, RandomStream::kColorNoise, index);
    const std::uint64_t depth_key = random_key(request_.seed, RandomStream::kDepthNoise, index);
    const cv::Mat color = simulate_color(frame, setup_.rig.camera, request_.color, {gain, color_key});
    const cv::Mat depth =
        simulate_depth({frame.depth_m, frame.width, frame.height}, request_.depth, depth_key);
    writer.write_images({t, times_.depth[index]}, color, depth);
    if (on_images) on_images(index, color, depth);
    if (request_.labels) writer.write_labels(t, label_image(frame), speed_image(frame));
    return visible_objects(frame);
  }

 private:
  /// One state of the static world, ready to be rendered.
  struct WorldRenderer {
    WorldRenderer(const World& world, const Camera& camera)
        : tracer(world), renderer(world, tracer, camera) {}
    RayTracer tracer;
    FrameRenderer renderer;
  };

  /// Buffers that no other thread uses.
  class BuffersOfFrame {
   public:
    explicit BuffersOfFrame(const Scenery& scenery) : scenery_(scenery) {
      const std::scoped_lock lock(scenery_.pool_mutex_);
      if (scenery_.pool_.empty()) {
        buffers_ = std::make_unique<RenderBuffers>();
      } else {
        buffers_ = std::move(scenery_.pool_.back());
        scenery_.pool_.pop_back();
      }
    }
    ~BuffersOfFrame() {
      const std::scoped_lock lock(scenery_.pool_mutex_);
      scenery_.pool_.push_back(std::move(buffers_));
    }
    BuffersOfFrame(const BuffersOfFrame&) = delete;
    BuffersOfFrame& operator=(const BuffersOfFrame&) = delete;
    RenderBuffers& operator*() const { return *buffers_; }

   private:
    const Scenery& scenery_;
    std::unique_ptr<RenderBuffers> buffers_;
  };

  const RenderedFrame& render_ideal_frame(Timestamp t, RenderBuffers& buffers) const {
    const double span_s = std::max(1e-3, request_.color.exposure_s + request_.rolling_shutter_s);
    const Exposure exposure = exposure_at(request_, setup_, t, span_s);
    const double middle_s = seconds_between(setup_.epoch, t);
    const FrameRenderer& renderer =
        changed_ && middle_s >= setup_.change_s ? changed_->renderer : initial_.renderer;
    if (setup_.actors.empty()) return renderer.render(exposure, nullptr, buffers);
    const MoverFrame movers =
        assemble_movers(setup_.actors, middle_s - 0.5 * span_s, middle_s + 0.5 * span_s);
    return renderer.render(exposure, &movers, buffers);
  }

  const SynthRequest& request_;
  SceneSetup setup_;
  FrameTimes times_;
  WorldRenderer initial_;
  std::optional<WorldRenderer> changed_;
  mutable std::mutex pool_mutex_;
  mutable std::vector<std::unique_ptr<RenderBuffers>> pool_;  ///< one per thread that renders, at most
};

SequenceRendering::SequenceRendering(const SynthRequest& request, fs::path folder)
    : request_(request),
      folder_(std::move(folder)),
      writer_(folder_, request.layout, request.labels),
      detector_(request.detector, {request.width, request.height}, request.seed) {
  if (!continue_log()) begin();
  open_log();
  if (rendered_ == frames_.size()) write_boxes();
}

SequenceRendering::~SequenceRendering() = default;

/// Reads the log of an earlier rendering. @return false if there is none
bool SequenceRendering::continue_log() {
  std::ifstream log(folder_ / kLogFile);
  std::string text, kind;
  std::size_t count = 0;
  if (!std::getline(log, text) || !(std::istringstream(text) >> kind >> count) || kind != "frames" ||
      count == 0)
    return false;
  frames_.resize(count);
  while (std::getline(log, text)) {
    std::istringstream row(text);
    std::size_t index = 0;
    FrameRecord frame{.state = State::kRendered, .t = {}, .visible = {}};
    row >> kind;
    if (int object = 0; kind == "object" && row >> object) row >> classes_[object];
    if (kind != "frame" || !(row >> index >> frame.t.ns) || index >= count) continue;
    std::optional<std::vector<VisibleObject>> visible = read_visible(row);
    if (!visible) continue;
    frame.visible = std::move(*visible);
    rendered_ += frames_[index].state == State::kMissing;
    frames_[index] = std::move(frame);
  }
  return true;
}

/// Writes all files but images and boxes, then the header of the log, under a name that exists only then.
void SequenceRendering::begin() {
  const SceneSetup& setup = scenery().setup();
  const FrameTimes& times = scenery().times();
  writer_.write_lists(times);
  writer_.write_request(request_);
  writer_.write_rig(setup.rig, request_);
  writer_.write_imu(setup.imu);
  writer_.write_ground_truth(camera_ground_truth(request_, setup, times.color));
  classes_ = classes_of(setup.actors);
  frames_.resize(times.color.size());
  const fs::path unfinished = folder_ / (std::string(kLogFile) + "." + std::to_string(::getpid()));
  eval::write_text_file(unfinished, log_header(frames_.size(), classes_));
  std::error_code exists_already;  // written by another process: the same header
  fs::create_hard_link(unfinished, folder_ / kLogFile, exists_already);
  if (!fs::exists(folder_ / kLogFile)) fs::rename(unfinished, folder_ / kLogFile);  // no hard links here
  fs::remove(unfinished);
}

void SequenceRendering::open_log() {
  const fs::path file = folder_ / kLogFile;
  log_.emplace(::open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  // Ends a row that was not written to its end.
  if (!log_->is_open() || ::write(log_->get(), "\n", 1) != 1)
    throw InputError(file.string(), "cannot be written; check free disk space and folder permissions");
}

SequenceRendering::Scenery& SequenceRendering::scenery() {
  std::call_once(scenery_once_, [this] { scenery_ = std::make_unique<Scenery>(request_); });
  return *scenery_;
}

bool SequenceRendering::is_rendered(std::size_t index) const {
  const std::scoped_lock lock(mutex_);
  return frames_[index].state == State::kRendered;
}

void SequenceRendering::render(std::size_t index, const ImageCallback& on_images) {
  {
    const std::scoped_lock lock(mutex_);
    if (frames_[index].state != State::kMissing) return;
    frames_[index].state = State::kInProgress;
  }
  render_claimed(index, on_images);
}

void SequenceRendering::render_until(std::size_t index) {
  const auto has_state = [](State state) {
    return [state](const FrameRecord& frame) { return frame.state == state; };
  };
  const auto end = frames_.begin() + static_cast<std::ptrdiff_t>(index) + 1;
  std::unique_lock lock(mutex_);
  while (!std::all_of(frames_.begin(), end, has_state(State::kRendered))) {
    const auto missing = std::find_if(frames_.begin(), end, has_state(State::kMissing));
    if (missing == end) {
      changed_.wait(lock);
      continue;
    }
    missing->state = State::kInProgress;
    lock.unlock();
    render_claimed(static_cast<std::size_t>(missing - frames_.begin()), {});
    lock.lock();
  }
}

/// Renders a frame whose state this thread has set to `kInProgress`.
void SequenceRendering::render_claimed(std::size_t index, const ImageCallback& on_images) {
  FrameRecord frame{.state = State::kMissing, .t = {}, .visible = {}};
  try {
    frame.visible = scenery().render(index, writer_, on_images);
    frame.t = scenery().times().color[index];
    const std::string row = log_row(index, frame.t, frame.visible);
    if (::write(log_->get(), row.data(), row.size()) != static_cast<ssize_t>(row.size()))
      throw InputError((folder_ / kLogFile).string(), "cannot be written; check free disk space");
    frame.state = State::kRendered;
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    frames_[index].state = State::kMissing;
    changed_.notify_all();
    throw;
  }
  const std::scoped_lock lock(mutex_);
  frames_[index] = std::move(frame);
  changed_.notify_all();
  if (++rendered_ == frames_.size()) write_boxes();
}

/// Requires the lock.
void SequenceRendering::add_boxes_until(std::size_t index) {
  for (std::size_t i = truth_.size(); i <= index; ++i) {
    const FrameRecord& frame = frames_[i];
    STILLPOINT_CHECK(frame.state == State::kRendered);
    truth_.push_back({frame.t, DetectionState::kPresent, true_detections(frame.visible, classes_)});
    const bool is_static = classes_.empty();
    detections_.push_back({frame.t, DetectionState::kPresent,
                           is_static ? std::vector<Detection>{} : detector_.detect(frame.visible)});
  }
}

FrameBoxes SequenceRendering::boxes(std::size_t index) {
  const std::scoped_lock lock(mutex_);
  add_boxes_until(index);
  return {.truth = as_in_file(truth_[index]), .detections = as_in_file(detections_[index])};
}

/// Completes the folder. Requires the lock, unless called by the constructor.
void SequenceRendering::write_boxes() {
  add_boxes_until(frames_.size() - 1);
  writer_.write_boxes("true_boxes.txt", truth_);
  writer_.write_boxes("detections.txt", detections_);
  fs::remove(folder_ / kLogFile);
}

}  // namespace stillpoint::synth
