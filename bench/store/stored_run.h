// SPDX-License-Identifier: BSD-3-Clause
/// What a store holds of one run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// What makes two runs the same run: it is made once. A sweep changes one key, its axis.
struct RunIdentity {
  std::string system = "stillpoint";  ///< our odometry, or the name of an external system
  std::string variant;
  std::string sequence;     ///< as tables name it
  std::string sequence_id;  ///< checksum of its files, or the key of a rendering
  std::string config_hash;
  std::string build;  ///< git commit, "+" and a hash of the changes when there are any
  std::string mode = "sequential";
  std::string kind = "accuracy";  ///< or "timing"
  std::string cores;              ///< the processors it may use, e.g. "0,1"; empty = all
  std::int64_t seed = 1;
  std::int64_t repetition = 1;
  std::string axis;  ///< key that a sweep changes; empty outside one
  double axis_value = 0.0;
};

/// Sixteen hexadecimal digits over every member.
[[nodiscard]] std::string run_key(const RunIdentity& identity);

/// How a run ended.
enum class Outcome {
  kOk,
  kLost,         ///< ran to the end and has no pose
  kCrashed,      ///< ended by a signal, or with an error of its own
  kTimedOut,     ///< ended by us at its time limit
  kOutOfMemory,  ///< could not stay below its memory limit
  kBadData,      ///< the sequence or the config could not be used
};

/// "ok", "lost", "crashed", "timed_out", "out_of_memory" or "bad_data".
[[nodiscard]] std::string outcome_name(Outcome outcome);
/// @throws InputError for any other name
[[nodiscard]] Outcome outcome_of(std::string_view name);

/// One number. A number without data is absent.
struct Metric {
  std::string name;    ///< e.g. "ate_rmse_m"
  std::string recipe;  ///< how it was made, e.g. "compat:tum, 0.02 s, one-to-one, rigid alignment"
  std::string unit;    ///< e.g. "m"; empty for shares and counts
  double value = 0.0;
};

/// Time spent in one module [ms].
struct ModuleCost {
  std::string module;  ///< e.g. "feature_tracking"
  std::string per;     ///< what the statistics are over: "call", or "frame" for whole threads
  std::int64_t calls = 0;
  double mean_ms = 0.0;
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

/// Time that one frame spent in one module.
struct TimingSample {
  std::int64_t frame = 0;
  std::string module;
  std::int64_t ns = 0;  ///< of all calls together
  std::int64_t calls = 0;
};

/// What the odometry counted at one frame.
struct FrameCounters {
  std::int64_t frame = 0;
  std::int64_t t_ns = 0;  ///< time of the picture
  std::string status;     ///< "initialising", "tracking" or "lost"
  std::int64_t tracked_features = 0;
  std::int64_t window_landmarks = 0;
  std::int64_t depth_landmarks = 0;
  std::int64_t dynamic_features = 0;
  std::int64_t solver_iterations = 0;
  bool keyframe = false;
  bool reset = false;
};

/// Beginning of the kinds of attachments that are annotated pictures; the number of the frame follows.
inline constexpr std::string_view kPictureKind = "picture:";

/// What came of a run, as it is put into a store.
struct RunOutcome {
  Outcome outcome = Outcome::kOk;
  std::string detail;  ///< why it is not ok
  std::vector<Metric> metrics;
  std::vector<ModuleCost> costs;
  /// Content by kind: "trajectory" (TUM text), "truth" (likewise, of the same frame of the robot), "timings"
  /// (CSV of `TimingSample`), "counters" (CSV of `FrameCounters`), "frames" (CSV: hash of each module's state
  /// after each frame), "stacks" (folded stacks), "picture:000042" (JPEG of frame 42, annotated), "result"
  /// (JSON), "log".
  std::map<std::string, std::string> attachments;
  std::string manifest;  ///< JSON; empty when the run did not come to write one
};

/// An ended run, as it is read from a store.
struct StoredRun {
  std::int64_t id = 0;
  std::string key;
  RunIdentity identity;
  Outcome outcome = Outcome::kOk;
  std::string detail;
  std::string started;  ///< UTC, ISO 8601
  std::string ended;
  std::string manifest_hash;  ///< empty without a manifest
  std::vector<Metric> metrics;
  std::vector<ModuleCost> costs;
  std::map<std::string, std::string> blobs;  ///< kind of attachment -> name of its file
};

/// Value of the first metric of a name, whatever its recipe.
[[nodiscard]] std::optional<double> metric_value(const StoredRun& run, std::string_view name);

}  // namespace stillpoint
