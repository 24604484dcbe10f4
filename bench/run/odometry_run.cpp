// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/odometry_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/run/frame_prefetcher.h"
#include "core/base/error.h"
#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_plausibility.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

double milliseconds(std::int64_t ns, std::int64_t calls) {
  return static_cast<double>(ns) / static_cast<double>(calls) * 1e-6;
}

}  // namespace

FrameCounters counters_of(const OdometryUpdate& update, Timestamp t) {
  const OdometryCounters& counters = update.counters;
  return {.frame = update.frame_id,
          .t_ns = t.ns,
          .status = std::string(status_name(update.status)),
          .tracked_features = counters.tracked_features,
          .window_landmarks = counters.window_landmarks,
          .depth_landmarks = counters.depth_landmarks,
          .dynamic_features = counters.dynamic_features,
          .solver_iterations = counters.solver_iterations,
          .keyframe = counters.keyframe,
          .reset = counters.reset};
}

bool is_thread(Module module) {
  return module == Module::kTrackingThread || module == Module::kOptimizationThread;
}

void TimingSamples::add(Module module, const ModuleTime& frame) {
  if (frame.calls > 0) frames_[static_cast<std::size_t>(module)].push_back(frame);
}

std::optional<TimingStatistics> TimingSamples::statistics(Module module) const {
  return statistics(module, is_thread(module) ? TimePer::kFrame : TimePer::kCall);
}

std::optional<TimingStatistics> TimingSamples::statistics(Module module, TimePer per) const {
  std::vector<double> samples_ms;
  ModuleTime total;
  for (const ModuleTime& frame : frames_[static_cast<std::size_t>(module)]) {
    samples_ms.push_back(milliseconds(frame.ns, per == TimePer::kFrame ? 1 : frame.calls));
    total.ns += frame.ns;
    total.calls += frame.calls;
  }
  if (samples_ms.empty()) return std::nullopt;
  const auto frames = static_cast<std::int64_t>(samples_ms.size());
  return TimingStatistics{.mean = milliseconds(total.ns, per == TimePer::kFrame ? frames : total.calls),
                          .median = eval::percentile(samples_ms, 0.5).value(),
                          .p95 = eval::percentile(samples_ms, 0.95).value(),
                          .p99 = eval::percentile(samples_ms, 0.99).value(),
                          .max = *std::max_element(samples_ms.begin(), samples_ms.end()),
                          .calls = total.calls};
}

std::int64_t TimingSamples::frames_over(Module module, double budget_ms) const {
  const std::vector<ModuleTime>& frames = frames_[static_cast<std::size_t>(module)];
  return std::count_if(frames.begin(), frames.end(),
                       [&](const ModuleTime& frame) { return milliseconds(frame.ns, 1) > budget_ms; });
}

namespace {

[[noreturn]] void throw_missing(const std::filesystem::path& folder, const std::string& problem) {
  const std::string file = datasets::companion_file(folder, "detections.txt").string();
  throw InputError(
      file, problem +
                ", but the config uses recorded boxes (detector.kind = \"recorded\"); record them with "
                "`stillpoint detect " +
                folder.string() + " --out " + file +
                "`, or run without boxes: --set detector.kind=none (in a plan: the variant "
                "NAME+wo_object_detection)");
}

/// Whether a set is at most `tolerance_s` from time `t`.
bool has_set_at(const std::vector<DetectionSet>& sets, Timestamp t, double tolerance_s) {
  const Timestamp earliest = after(t, -tolerance_s);
  const auto found = std::lower_bound(sets.begin(), sets.end(), earliest,
                                      [](const DetectionSet& set, Timestamp time) { return set.t < time; });
  return found != sets.end() && found->t <= after(t, tolerance_s);
}

}  // namespace

void require_recorded_boxes(const OdometryConfig& config, const datasets::SequenceInfo& info) {
  if (used_detector(config) != DetectorKind::kRecorded) return;
  if (info.detections.empty()) require_recorded_boxes(config, info.folder);
  const bool any = std::any_of(info.frame_times.begin(), info.frame_times.end(), [&](Timestamp t) {
    return has_set_at(info.detections, t, kMaxDetectionOffset_s);
  });
  if (!any) {
    throw_missing(info.folder, fmt::format("none of its {} time stamps is within {} s of a frame",
                                           info.detections.size(), kMaxDetectionOffset_s));
  }
}

void require_recorded_boxes(const OdometryConfig& config, const std::filesystem::path& folder) {
  if (used_detector(config) != DetectorKind::kRecorded) return;
  if (!std::filesystem::exists(datasets::companion_file(folder, "detections.txt")))
    throw_missing(folder, "does not exist");
}

namespace {

/// Capacity of the buffer of decoded frames.
constexpr std::size_t kDecodedAhead = 8;
/// The same for cached frames: they are loaded faster than they are used, so the buffer is always full.
constexpr std::size_t kCachedAhead = 3;

std::size_t frames_to_run(const datasets::SequenceInfo& info, std::size_t max_frames) {
  if (info.frame_times.empty()) {
    throw InputError(info.folder.string(), "has no frames; check it with `stillpoint data check`");
  }
  return max_frames == 0 ? info.frame_times.size() : std::min(max_frames, info.frame_times.size());
}

SensorInput input_of(const datasets::SequenceInfo& info, const RunSpec& spec, FramePrefetcher& prefetcher) {
  return {.rig = info.rig,
          .frame_times = std::span(info.frame_times).first(frames_to_run(info, spec.max_frames)),
          .arrivals = info.arrivals,
          .imu = info.imu,
          .detections = info.detections,
          .true_boxes = info.true_boxes,
          .change_detections = info.change_detections,
          .load_frame = [&prefetcher](std::size_t index) { return prefetcher.take(index); },
          .map = spec.map};
}

eval::PoseClaim claim_of(OdometryStatus status) {
  if (is_located(status)) return eval::PoseClaim::kLocated;
  if (status == OdometryStatus::kDeadReckoning) return eval::PoseClaim::kDeadReckoning;
  return status == OdometryStatus::kLost ? eval::PoseClaim::kLost : eval::PoseClaim::kNone;
}

eval::ClaimedPose claim_of(const OdometryUpdate& update, Timestamp t) {
  eval::ClaimedPose claim{
      .t = t, .T_w_c = update.T_w_c, .claim = claim_of(update.status), .segment = update.segment};
  if (!update.covariance) return claim;
  claim.sigma_m = largest_sigma(update.covariance->position());
  claim.sigma_rad = largest_sigma(update.covariance->rotation());
  const Eigen::Matrix3d R_w_b = update.state.T_w_b.R();
  Eigen::Matrix<double, 3, 6> J;  // of the position of the camera
  J << Eigen::Matrix3d::Identity(), -R_w_b * skew((update.state.T_w_b.inverse() * update.T_w_c).p);
  claim.position_covariance = J * update.covariance->pose() * J.transpose();
  claim.rotation_covariance = R_w_b * update.covariance->rotation() * R_w_b.transpose();
  return claim;
}

/// The located poses of each segment.
std::vector<Trajectory> segments_of(std::span<const eval::ClaimedPose> claims) {
  std::vector<Trajectory> segments;
  for (const eval::ClaimedPose& claim : claims) {
    if (claim.claim != eval::PoseClaim::kLocated) continue;
    while (segments.size() <= static_cast<std::size_t>(claim.segment))
      segments.push_back({.frame = "camera", .poses = {}});
    segments[static_cast<std::size_t>(claim.segment)].poses.push_back({claim.t, claim.T_w_c});
  }
  return segments;
}

constexpr int kDepthInterval = 10;  ///< frames per one whose depth is checked

/// Records the output of a runner.
class RunRecorder {
 public:
  RunRecorder(const datasets::SensorStream& stream, const RunSpec& spec)
      : stream_(stream), spec_(spec), drifted_(stream.info()), depth_(stream.info()) {
    if (spec.config.pipeline.imu_rate) imu_rate_.emplace(spec.config, stream.info().imu);
    run_.trajectory.frame = "camera";
    if (spec.config.loop.enabled) {
      run_.loops.emplace().causal.frame = "camera";
      run_.loops->has_map = spec.map != nullptr;
    }
    run_.frames_planned = frames_to_run(stream.info(), spec.max_frames);
    const Rig& rig = stream.info().rig;
    run_.calibration.rig = rig;
    run_.calibration.T_b_c = rig.T_b_c;
    run_.calibration.time_offset_s = rig.time_offset_s;
  }

  [[nodiscard]] std::size_t frames_planned() const { return run_.frames_planned; }

  void add(const FrameReport& report) {
    const auto begin = std::chrono::steady_clock::now();
    const OdometryUpdate& update = report.update;
    record(update);
    if (spec_.keep_spans) record_spans(update);
    if (update.frame_id % kDepthInterval == 0) depth_.add_depth(report.frame);
    // The runner's time of image decoding is the time of waiting for decoded frames.
    decoded_.for_items.ns += update.timings[Module::kImageDecoding].ns;
    decoded_.for_items.waits += update.timings[Module::kImageDecoding].calls;
    run_.recording += std::chrono::steady_clock::now() - begin;
    if (imu_rate_) imu_rate_->add(update, report.available);
    if (spec_.mode != "realtime") score_labels(report);  // decoding labels would slow down the run
  }

  [[nodiscard]] OdometryRun finish(RunSummary summary, double wall_s, const FramePrefetcher& prefetcher) {
    run_.summary = std::move(summary);
    run_.wall_s = wall_s;
    run_.depth_finding = depth_.depth_unit_finding();
    if (imu_rate_) run_.imu_rate = imu_rate_->take();
    if (run_.loops && run_.summary.loops) {
      run_.loops->report = std::move(*run_.summary.loops);
      run_.loops->optimized = optimized_trajectory(segments_of(run_.claims), run_.loops->report);
    }
    if (!spec_.deterministic_counts) run_.summary.waits.push_back(decoded_);
    for (const DecodedFrame& frame : prefetcher.decoded()) record_decoding(frame);
    return std::move(run_);
  }

 private:
  /// If the sequence has ground truth for them.
  void score_labels(const FrameReport& report) {
    drifted_.add(report.tracked);
    if (report.dynamic.labels.empty()) return;
    const std::optional<datasets::MotionLabels> labels =
        stream_.load_labels(static_cast<std::size_t>(report.frame.id));
    if (!labels) return;
    if (!run_.label_score) run_.label_score.emplace();
    run_.label_score->add(report.tracked.features, report.dynamic.labels, *labels, drifted_);
  }

  /// The runner's time of image decoding is left out: the prefetcher measures the decoding itself.
  void record(const OdometryUpdate& update) {
    for (std::size_t i = 0; i < kModuleCount; ++i) {
      const auto module = static_cast<Module>(i);
      if (module != Module::kImageDecoding) run_.timings.add(module, update.timings[module]);
    }
    run_.dynamic_features += update.counters.dynamic_features;
    run_.frame_timings.push_back(update.timings);
    run_.frame_timings.back().drop_spans();
    run_.frame_hashes.push_back(update.hashes);
    const Timestamp t = stream_.info().frame_times[static_cast<std::size_t>(update.frame_id)];
    run_.frame_counters.push_back(counters_of(update, t));
    run_.q_level_w = update.q_level_w;
    if (update.covariance && !update.covariance->gravity.isZero(0.0))
      run_.level_covariance = update.covariance->gravity;
    record_calibration(update);
    run_.imu_noise = update.imu_noise;
    run_.claims.push_back(claim_of(update, t));
    if (!is_located(update.status)) return;
    run_.innovations.push_back(update.nis);
    if (run_.loops && update.in_map) run_.loops->causal.poses.push_back({t, update.T_m_w * update.T_w_c});
    if (update.segment == 0) run_.trajectory.poses.push_back({t, update.T_w_c});
  }

  /// That of the newest located frame: a window that does not fit says nothing about the rig. After a
  /// restart, until its window uses the IMU, the deviations are those before it, and no step is left.
  void record_calibration(const OdometryUpdate& update) {
    EstimatedCalibration& calibration = run_.calibration;
    calibration.time_offset_at_bound += update.at_bound.time_offset;
    calibration.extrinsics_at_bound += update.at_bound.extrinsics;
    calibration.depth_scale_at_bound += update.at_bound.depth_scale;
    if (!is_located(update.status)) return;
    calibration.time_offset_s = update.time_offset_s;
    calibration.depth_scale = update.depth_scale;
    calibration.lens = update.lens;
    calibration.T_b_c = update.state.T_w_b.inverse() * update.T_w_c;
    record_agreement(update,
                     spec_.config.imu.enabled && spec_.config.backend.calibration_agreement_probability > 0.0,
                     calibration);
    calibration.aligned_rotation = update.aligned_rotation;
    if (!update.covariance) return;
    const bool observes = !spec_.config.imu.enabled || update.covariance->inertial;
    calibration.rig_step = observes ? update.rig_step : RigStep{};
    if (!observes) return;
    calibration.time_offset_sigma_s = std::sqrt(update.covariance->time_offset);
    calibration.lens_sigma = update.covariance->lens.diagonal().cwiseSqrt();
    calibration.depth_scale_sigma =
        std::sqrt(update.covariance->depth_scale) * update.depth_scale * update.depth_scale;
    calibration.extrinsics_sigma_m = largest_sigma(update.covariance->extrinsics.topLeftCorner<3, 3>());
    calibration.extrinsics_sigma_rad = largest_sigma(update.covariance->extrinsics.bottomRightCorner<3, 3>());
  }

  void record_spans(const OdometryUpdate& update) {
    for (const ModuleSpan& span : update.timings.spans()) {
      if (span.module != Module::kImageDecoding) run_.spans.push_back({update.frame_id, span});
    }
  }

  void record_decoding(const DecodedFrame& frame) {
    run_.timings.add(Module::kImageDecoding, {.ns = frame.elapsed.count(), .calls = 1});
    if (!spec_.keep_spans) return;
    run_.spans.push_back(
        {.frame = static_cast<std::int64_t>(frame.index),
         .span = {.module = Module::kImageDecoding, .start = frame.start, .elapsed = frame.elapsed}});
  }

  const datasets::SensorStream& stream_;
  const RunSpec& spec_;
  OdometryRun run_;
  std::optional<ImuRatePoses> imu_rate_;
  DriftedTracks drifted_;
  datasets::ImagePlausibility depth_;  ///< of the measurements of some frames
  ChannelWaits decoded_{.channel = kDecodedFrames, .for_items = {}, .for_room = {}};
};

void require_valid(const RunSpec& spec, const datasets::SequenceInfo& info) {
  require_recorded_boxes(spec.config, info);
  if (spec.config.pipeline.imu_rate && !spec.config.imu.enabled)
    throw InputError("pipeline.imu_rate", "requires an IMU; set imu.enabled = true, or leave it out");
  if (std::ranges::find(kRunModes, spec.mode) == kRunModes.end()) {
    throw InputError("--mode",
                     "\"" + spec.mode + "\" is unknown; use \"sequential\", \"pipelined\" or \"realtime\"");
  }
}

/// `run_sequential` on a new thread, whose heap is empty. The state of the main thread's heap, and with it
/// the number of instructions of an allocation, depends on the timing of threads that libraries start.
/// Decoding the first image beforehand makes the decoding library start its threads.
RunSummary run_on_fresh_thread(const datasets::SensorStream& stream, const SensorInput& input,
                               const OdometryConfig& config, const RunControl& control) {
  static_cast<void>(stream.load_frame(0));
  return std::async(std::launch::async, run_sequential, std::cref(input), std::cref(config),
                    std::cref(control))
      .get();
}

ReadAhead read_ahead(const datasets::SensorStream& stream, const RunSpec& spec) {
  const bool fast = stream.frames_are_cached() && !needs_color(spec);
  if (spec.deterministic_counts || (spec.mode == "realtime" && fast)) return {.frames = 0};
  if (fast) return {.frames = kCachedAhead};
  // In real time a second thread would take processor time from the odometry.
  return {.frames = kDecodedAhead, .threads = spec.mode == "realtime" ? 1U : kMaxDecodingThreads};
}

Frame load_frame(const datasets::SensorStream& stream, const RunSpec& spec, std::size_t index) {
  Frame frame = stream.load_frame(index);
  if (needs_color(spec)) frame.color = color_image(frame);
  return frame;
}

}  // namespace

bool needs_color(const RunSpec& spec) {
  return spec.decode_color || spec.config.detector.kind == DetectorKind::kNetwork;
}

void record_agreement(const OdometryUpdate& update, bool compares, EstimatedCalibration& calibration) {
  const auto record = [&](std::optional<bool>& agreement, bool agrees, bool differs) {
    if (agrees || agreement || (compares && differs)) agreement = agrees;
  };
  record(calibration.extrinsics_agree, update.agrees_with_rig.extrinsics, false);
  record(calibration.depth_scale_agrees, update.agrees_with_rig.depth_scale, update.depth_scale != 1.0);
  record(calibration.lens_agrees, update.agrees_with_rig.lens, !update.lens.isZero(0.0));
}

OdometryRun run_odometry(const datasets::SensorStream& stream, const RunSpec& spec, RunControl control) {
  require_valid(spec, stream.info());
  RunRecorder recorder(stream, spec);
  FramePrefetcher prefetcher([&](std::size_t index) { return load_frame(stream, spec, index); },
                             recorder.frames_planned(), read_ahead(stream, spec));
  control.on_frame.emplace(control.on_frame.begin(),
                           [&](const FrameReport& report) { recorder.add(report); });
  const SensorInput input = input_of(stream.info(), spec, prefetcher);
  const auto start = std::chrono::steady_clock::now();
  RunSummary summary;
  if (spec.device) {
    summary = run_on_device(input, spec.config, control, {.device = *spec.device, .speed = spec.speed});
  } else if (spec.mode == "pipelined") {
    summary = run_pipelined(input, spec.config, control);
  } else if (spec.mode == "realtime") {
    summary = run_realtime(input, spec.config, control, spec.speed);
  } else if (spec.deterministic_counts) {
    summary = run_on_fresh_thread(stream, input, spec.config, control);
  } else {
    summary = run_sequential(input, spec.config, control);
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return recorder.finish(std::move(summary), wall_s, prefetcher);
}

}  // namespace stillpoint::bench
