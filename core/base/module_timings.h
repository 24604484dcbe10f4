// SPDX-License-Identifier: BSD-3-Clause
/// Time spent in each module of the odometry; the modules include the columns of the paper's Table III.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <vector>

namespace stillpoint {

/// The first seven are the columns of Table III; the others subdivide them.
enum class Module : std::uint8_t {
  kFeatureTracking,     ///< prediction, KLT, compaction; per frame
  kFeatureDetection,    ///< cell bookkeeping, FAST, selection; per detecting frame
  kTrackingThread,      ///< everything the tracker does with one frame
  kDynamicRecognition,  ///< semantic mask, missed detection compensation, moving consistency check
  kStateOptimization,   ///< after IMU integration, up to sliding the window: PnP, triangulation, solve,
                        ///< marginalization
  kOptimizationThread,  ///< everything the estimator does with one frame
  kObjectDetection,     ///< one detector call
  kOutlierRejection,    ///< epipolar RANSAC of the tracker
  kFeatureMask,         ///< circular masks
  kWindowSolve,         ///< the nonlinear solve alone
  kMarginalization,     ///< marginalization alone
  kImageDecoding,       ///< reading and decoding images; not part of any thread in the paper
};
inline constexpr std::size_t kModuleCount = 12;

/// Stable name of a module in result files: snake_case, e.g. "feature_tracking".
[[nodiscard]] constexpr std::string_view module_name(Module module) {
  constexpr std::array<std::string_view, kModuleCount> kNames = {
      "feature_tracking",   "feature_detection",   "tracking_thread",  "dynamic_recognition",
      "state_optimization", "optimization_thread", "object_detection", "outlier_rejection",
      "feature_mask",       "window_solve",        "marginalization",  "image_decoding"};
  return kNames[static_cast<std::size_t>(module)];
}

/// Total time and number of calls of one module. Both are needed: Table III averages modules per call and
/// threads per frame.
struct ModuleTime {
  std::int64_t ns = 0;
  std::int64_t calls = 0;
};

/// One timed interval of a module, for timelines.
struct ModuleSpan {
  Module module = Module::kFeatureTracking;
  std::chrono::steady_clock::time_point start;
  std::chrono::nanoseconds elapsed{};
};

/// Timings of one frame by module. Passed along in the messages, so neither locks nor globals are needed.
class ModuleTimings {
 public:
  /// @param span also kept for the timeline
  /// @param calls 0 if the span is only part of a call
  void add(const ModuleSpan& span, int calls) {
    add(span.module, span.elapsed, calls);
    spans_.push_back(span);
  }
  void add(Module module, std::chrono::nanoseconds elapsed, int calls = 1) {
    ModuleTime& entry = times_[static_cast<std::size_t>(module)];
    entry.ns += elapsed.count();
    entry.calls += calls;
  }
  void add(const ModuleTimings& other) {
    for (std::size_t i = 0; i < kModuleCount; ++i) {
      times_[i].ns += other.times_[i].ns;
      times_[i].calls += other.times_[i].calls;
    }
    spans_.insert(spans_.end(), other.spans_.begin(), other.spans_.end());
  }
  /// Spans in order of their end time, grouped by thread. About 14 per frame: drop them if not needed.
  [[nodiscard]] const std::vector<ModuleSpan>& spans() const { return spans_; }
  void drop_spans() { spans_ = {}; }
  /// Resets all timings and keeps the allocated capacity.
  void clear() {
    times_ = {};
    spans_.clear();
  }
  [[nodiscard]] const ModuleTime& operator[](Module module) const {
    return times_[static_cast<std::size_t>(module)];
  }

 private:
  std::array<ModuleTime, kModuleCount> times_{};
  std::vector<ModuleSpan> spans_;
};

/// Adds the time between its construction and its destruction to one module.
class ScopedTimer {
 public:
  /// A module entered several times during one frame counts as one call: all but one of its spans are kPart.
  enum class Kind { kCall, kPart };

  ScopedTimer(ModuleTimings& timings, Module module, Kind kind = Kind::kCall)
      : timings_(timings), module_(module), kind_(kind), start_(std::chrono::steady_clock::now()) {}
  ~ScopedTimer() {
    timings_.add({.module = module_, .start = start_, .elapsed = std::chrono::steady_clock::now() - start_},
                 kind_ == Kind::kCall ? 1 : 0);
  }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  ModuleTimings& timings_;
  Module module_;
  Kind kind_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace stillpoint
