// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/threaded_odometry.h"

#include <array>
#include <atomic>
#include <memory>
#include <thread>
#include <utility>

#include "core/base/bounded_channel.h"
#include "core/base/thread_name.h"
#include "core/pipeline/frame_stepper.h"
#include "core/pipeline/thread_errors.h"

namespace stillpoint {
namespace {

/// Capacity of the channels between the stages.
constexpr std::size_t kChannelCapacity = 4;

}  // namespace

struct ThreadedOdometry::Impl {
  Impl(const OdometryConfig& config, const Rig& rig, ThreadedOdometryOptions settings);

  void track();
  void detect();
  void optimize();

  /// Closes all channels, so that all threads finish.
  void close();
  void join();
  bool push(FrameJob job);

  ThreadedOdometryOptions options;
  FrameStepper stepper;
  FrameOrder order;  ///< thread of `add_frame` only
  BoundedChannel<FrameJob> frames;
  BoundedChannel<Frame> to_detect{kChannelCapacity};
  BoundedChannel<FrameJob> tracked{kChannelCapacity};
  BoundedChannel<DetectionJob> detected{kChannelCapacity};
  BoundedChannel<TrackerFeedback> feedback;
  ThreadErrors errors;
  std::atomic<bool> accepts_frames = true;
  std::atomic<bool> stopped = false;  ///< queued frames are to be discarded
  std::atomic<std::size_t> dropped = 0;
  std::array<std::jthread, 3> threads;  ///< last member: joined before the others are destroyed
};

ThreadedOdometry::Impl::Impl(const OdometryConfig& config, const Rig& rig, ThreadedOdometryOptions settings)
    : options(std::move(settings)),
      stepper(config, rig, LoopExecution::kThread),
      frames(options.queue_capacity),
      feedback(static_cast<std::size_t>(config.pipeline.feedback_lag) + 2) {
  // The tracker consumes one message per frame and blocks on an empty channel: the initial messages are the
  // lag.
  for (int i = 0; i <= config.pipeline.feedback_lag; ++i) feedback.push({stepper.feedback(), {}});
  const auto start = [this](void (Impl::*work)()) {
    return std::jthread([this, work] { errors.guard([&] { (this->*work)(); }, [this] { close(); }); });
  };
  threads = {start(&Impl::track), start(&Impl::detect), start(&Impl::optimize)};
}

void ThreadedOdometry::Impl::track() {
  name_this_thread("tracking");
  while (std::optional<FrameJob> job = frames.pop()) {
    const Timestamp t = job->frame.t;
    job->enters_window = stepper.enters_window(t);
    if (job->enters_window && !to_detect.push(job->frame)) return;
    std::optional<TrackerFeedback> message = feedback.pop();
    if (!message) return;
    stepper.wait_for_imu(t, message->feedback.motion.time_offset_s);
    if (stopped) return;
    job->tracked = stepper.track(job->frame, message->feedback, std::move(message->recycled_frame));
    job->feedback = std::move(message->feedback);
    if (!tracked.push(std::move(*job))) return;
  }
  to_detect.close();
  tracked.close();
}

void ThreadedOdometry::Impl::detect() {
  name_this_thread("detection");
  while (const std::optional<Frame> frame = to_detect.pop()) {
    if (stopped) return;
    const auto start = std::chrono::steady_clock::now();
    DetectionJob job{.set = options.detect ? options.detect(*frame) : DetectionSet{.t = frame->t},
                     .timing = {}};
    job.timing = span_since(start, Module::kObjectDetection);
    if (!detected.push(std::move(job))) return;
  }
  detected.close();
}

void ThreadedOdometry::Impl::optimize() {
  name_this_thread("optimization");
  while (std::optional<FrameJob> job = tracked.pop()) {
    std::optional<DetectionJob> detections;
    if (job->enters_window) {
      detections = detected.pop();
      if (!detections) return;
    }
    stepper.wait_for_imu(job->frame.t, stepper.time_offset_s());
    if (stopped) return;
    const OdometryUpdate& update = stepper.optimize(*job, detections);
    notify(options.on_frame, {.frame = job->frame,
                              .tracked = job->tracked,
                              .dynamic = stepper.dynamic(),
                              .update = update,
                              .available = imu_end_of(job->frame.t, update.time_offset_s)});
    feedback.push({stepper.feedback(std::move(job->feedback)), std::move(job->tracked)});
  }
}

void ThreadedOdometry::Impl::close() {
  accepts_frames = false;
  frames.close();
  to_detect.close();
  tracked.close();
  detected.close();
  feedback.close();
  stepper.finish_imu();
}

void ThreadedOdometry::Impl::join() {
  for (std::jthread& thread : threads) {
    if (thread.joinable()) thread.join();
  }
}

bool ThreadedOdometry::Impl::push(FrameJob job) {
  if (!accepts_frames) return false;
  if (options.full_queue == FullQueuePolicy::kBlock) return frames.push(std::move(job));
  const bool lost = frames.push_dropping_oldest(std::move(job)).has_value();
  dropped += lost;
  return !lost;
}

ThreadedOdometry::ThreadedOdometry(const OdometryConfig& config, const Rig& rig,
                                   ThreadedOdometryOptions options)
    : impl_(std::make_unique<Impl>(config, rig, std::move(options))) {}

ThreadedOdometry::~ThreadedOdometry() { stop(); }

void ThreadedOdometry::add_imu(const ImuSample& sample) { impl_->stepper.add_imu(sample); }

void ThreadedOdometry::finish_imu() { impl_->stepper.finish_imu(); }

bool ThreadedOdometry::add_frame(Frame frame, const std::optional<ModuleSpan>& decoding) {
  impl_->errors.rethrow();
  impl_->order.check(frame.t);
  impl_->order.accept(frame.t);
  const bool kept = impl_->push({.frame = std::move(frame), .decoding = decoding});
  if (!kept) impl_->errors.rethrow();
  return kept;
}

void ThreadedOdometry::finish() {
  impl_->accepts_frames = false;
  impl_->frames.close();
  impl_->stepper.finish_imu();
  impl_->join();
  impl_->errors.rethrow();
}

void ThreadedOdometry::stop() noexcept {
  impl_->stopped = true;
  impl_->close();
  impl_->join();
}

std::optional<NavState> ThreadedOdometry::state() const { return impl_->stepper.state(); }

std::optional<NavState> ThreadedOdometry::state_at(Timestamp t) const { return impl_->stepper.state_at(t); }

void ThreadedOdometry::use_map(const KeyframeMap& map) { impl_->stepper.use_map(map); }

std::optional<LoopReport> ThreadedOdometry::finish_loops() { return impl_->stepper.finish_loops(); }

std::size_t ThreadedOdometry::dropped_frames() const { return impl_->dropped; }

ImuHealth ThreadedOdometry::imu_health() const { return impl_->stepper.imu_health(); }

std::vector<ChannelWaits> ThreadedOdometry::waits() const {
  return {impl_->to_detect.waits("frames to detect"), impl_->tracked.waits("tracked frames"),
          impl_->detected.waits("detections"), impl_->feedback.waits("feedback to the tracker")};
}

}  // namespace stillpoint
