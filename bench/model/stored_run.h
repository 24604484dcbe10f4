// SPDX-License-Identifier: BSD-3-Clause
/// The record of a run in a store: its identity, outcome, metrics and times.
///
/// Replicates of a deterministic run: runs with the same config and data, whose input is perturbed with
/// different seeds (core/pipeline/stages/replication.h). The seed is the last part of the config hash,
/// "0123456789abcdef-perturbed-3", so that replicates have different identities and are recognized as such.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

/// Identity of a run: runs with equal members are executed only once. A sweep varies one config key, its
/// axis.
struct RunIdentity {
  std::string system = "stillpoint";  ///< our odometry, or the name of an external system
  std::string variant;
  std::string sequence;     ///< name in tables
  std::string sequence_id;  ///< checksum of its files, or the key of a rendering
  std::string config_hash;
  std::string build;  ///< git commit, "+" and a hash of the changes when there are any
  std::string mode = "sequential";
  std::string kind = "accuracy";  ///< or "timing"
  std::string cores;              ///< processors that the run may use, e.g. "0,1"; empty = all
  std::int64_t seed = 1;
  std::int64_t repetition = 1;
  std::string axis;  ///< config key that a sweep varies; empty without a sweep
  double axis_value = 0.0;
};

/// Hash of all members, sixteen hexadecimal digits.
[[nodiscard]] std::string run_key(const RunIdentity& identity);

/// How a run ended.
enum class Outcome {
  kOk,
  kLost,         ///< processed all frames with fewer than two poses
  kInterrupted,  ///< stopped on request; the results cover the processed frames. Only in result.json, never
                 ///< in stores
  kCrashed,      ///< terminated by a signal, or exited with an error
  kTimedOut,     ///< killed at its time limit
  kOutOfMemory,  ///< exceeded its memory limit
  kBadData,      ///< invalid sequence or config
};

/// "ok", "lost", "interrupted", "crashed", "timed_out", "out_of_memory" or "bad_data".
[[nodiscard]] std::string outcome_name(Outcome outcome);

/// The member "status" of result.json: as `outcome_name`, but "failed" for `kLost`.
[[nodiscard]] std::string status_name(Outcome outcome);

/// @param name an outcome or a status
/// @throws InputError for any other name
[[nodiscard]] Outcome outcome_of(std::string_view name);

/// A metric of a run. Metrics without data are absent.
struct Metric {
  std::string name;      ///< e.g. "ate_rmse_m"
  std::string protocol;  ///< evaluation protocol, e.g. "compat:tum, 0.02 s, one-to-one, rigid alignment"
  std::string unit;      ///< e.g. "m"; empty for ratios and counts
  double value = 0.0;
};

/// Time spent in one module [ms].
struct ModuleCost {
  std::string module;  ///< e.g. "feature_tracking"
  std::string per;     ///< unit of the statistics: "call", or "frame" for whole threads
  std::int64_t calls = 0;
  double mean_ms = 0.0;
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

/// Time of one frame in one module.
struct TimingSample {
  std::int64_t frame = 0;
  std::string module;
  std::int64_t ns = 0;  ///< sum over all calls
  std::int64_t calls = 0;
};

/// Counters of the odometry for one frame.
struct FrameCounters {
  std::int64_t frame = 0;
  std::int64_t t_ns = 0;  ///< timestamp of the image
  std::string status;     ///< "initializing", "tracking" or "lost"
  std::int64_t tracked_features = 0;
  std::int64_t window_landmarks = 0;
  std::int64_t depth_landmarks = 0;
  std::int64_t dynamic_features = 0;
  std::int64_t solver_iterations = 0;
  bool keyframe = false;
  bool reset = false;
};

/// Prefix of the kinds of attachments that are annotated images; the frame id follows.
inline constexpr std::string_view kImageKind = "image:";

/// Result of a run, as written to a store.
struct RunOutcome {
  Outcome outcome = Outcome::kOk;
  std::string detail;  ///< reason when not ok; else why the errors are doubtful
  std::vector<Metric> metrics;
  std::vector<ModuleCost> costs;
  /// Content by kind: "trajectory" (TUM text), "truth" (TUM text, ground truth in the same coordinate frame),
  /// "timings" (CSV of `TimingSample`), "counters" (CSV of `FrameCounters`), "claims" (CSV of `FrameClaim`),
  /// "frames" (CSV: hash of each module's state after each frame), "stacks" (folded stacks), "image:000042"
  /// (annotated JPEG of frame 42), "result" (JSON), "log".
  std::map<std::string, std::string> attachments;
  std::string manifest;  ///< JSON; empty when the run did not write one
  std::string
      started{};        ///< UTC, ISO 8601, of a run that another store recorded; empty: when it was acquired
  std::string ended{};  ///< same; empty: now
};

/// A completed run, as read from a store.
struct StoredRun {
  std::int64_t id = 0;
  std::string key;
  RunIdentity identity;
  Outcome outcome = Outcome::kOk;
  std::string detail;
  std::string started;  ///< UTC, ISO 8601
  std::string ended;
  std::string manifest_hash;  ///< empty without a manifest
  std::string committed{};    ///< UTC commit time of the build; empty if not in the manifest
  std::string machine{};      ///< CPU model and count: "Intel(R) N100, 4 processors"; empty if unknown
  std::vector<Metric> metrics;
  std::vector<ModuleCost> costs;
  std::map<std::string, std::string> blobs;  ///< kind of attachment -> name of its file
};

/// Value of the first metric with that name, regardless of its protocol.
[[nodiscard]] std::optional<double> metric_value(const StoredRun& run, std::string_view name);

/// The config key of the seed.
inline constexpr std::string_view kPerturbationKey = "pipeline.perturbation_seed";

/// @param hash of the config without the seed
/// @param seed 0: the hash is not changed
[[nodiscard]] std::string perturbed_hash(const std::string& hash, int seed);

/// The hash without the seed, which replicates share.
[[nodiscard]] std::string_view unperturbed_hash(std::string_view config_hash);

/// Whether the hash is that of a perturbed run.
[[nodiscard]] bool is_perturbed(std::string_view config_hash);

/// Current time as recorded in stores and manifests: UTC, ISO 8601, e.g. "2025-01-31T12:00:00Z".
[[nodiscard]] std::string utc_now();

}  // namespace stillpoint::bench
