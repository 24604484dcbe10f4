// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/threaded_odometry.h"

#include <array>
#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

#include "core/base/bounded_channel.h"
#include "core/base/thread_name.h"
#include "core/pipeline/frame_order.h"
#include "core/pipeline/imu_inbox.h"
#include "core/pipeline/loop_worker.h"
#include "core/pipeline/stages/frame_report.h"
#include "core/pipeline/stages/optimize_frame.h"
#include "core/pipeline/stages/stage_messages.h"
#include "core/pipeline/stages/tracking_stage.h"
#include "core/pipeline/state_predictor.h"
#include "core/pipeline/thread_errors.h"
#include "core/pipeline/window_rate.h"

namespace stillpoint {
namespace {

/// Capacity of the channels between the stages.
constexpr std::size_t kChannelCapacity = 4;

}  // namespace

struct ThreadedOdometry::Impl {
  Impl(const OdometryConfig& configuration, const Rig& calibration, ThreadedOdometryOptions settings);

  void track();
  void detect();
  void optimize();

  /// Closes all channels, so that all threads finish.
  void close();
  void finish_imu();
  void join();
  bool push(FrameJob job);
  void publish(const FrameJob& job, const OdometryUpdate& update);

  OdometryConfig config;
  Rig rig;
  ThreadedOdometryOptions options;
  WindowRate rate;                   ///< tracking thread only
  TrackingStage tracking;            ///< tracking thread only
  OptimizationStage optimization;    ///< optimization thread only
  std::unique_ptr<LoopWorker> loop;  ///< same; null if off
  FrameOrder order;                  ///< thread of `add_frame` only
  ImuInbox imu_of_tracker;
  ImuInbox imu_of_estimator;
  BoundedChannel<FrameJob> frames;
  BoundedChannel<Frame> to_detect{kChannelCapacity};
  BoundedChannel<FrameJob> tracked{kChannelCapacity};
  BoundedChannel<DetectionJob> detected{kChannelCapacity};
  BoundedChannel<TrackerFeedback> feedback;
  ThreadErrors errors;
  std::atomic<bool> accepts_frames = true;
  std::atomic<bool> stopped = false;  ///< queued frames are to be discarded
  std::atomic<std::size_t> dropped = 0;
  std::mutex mutex;
  StatePredictor predictor;             ///< guarded by mutex
  ImuHealth imu_health;                 ///< guarded by mutex
  std::array<std::jthread, 3> threads;  ///< last member: joined before the others are destroyed
};

ThreadedOdometry::Impl::Impl(const OdometryConfig& configuration, const Rig& calibration,
                             ThreadedOdometryOptions settings)
    : config(configuration),
      rig(calibration),
      options(std::move(settings)),
      rate(config.backend.rate_hz),
      tracking(config, rig),
      optimization(config, rig),
      frames(options.queue_capacity),
      feedback(static_cast<std::size_t>(config.pipeline.feedback_lag) + 2),
      predictor(config.imu.max_gap_s) {
  if (config.loop.enabled) loop = std::make_unique<LoopWorker>(config, rig, LoopExecution::kThread);
  // The tracker consumes one message per frame and blocks on an empty channel: the initial messages are the
  // lag.
  for (int i = 0; i <= config.pipeline.feedback_lag; ++i) feedback.push({optimization.feedback(), {}});
  const auto start = [this](void (Impl::*work)()) {
    return std::jthread([this, work] { errors.guard([&] { (this->*work)(); }, [this] { close(); }); });
  };
  threads = {start(&Impl::track), start(&Impl::detect), start(&Impl::optimize)};
}

void ThreadedOdometry::Impl::track() {
  name_this_thread("tracking");
  while (std::optional<FrameJob> job = frames.pop()) {
    const Timestamp t = job->frame.t;
    job->enters_window = rate.admits(t);
    if (job->enters_window && !to_detect.push(job->frame)) return;
    std::optional<TrackerFeedback> message = feedback.pop();
    if (!message) return;
    const double time_offset_s = message->feedback.motion.time_offset_s;
    imu_of_tracker.wait_until(needed_imu(t, config, time_offset_s));
    if (stopped) return;
    imu_of_tracker.feed_until(imu_end_of(t, time_offset_s),
                              [this](const ImuSample& s) { tracking.add_imu(s); });
    job->tracked = tracking.process(job->frame, job->enters_window, message->feedback,
                                    std::move(message->recycled_frame));
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
    const double time_offset_s = optimization.motion_state().time_offset_s;
    imu_of_estimator.wait_until(needed_imu(job->frame.t, config, time_offset_s));
    if (stopped) return;
    imu_of_estimator.feed_until(imu_end_of(job->frame.t, time_offset_s),
                                [this](const ImuSample& s) { optimization.add_imu(s); });
    OdometryUpdate& update = optimize_frame(*job, detections, optimization);
    if (loop) loop->correct(optimization, update);
    publish(*job, update);
    feedback.push({optimization.feedback(std::move(job->feedback)), std::move(job->tracked)});
  }
}

void ThreadedOdometry::Impl::publish(const FrameJob& job, const OdometryUpdate& update) {
  {
    const std::scoped_lock lock(mutex);
    predictor.set(optimization.motion_state(), update.status);
    imu_health = optimization.imu_health();
  }
  if (options.on_update) options.on_update(update);
  if (options.on_frame) {
    options.on_frame({.frame = job.frame,
                      .tracked = job.tracked,
                      .dynamic = optimization.dynamic(),
                      .update = update,
                      .available = imu_end_of(job.frame.t, update.time_offset_s)});
  }
}

void ThreadedOdometry::Impl::close() {
  accepts_frames = false;
  frames.close();
  to_detect.close();
  tracked.close();
  detected.close();
  feedback.close();
  finish_imu();
}

void ThreadedOdometry::Impl::finish_imu() {
  imu_of_tracker.finish();
  imu_of_estimator.finish();
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

void ThreadedOdometry::add_imu(const ImuSample& sample) {
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->predictor.add_imu(sample);
  }
  impl_->imu_of_estimator.add(sample);
  impl_->imu_of_tracker.add(sample);
}

void ThreadedOdometry::finish_imu() { impl_->finish_imu(); }

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
  impl_->finish_imu();
  impl_->join();
  impl_->errors.rethrow();
}

void ThreadedOdometry::stop() noexcept {
  impl_->stopped = true;
  impl_->close();
  impl_->join();
}

std::optional<NavState> ThreadedOdometry::state() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->predictor.state();
}

std::optional<NavState> ThreadedOdometry::state_at(Timestamp t) const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->predictor.state_at(t);
}

void ThreadedOdometry::use_map(const KeyframeMap& map) { stillpoint::use_map(impl_->loop.get(), map); }

std::optional<LoopReport> ThreadedOdometry::finish_loops() {
  return stillpoint::finish_loops(impl_->loop.get(), impl_->optimization);
}

std::size_t ThreadedOdometry::dropped_frames() const { return impl_->dropped; }

ImuHealth ThreadedOdometry::imu_health() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->imu_health;
}

std::vector<ChannelWaits> ThreadedOdometry::waits() const {
  return {impl_->to_detect.waits("frames to detect"), impl_->tracked.waits("tracked frames"),
          impl_->detected.waits("detections"), impl_->feedback.waits("feedback to the tracker")};
}

}  // namespace stillpoint
