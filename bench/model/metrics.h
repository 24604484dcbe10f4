// SPDX-License-Identifier: BSD-3-Clause
/// The list of metrics. Result files, stores, tables, reports, the dashboard and comparisons take names,
/// units, margins and descriptions from it. A new metric is one entry of the list in metric_list.cpp and the
/// function that computes its value.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"
#include "core/types/trajectory.h"
#include "eval/metrics/consistency.h"
#include "eval/metrics/loop_metrics.h"
#include "eval/score.h"

namespace stillpoint::bench {

/// Ids that the code refers to by name; all other ids occur only in the list.
namespace metric_id {
inline constexpr std::string_view kAte = "ate_rmse_m";
inline constexpr std::string_view kAteRotation = "ate_rmse_deg";
inline constexpr std::string_view kRpeTranslation = "rpe_trans_rmse_m_per_s";
inline constexpr std::string_view kRpeRotation = "rpe_rot_rmse_deg_per_s";
inline constexpr std::string_view kRpePairs = "rpe_pairs";
inline constexpr std::string_view kRpeTranslationPerDelta = "rpe_rmse_m";
inline constexpr std::string_view kRpeRotationPerDelta = "rpe_rmse_deg";
inline constexpr std::string_view kCorrectRate = "correct_rate";
inline constexpr std::string_view kCoverage = "coverage";
inline constexpr std::string_view kFirstPose = "first_pose_s";
inline constexpr std::string_view kDrift = "drift_percent";
inline constexpr std::string_view kFrames = "frames";
inline constexpr std::string_view kFramesWithoutBoxes = "frames_without_boxes";
inline constexpr std::string_view kWallTime = "wall_s";
inline constexpr std::string_view kOtherLoad = "other_load";
inline constexpr std::string_view kQuiet = "quiet";
inline constexpr std::string_view kModuleTime = "ms";  ///< of each module; stored under the module's name
inline constexpr std::string_view kFailedRuns = "failed_runs";
inline constexpr std::string_view kFalseConfidence = "false_confidence";
inline constexpr std::string_view kMissedAvailability = "missed_availability";
inline constexpr std::string_view kTimeToDetect = "time_to_detect_s";
inline constexpr std::string_view kTimeToRecover = "time_to_recover_s";
inline constexpr std::string_view kErrorAfterRecovery = "error_after_recovery_m";
inline constexpr std::string_view kClaimedThreeSigma = "claimed_three_sigma_m";
inline constexpr std::string_view kNeesPosition = "nees_position";
inline constexpr std::string_view kNeesRotation = "nees_rotation";
}  // namespace metric_id

/// A trajectory, its ground truth in the same coordinate frame, and their score.
struct ScoredTrajectory {
  const Trajectory& gt;
  const Trajectory& est;
  const eval::Score& score;
};

/// Counts of a run of the odometry.
struct RunCounts {
  std::size_t frames = 0;  ///< processed
  std::size_t poses = 0;
  int resets = 0;
  std::size_t segments = 0;                            ///< world frames with located poses
  std::optional<std::int64_t> frames_without_boxes{};  ///< nullopt unless the run used recorded boxes
  double wall_s = 0.0;
  std::optional<double> claimed_three_sigma_m{};  ///< see eval/metrics/consistency.h
  std::optional<eval::MeanNees> nees{};           ///< with a ground truth
  std::optional<double> nis_reprojection{};       ///< see core/backend/vision/vision_assessment.h
  std::optional<double> nis_inertial{};           ///< same
};

/// Resources used by the process of a run.
struct ProcessCost {
  double wall_s = 0.0;
  double cpu_s = 0.0;                               ///< user and system time of all threads
  std::optional<std::int64_t> peak_memory_bytes{};  ///< nothing if the process ended before it was measured
};

/// Errors of the poses at IMU rate; see bench/model/imu_rate_metrics.h for the definitions.
struct ImuRateScore {
  std::optional<double> ate_m{};
  std::optional<double> rpe_100ms_m{};
  std::optional<double> rpe_100ms_deg{};
  std::optional<double> rpe_m_per_s{};
  std::optional<double> rpe_deg_per_s{};
  std::optional<double> step_p95_m{};
  std::optional<double> step_max_m{};
  std::optional<double> step_p95_deg{};
  std::optional<double> age_p95_ms{};
  std::optional<double> frame_rate_rpe_100ms_m{};
  std::optional<double> frame_rate_rpe_100ms_deg{};
};

/// Result of loop closure; see bench/model/loop_metrics.h for the definitions.
struct LoopScore {
  std::optional<double> optimized_ate_m{};
  std::optional<double> causal_ate_m{};
  std::size_t loops = 0;
  std::size_t candidates = 0;
  std::size_t keyframes = 0;
  std::optional<double> median_ms{};
  std::optional<eval::RevisitScore> revisits{};  ///< with a ground truth
  std::optional<eval::ErrorAfterLoop> after_first{};
  std::optional<double> relocalization_s{};  ///< in a loaded map
};

/// Energy and throttling of the machine during a run; see bench/model/resource_metrics.h for the definitions.
struct DeviceScore {
  std::optional<double> joules_per_frame{};
  std::optional<double> joules_per_frame_sd{};
  std::optional<double> power_w{};
  std::optional<double> idle_w{};
  std::optional<double> energy_rate_hz{};
  std::optional<double> throttled{};  ///< 1 or 0
  std::optional<double> temperature_c{};
};

/// What metrics are computed from. Its parts are measured at different places; those that were not measured
/// are empty.
struct Measurements {
  std::optional<ScoredTrajectory> scored;
  std::optional<RunCounts> counts;
  std::optional<ImuRateScore> imu_rate;
  std::optional<eval::Honesty> honesty;  ///< of a run with injected faults
  std::optional<LoopScore> loops;        ///< of a run with loop closure
  std::optional<DeviceScore> device{};   ///< if energy or throttling could be read
  std::optional<ProcessCost> process;
  std::optional<double> other_load;                                 ///< CPU load by other processes, 0 to 1
  std::map<std::string, std::int64_t, std::less<>> instructions{};  ///< executed, by stage of the odometry
};

enum class MetricSource {
  kTrajectory,    ///< estimate and ground truth: in result.json, a column of result tables
  kRun,           ///< counts of the run: in result.json
  kHonesty,       ///< run with injected faults: in result.json
  kLoop,          ///< loop closure: in result.json if it was on
  kDevice,        ///< energy and throttling: in result.json if they could be read
  kImuRate,       ///< poses at IMU rate: in result.json if they were recorded
  kProcess,       ///< the process of the run, measured by its parent
  kMachine,       ///< the machine during a timing run
  kInstructions,  ///< execution under valgrind
  kProtocol,      ///< evaluation protocols of a plan, stored as "PROTOCOL/ID"
  kStore,         ///< derived from stored runs
};

enum class MetricDirection { kNone, kSmallerIsBetter, kLargerIsBetter };

enum class MetricFamily {
  kAccuracy,  ///< equal if the trajectories are bit-equal
  kCost,      ///< varies between runs
};

/// Smallest relevant change in a comparison of two builds.
struct MetricGate {
  MetricFamily family = MetricFamily::kAccuracy;
  double margin = 0.0;          ///< relative
  double floor = 0.0;           ///< absolute, in the unit of the metric
  bool repeatable = true;       ///< the same program gives the same value in each run
  bool absent_is_good = false;  ///< no value: there was nothing to measure; else it is a loss
  bool is_fraction = false;     ///< from 0 to 1
};

struct MetricProtocol {
  std::string_view key;   ///< in "protocols" of result.json; empty if it is not listed there
  std::string_view text;  ///< how the metric is measured; empty if there is one way only
};

struct MetricDescriptor {
  std::string_view id;           ///< in files and stores: lower-case words and the unit
  std::string_view label;        ///< table head, without the unit
  std::string_view title;        ///< caption of its table in reports; empty: it has none
  std::string_view description;  ///< one sentence for captions and tooltips
  std::string_view unit;         ///< empty for ratios and counts
  MetricDirection direction = MetricDirection::kNone;
  int decimals = 4;  ///< in tables; 0 for counts
  MetricSource source = MetricSource::kTrajectory;
  MetricProtocol protocol{};
  std::optional<MetricGate> gate{};  ///< nullopt: stored and shown, but not compared
  /// nullopt without data. Null for `kProtocol` and `kStore`, whose values are computed there.
  std::optional<double> (*value)(const Measurements&) = nullptr;
};

/// All metrics, the most important first.
[[nodiscard]] std::span<const MetricDescriptor> all_metrics();

/// Metrics of one source, in the order of the list.
[[nodiscard]] std::vector<const MetricDescriptor*> metrics_of(MetricSource source);

/// The metric that summarizes a run where there is space for only one: the first of the list.
[[nodiscard]] const MetricDescriptor& headline_metric();

/// @return null if the list does not contain it
[[nodiscard]] const MetricDescriptor* find_metric(std::string_view id);

/// As `find_metric`; also null if the metric is not compared.
[[nodiscard]] const MetricDescriptor* gated_metric(std::string_view id);

/// Why a stored value is impossible for its metric: "negative", which values that are compared are not, or
/// "above 1" of a fraction; empty if it is possible.
[[nodiscard]] std::string_view impossibility(const Metric& metric);

/// The id in the name of a stored metric, "PROTOCOL/ID" or "ID".
[[nodiscard]] std::string_view without_protocol(std::string_view name);

/// The value of each metric for which there is data.
[[nodiscard]] std::vector<Metric> measured_metrics(const Measurements& measurements);

/// Label, value and unit: "ATE 0.0123 m".
[[nodiscard]] std::string value_text(const MetricDescriptor& metric, double value);

/// Description with unit and preferred direction.
[[nodiscard]] std::string tooltip(const MetricDescriptor& metric);

/// Tooltip of a stored metric or of a timed module; empty if the name is neither.
[[nodiscard]] std::string tooltip_of(std::string_view name);

}  // namespace stillpoint::bench
