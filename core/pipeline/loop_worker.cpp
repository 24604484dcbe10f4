// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/loop_worker.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/thread_name.h"

namespace stillpoint {
namespace {

/// Keyframes that the thread may be behind. The channels have room for all of them, so that pushing never
/// blocks.
constexpr std::size_t kMaxOutstanding = 8;
constexpr std::size_t kMaxOutstandingRealtime = 2;

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
  while (std::optional<DepartedKeyframe> keyframe = to_thread_.pop()) {
    if (!from_thread_.push(process(std::move(*keyframe)))) return;
  }
}

LoopWorker::Result LoopWorker::process(DepartedKeyframe keyframe) {
  const Pose T_m_w = closure_.add(keyframe);
  keyframe.gray.release();  // not until it is recycled
  keyframe.depth.release();
  return {T_m_w, std::move(keyframe)};
}

void LoopWorker::correct(OptimizationStage& optimization, OdometryUpdate& update) {
  if (std::optional<DepartedKeyframe> keyframe = optimization.take_keyframe()) add(std::move(*keyframe));
  if (execution_ == LoopExecution::kRealtime) {
    while (std::optional<Result> result = from_thread_.pop_for({})) collect(std::move(*result));
  }
  const auto is_due = [this] {
    return !due_.empty() &&
           (execution_ == LoopExecution::kRealtime ? !results_.empty() : due_.front() <= frame_);
  };
  while (is_due()) {
    if (results_.empty()) collect_next();
    T_m_w_ = results_.front().T_m_w;
    optimization.recycle(std::move(results_.front().used));
    results_.pop_front();
    due_.pop_front();
  }
  update.T_m_w = T_m_w_;
  ++frame_;
}

void LoopWorker::add(DepartedKeyframe keyframe) {
  if (execution_ == LoopExecution::kRealtime && outstanding_ >= kMaxOutstandingRealtime) {
    ++dropped_;
    return;
  }
  due_.push_back(frame_ + lag_frames_);
  if (execution_ == LoopExecution::kInline) {
    results_.push_back(process(std::move(keyframe)));
    return;
  }
  while (outstanding_ >= kMaxOutstanding) collect_next();
  ++outstanding_;
  to_thread_.push(std::move(keyframe));
}

void LoopWorker::collect(Result result) {
  --outstanding_;
  results_.push_back(std::move(result));
}

void LoopWorker::collect_next() {
  std::optional<Result> result = from_thread_.pop();
  if (!result) {
    errors_.rethrow();
    return collect({T_m_w_, {}});
  }
  collect(std::move(*result));
}

LoopReport LoopWorker::finish(OptimizationStage& optimization) {
  while (std::optional<DepartedKeyframe> keyframe = optimization.take_remaining_keyframe()) {
    while (outstanding_ > 0) collect_next();
    add(std::move(*keyframe));
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

void use_map(LoopWorker* loop, const KeyframeMap& map) {
  if (loop == nullptr)
    throw InputError("loop.enabled", "is off, but a map requires loop closure; set it to true");
  loop->use_map(map);
}

std::optional<LoopReport> finish_loops(LoopWorker* loop, OptimizationStage& optimization) {
  if (loop == nullptr) return std::nullopt;
  return loop->finish(optimization);
}

}  // namespace stillpoint
