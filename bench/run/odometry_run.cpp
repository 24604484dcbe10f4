// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/odometry_run.h"

#include <algorithm>
#include <chrono>
#include <future>

#include "bench/run/frame_prefetcher.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// Capacity of the buffer of decoded frames.
constexpr std::size_t kDecodedAhead = 8;

std::size_t frames_to_run(const datasets::SequenceInfo& info, std::size_t max_frames) {
  if (info.frame_times.empty()) {
    throw InputError(info.folder.string(), "has no frames; check it with `stillpoint data check`");
  }
  return max_frames == 0 ? info.frame_times.size() : std::min(max_frames, info.frame_times.size());
}

SensorInput input_of(const datasets::SequenceInfo& info, std::size_t frames, FramePrefetcher& prefetcher) {
  return {.rig = info.rig,
          .frame_times = std::span(info.frame_times).first(frames),
          .imu = info.imu,
          .detections = info.detections,
          .true_boxes = info.true_boxes,
          .load_frame = [&prefetcher](std::size_t index) { return prefetcher.take(index); }};
}

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

/// Records an update. The runner's time of image decoding is left out: it is the time of waiting for the
/// prefetcher, which measures the decoding itself.
void record(OdometryRun& run, const OdometryUpdate& update, const datasets::SequenceInfo& info) {
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    const auto module = static_cast<Module>(i);
    if (module != Module::kImageDecoding) run.timings.add(module, update.timings[module]);
  }
  run.dynamic_features += update.counters.dynamic_features;
  run.frame_timings.push_back(update.timings);
  run.frame_timings.back().drop_spans();
  run.frame_hashes.push_back(update.hashes);
  const Timestamp t = info.frame_times[static_cast<std::size_t>(update.frame_id)];
  run.frame_counters.push_back(counters_of(update, t));
  if (update.status != OdometryStatus::kTracking) return;
  run.trajectory.poses.push_back({t, update.T_w_c});
}

/// Records the time spans of an update.
void record_spans(OdometryRun& run, const OdometryUpdate& update) {
  for (const ModuleSpan& span : update.timings.spans()) {
    if (span.module != Module::kImageDecoding) run.spans.push_back({update.frame_id, span});
  }
}

/// The runner's time of image decoding is the time of waiting for decoded frames.
void add_wait(ChannelWaits& decoded, const OdometryUpdate& update) {
  decoded.for_items.ns += update.timings[Module::kImageDecoding].ns;
  decoded.for_items.waits += update.timings[Module::kImageDecoding].calls;
}

void score_labels(OdometryRun& run, const FrameReport& report, const datasets::SensorStream& stream,
                  DriftedTracks& drifted) {
  drifted.add(report.tracked);
  if (report.dynamic.labels.empty()) return;
  const std::optional<datasets::MotionLabels> labels =
      stream.load_labels(static_cast<std::size_t>(report.frame.id));
  if (!labels) return;
  if (!run.label_score) run.label_score.emplace();
  run.label_score->add(report.tracked.features, report.dynamic.labels, *labels, drifted);
}

void record_decoding(OdometryRun& run, const FramePrefetcher& prefetcher, bool keep_spans) {
  for (const DecodedFrame& frame : prefetcher.decoded()) {
    run.timings.add(Module::kImageDecoding, {.ns = frame.elapsed.count(), .calls = 1});
    if (!keep_spans) continue;
    run.spans.push_back(
        {.frame = static_cast<std::int64_t>(frame.index),
         .span = {.module = Module::kImageDecoding, .start = frame.start, .elapsed = frame.elapsed}});
  }
}

RunSummary run_in_mode(const RunSpec& spec, const SensorInput& input, const RunControl& control) {
  if (spec.device)
    return run_on_device(input, spec.config, control, {.device = *spec.device, .speed = spec.speed});
  if (spec.mode == "sequential") return run_sequential(input, spec.config, control);
  if (spec.mode == "pipelined") return run_pipelined(input, spec.config, control);
  if (spec.mode == "realtime") return run_realtime(input, spec.config, control, spec.speed);
  throw InputError("--mode",
                   "\"" + spec.mode + "\" is unknown; use \"sequential\", \"pipelined\" or \"realtime\"");
}

/// Runs `work` on a new thread, whose heap is empty. The state of the main thread's heap, and with it the
/// number of instructions of an allocation, depends on the timing of threads that libraries start. Decoding
/// the first image beforehand makes the decoding library start its threads.
template <class Work>
RunSummary on_fresh_thread(const datasets::SensorStream& stream, const Work& work) {
  static_cast<void>(stream.load_frame(0));
  return std::async(std::launch::async, work).get();
}

}  // namespace

OdometryRun run_odometry(const datasets::SensorStream& stream, const RunSpec& spec,
                         const RunControl& control) {
  const datasets::SequenceInfo& info = stream.info();
  OdometryRun run;
  run.trajectory.frame = "camera";
  run.frames_planned = frames_to_run(info, spec.max_frames);
  FramePrefetcher prefetcher([&stream](std::size_t index) { return stream.load_frame(index); },
                             run.frames_planned, spec.deterministic_counts ? 0 : kDecodedAhead);
  ChannelWaits decoded{.channel = "decoded frames", .for_items = {}, .for_room = {}};
  const auto on_update = [&](const OdometryUpdate& update) {
    const auto begin = std::chrono::steady_clock::now();
    record(run, update, info);
    if (spec.keep_spans) record_spans(run, update);
    add_wait(decoded, update);
    run.recording += std::chrono::steady_clock::now() - begin;
    if (control.on_update) control.on_update(update);
  };
  DriftedTracks drifted(info);
  const auto on_frame = [&](const FrameReport& report) {
    // Decoding labels would slow down a real-time run.
    if (spec.mode != "realtime") score_labels(run, report, stream, drifted);
    if (control.on_frame) control.on_frame(report);
  };
  const auto start = std::chrono::steady_clock::now();
  const auto work = [&] {
    return run_in_mode(
        spec, input_of(info, run.frames_planned, prefetcher),
        {.on_update = on_update, .on_frame = on_frame, .stop_requested = control.stop_requested});
  };
  run.summary = spec.deterministic_counts ? on_fresh_thread(stream, work) : work();
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!spec.deterministic_counts) run.summary.waits.push_back(decoded);
  record_decoding(run, prefetcher, spec.keep_spans);
  return run;
}

}  // namespace stillpoint::bench
