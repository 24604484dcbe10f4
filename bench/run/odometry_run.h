// SPDX-License-Identifier: BSD-3-Clause
/// Runs the odometry over a sequence and records its output.
///
/// Statistics of the time per module, as in Paper Table III.
///
/// Checks that a sequence has the recorded boxes that a config requires. Without them a run would mask no
/// dynamic object, and its errors would be taken for those of the method.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "bench/run/run_scores.h"
#include "core/base/module_timings.h"
#include "core/config/odometry_config.h"
#include "core/pipeline/imu_rate_poses.h"
#include "core/pipeline/runners/runner.h"
#include "core/types/rig.h"
#include "core/types/trajectory.h"
#include "datasets/sensor_stream.h"
#include "eval/metrics/consistency.h"

namespace stillpoint::bench {

/// [ms]; modules per call, threads per frame.
struct TimingStatistics {
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;  ///< percentiles interpolate linearly between ranks
  double p99 = 0.0;
  double max = 0.0;
  std::int64_t calls = 0;
};

/// Whether a module is a whole thread of the paper, whose time is reported per frame.
[[nodiscard]] bool is_thread(Module module);

/// Sample of the statistics: the mean time of a frame's calls, or the total time of the frame. Frames without
/// a call are excluded from both.
enum class TimePer { kCall, kFrame };

/// Time per frame and module of a run.
class TimingSamples {
 public:
  /// Adds the time of one frame in a module; ignored without calls.
  void add(Module module, const ModuleTime& frame);

  /// As in the paper: threads per frame, other modules per call. Nothing for a module that was never called.
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module) const;
  [[nodiscard]] std::optional<TimingStatistics> statistics(Module module, TimePer per) const;

  /// Number of frames that spent more than `budget_ms` in a module.
  [[nodiscard]] std::int64_t frames_over(Module module, double budget_ms) const;

 private:
  std::array<std::vector<ModuleTime>, kModuleCount> frames_;
};

/// @throws InputError naming the file and both remedies if the config uses recorded boxes and the sequence
/// has none, or none for any of its frames
void require_recorded_boxes(const OdometryConfig& config, const datasets::SequenceInfo& info);

/// The same for a folder that is not opened yet: only the existence of detections.txt is checked.
void require_recorded_boxes(const OdometryConfig& config, const std::filesystem::path& folder);

/// Names of the execution modes.
inline constexpr std::array<std::string_view, 3> kRunModes = {"sequential", "pipelined", "realtime"};

/// Threads that decode images which are not in the frame cache.
inline constexpr std::size_t kMaxDecodingThreads = 2;

/// Channel in `RunSummary::waits` at which the odometry waits for decoded frames.
inline constexpr const char* kDecodedFrames = "decoded frames";

/// What to run.
struct RunSpec {
  OdometryConfig config;
  std::string mode = "sequential";    ///< or "pipelined" or "realtime"
  double speed = 1.0;                 ///< clock rate of "realtime" and of a device
  std::optional<DeviceModel> device;  ///< simulate the timing of that device; `mode` must be "sequential"
  std::size_t max_frames = 0;         ///< frames from the start; 0 = all
  std::shared_ptr<const KeyframeMap> map;  ///< of an earlier run, for relocalization; requires `loop.enabled`
  bool decode_color = false;               ///< the color image of every frame will be used, e.g. for a video
  bool keep_spans = false;                 ///< record time spans, for timelines
  bool deterministic_counts = false;       ///< without prefetching, "sequential" on a thread with a separate
                                           ///< heap, for reproducible instruction counts
};

/// Time span of a module, and the frame that it processed.
struct FrameSpan {
  std::int64_t frame = 0;
  ModuleSpan span;
};

/// Calibration as estimated at the end of a run.
struct EstimatedCalibration {
  Rig rig;  ///< as it was stated
  double time_offset_s = 0.0;
  double depth_scale = 1.0;
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();  ///< see OdometryUpdate
  Pose T_b_c;                                      ///< extrinsics
  /// Standard deviations, if `backend.covariance` is on; zero if constant. Those of the extrinsics are along
  /// the least certain direction.
  std::optional<double> time_offset_sigma_s, depth_scale_sigma, extrinsics_sigma_m, extrinsics_sigma_rad;
  std::optional<Eigen::Vector4d> lens_sigma;  ///< same
  /// Whether the data agrees with the rig, so that the value is that of the rig; absent if it is not compared
  /// (`backend.calibration_agreement_probability`).
  std::optional<bool> extrinsics_agree, depth_scale_agrees, lens_agrees;
  RigStep rig_step;                                 ///< see `OdometryUpdate`
  std::optional<AlignedRotation> aligned_rotation;  ///< at the start
  int time_offset_at_bound = 0;                     ///< number of frames in which the value was at its bound
  int extrinsics_at_bound = 0;                      ///< same
  int depth_scale_at_bound = 0;                     ///< same
};

/// Takes over whether the calibration of a located frame agrees with the rig.
/// @param compares whether the config compares both: an estimate that differs then contradicts the rig, even
/// if it never agreed, since the first comparison may tell
void record_agreement(const OdometryUpdate& update, bool compares, EstimatedCalibration& calibration);

/// Recorded output of a run.
struct OdometryRun {
  Trajectory trajectory;                  ///< T_w_c, frame "camera"; one pose per tracked frame
  std::vector<eval::ClaimedPose> claims;  ///< per processed frame; the trajectory contains the located ones
                                          ///< of the first segment
  RunSummary summary;
  std::optional<LoopRun> loops;           ///< if `loop.enabled`
  std::optional<ImuRateOutput> imu_rate;  ///< if `pipeline.imu_rate`
  TimingSamples timings;
  std::int64_t dynamic_features = 0;          ///< features labelled as dynamic, summed over frames
  std::optional<LabelScore> label_score;      ///< if the sequence has labels; not in mode "realtime"
  std::vector<ModuleTimings> frame_timings;   ///< per processed frame
  std::vector<FrameSpan> spans;               ///< if `keep_spans`; those of decoding last
  std::vector<StateHashes> frame_hashes;      ///< per processed frame
  std::vector<FrameCounters> frame_counters;  ///< per processed frame
  std::vector<Innovations> innovations;       ///< per located frame
  Eigen::Quaterniond q_level_w = Eigen::Quaterniond::Identity();  ///< of the last update
  std::optional<Eigen::Matrix2d> level_covariance;  ///< of that rotation: `StateCovariance::gravity` [rad^2]
  EstimatedCalibration calibration;
  std::optional<std::string> depth_finding;  ///< `ImagePlausibility::depth_unit_finding` of every tenth frame
  ImuNoiseFactors imu_noise;                 ///< estimate at the end; 1 unless `imu.adapt_noise`
  std::optional<DeviceScore> device;         ///< of the machine, if the caller measured it
  std::size_t frames_planned = 0;
  std::chrono::nanoseconds recording{};  ///< time spent on recording this
  double wall_s = 0.0;                   ///< from the request of the first frame to the last update
};

/// Whether the color image of every frame is used, by a network or a video; it is decoded with the frame
/// then.
[[nodiscard]] bool needs_color(const RunSpec& spec);

/// @param control its callbacks are invoked after the frame was recorded
/// @throws InputError for an unknown mode, a sequence without frames or without the recorded boxes that the
/// config uses, and errors of the runner
[[nodiscard]] OdometryRun run_odometry(const datasets::SensorStream& stream, const RunSpec& spec,
                                       RunControl control);

/// The work of the odometry for the frame at t.
[[nodiscard]] FrameCounters counters_of(const OdometryUpdate& update, Timestamp t);

}  // namespace stillpoint::bench
