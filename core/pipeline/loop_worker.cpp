// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/loop_worker.h"

#include <algorithm>
#include <utility>

#include "core/base/thread_name.h"

namespace stillpoint {
namespace {

/// Keyframes that the thread may be behind. The channels have room for all of them, so that pushing never
/// blocks.
constexpr std::size_t kMaxOutstanding = 8;
constexpr std::size_t kMaxOutstandingRealtime = 2;

/// Until the segment is located in the map: largest lag, and frames between two that are looked up. After a
/// number of unsuccessful ones, the place is probably not in the map.
constexpr std::int64_t kLookUpLag = 5;
constexpr std::int64_t kLookUpInterval = 3;
constexpr std::int64_t kLaterLookUpInterval = 15;
constexpr int kEarlyLookUps = 60;

}  // namespace

LoopWorker::LoopWorker(const OdometryConfig& config, const Rig& rig, LoopExecution execution)
    : execution_(execution),
      lag_frames_(config.loop.lag_frames),
      closure_(config.loop, rig.camera, config.imu.enabled),
      to_thread_(kMaxOutstanding),
      from_thread_(kMaxOutstanding) {
  if (execution == LoopExecution::kInline) return;
  thread_ = std::jthread([this] {
    errors_.guard([this] { run(); },
                  [this] {
                    to_thread_.close();
                    from_thread_.close();
                  });
  });
}

LoopWorker::~LoopWorker() {
  to_thread_.close();
  from_thread_.close();
}

void LoopWorker::run() {
  name_this_thread("loop");
  while (std::optional<Job> job = to_thread_.pop()) {
    if (!from_thread_.push(process(std::move(*job)))) return;
  }
}

void LoopWorker::use_map(const KeyframeMap& map) {
  closure_.use_map(map);
  located_ = closure_.is_located();
}

/// Corrections of the segment before do not apply to the world of the new one.
void LoopWorker::enter_segment(int segment) {
  if (segment == segment_) return;
  segment_ = segment;
  T_m_w_ = {};
  located_ = false;
  next_look_up_ = frame_;
  look_ups_ = 0;
}

LoopWorker::Result LoopWorker::process(Job job) {
  const Pose T_m_w = job.is_current ? closure_.locate(job.keyframe) : closure_.add(job.keyframe);
  job.keyframe.gray.release();  // not until it is recycled
  job.keyframe.depth.release();
  return {T_m_w, closure_.is_located(), std::move(job.keyframe)};
}

void LoopWorker::look_up(OptimizationStage& optimization, const OdometryUpdate& update) {
  if (located_ || frame_ < next_look_up_) return;
  std::optional<DepartedKeyframe> frame = optimization.current_frame(update.frame_id);
  if (!frame) return;
  next_look_up_ = frame_ + (++look_ups_ < kEarlyLookUps ? kLookUpInterval : kLaterLookUpInterval);
  add({.keyframe = std::move(*frame), .is_current = true});
}

void LoopWorker::correct(OptimizationStage& optimization, OdometryUpdate& update) {
  enter_segment(update.segment);
  if (std::optional<DepartedKeyframe> keyframe = optimization.take_keyframe()) add({std::move(*keyframe)});
  look_up(optimization, update);
  if (execution_ == LoopExecution::kRealtime) {
    while (std::optional<Result> result = from_thread_.pop_for({})) collect(std::move(*result));
  }
  const auto is_due = [this] {
    return !due_.empty() &&
           (execution_ == LoopExecution::kRealtime ? !results_.empty() : due_.front() <= frame_);
  };
  while (is_due()) {
    if (results_.empty()) collect_next();
    if (results_.front().used.segment == segment_) {
      T_m_w_ = results_.front().T_m_w;
      located_ = results_.front().located;
    }
    optimization.recycle(std::move(results_.front().used));
    results_.erase(results_.begin());
    due_.erase(due_.begin());
  }
  update.T_m_w = T_m_w_;
  update.in_map = located_;
  ++frame_;
}

void LoopWorker::add(Job job) {
  if (execution_ == LoopExecution::kRealtime && outstanding_ >= kMaxOutstandingRealtime) {
    dropped_ += !job.is_current;
    return;
  }
  const std::int64_t due = frame_ + (located_ ? lag_frames_ : std::min(lag_frames_, kLookUpLag));
  due_.push_back(due_.empty() ? due : std::max(due, due_.back()));
  if (execution_ == LoopExecution::kInline) {
    results_.push_back(process(std::move(job)));
    return;
  }
  while (outstanding_ >= kMaxOutstanding) collect_next();
  ++outstanding_;
  to_thread_.push(std::move(job));
}

void LoopWorker::collect(Result result) {
  --outstanding_;
  results_.push_back(std::move(result));
}

void LoopWorker::collect_next() {
  std::optional<Result> result = from_thread_.pop();
  if (!result) {
    errors_.rethrow();
    return collect({T_m_w_, located_, {}});
  }
  collect(std::move(*result));
}

LoopReport LoopWorker::finish(OptimizationStage& optimization) {
  while (std::optional<DepartedKeyframe> keyframe = optimization.take_remaining_keyframe()) {
    while (outstanding_ > 0) collect_next();
    add({std::move(*keyframe)});
    results_.clear();  // later corrections are not causal
  }
  to_thread_.close();
  while (outstanding_ > 0) collect_next();
  if (thread_.joinable()) thread_.join();
  errors_.rethrow();
  LoopReport report = closure_.finish();
  report.dropped_keyframes = dropped_;
  return report;
}

}  // namespace stillpoint
