// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/stored_recording.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "bench/model/run_csv.h"
#include "core/base/error.h"
#include "datasets/foxglove/protobuf.h"
#include "eval/metrics/rpe.h"
#include "reports/frames/recording_channels.h"

namespace stillpoint::report {
namespace {

using datasets::ProtobufWriter;

/// What the store has of a run.
struct StoredSeries {
  Trajectory estimate, truth;  ///< of the camera
  std::vector<bench::FrameCounters> counters;
  std::vector<bench::FrameClaim> claims;
  std::vector<bench::TimingSample> timings;
  std::vector<bench::StoredLoop> loops;
};

StoredSeries series_of(const bench::Store& store, const bench::StoredRun& run) {
  const auto text = [&](const char* kind) { return store.attachment(run, kind); };
  const std::string claims = text("claims");
  const std::string loops = text("loops");
  StoredSeries series{.estimate = store.trajectory(run),
                      .truth = store.truth(run),
                      .counters = store.frame_counters(run),
                      .claims = {},
                      .timings = store.timing_samples(run),
                      .loops = {}};
  if (!claims.empty()) series.claims = bench::parse_claims(claims, "status.csv of " + run.key);
  if (!loops.empty()) series.loops = bench::parse_loops(loops, "loops.csv of " + run.key);
  return series;
}

std::optional<Timestamp> first_time(const StoredSeries& series) {
  std::vector<Timestamp> times;
  if (!series.counters.empty()) times.push_back({series.counters.front().t_ns});
  for (const Trajectory* path : {&series.estimate, &series.truth}) {
    if (!path->poses.empty()) times.push_back(path->poses.front().t);
  }
  if (times.empty()) return std::nullopt;
  return *std::ranges::min_element(times);
}

std::string claim_message(const bench::FrameClaim& claim) {
  return ProtobufWriter()
      .bytes(1, datasets::encode_timestamp({claim.t_ns}))
      .integer(2, claim.frame)
      .bytes(3, claim.status)
      .integer(4, claim.segment)
      .number(5, claim.sigma_m)
      .number(6, claim.sigma_rad)
      .take();
}

std::string stored_loop_message(const bench::StoredLoop& loop) {
  return ProtobufWriter()
      .bytes(1, datasets::encode_timestamp(loop.query_t))
      .bytes(3, datasets::encode_timestamp(loop.match_t))
      .integer(7, loop.inliers)
      .number(8, loop.residual_px)
      .bytes(9, loop.accepted ? "accepted" : loop.reason)
      .integer(10, loop.in_map ? 1 : 0)
      .take();
}

void write_poses(const StoredSeries& series, RecordingChannels& channels) {
  channels.write_path("/truth/path", kTruthFrame, series.truth);
  channels.write_path("/estimate/path", world_frame(0), series.estimate);
  for (const StampedPose& pose : series.truth.poses)
    channels.write_pose("/truth", {pose.t, kTruthFrame}, pose.T_w_f);
  for (const StampedPose& pose : series.estimate.poses) {
    channels.write_pose("/estimate", {pose.t, world_frame(0)}, pose.T_w_f);
    channels.write_transform({pose.t, world_frame(0)}, kCameraFrame, pose.T_w_f);
  }
  const std::vector<eval::MatchedPose> matches = eval::strict_matches(series.truth, series.estimate);
  if (!matches.empty()) {
    const auto& [t, gt, est] = matches.front();
    channels.write_transform({t, world_frame(0)}, kTruthFrame, est * gt.inverse());
  }
}

OdometryCounters odometry_counters(const bench::FrameCounters& frame) {
  OdometryCounters counters;
  counters.tracked_features = static_cast<int>(frame.tracked_features);
  counters.window_landmarks = static_cast<int>(frame.window_landmarks);
  counters.depth_landmarks = static_cast<int>(frame.depth_landmarks);
  counters.dynamic_features = static_cast<int>(frame.dynamic_features);
  counters.solver_iterations = static_cast<int>(frame.solver_iterations);
  counters.keyframe = frame.keyframe;
  counters.reset = frame.reset;
  return counters;
}

/// Status, claims and times of each frame.
void write_frames(const StoredSeries& series, RecordingChannels& channels) {
  std::map<std::int64_t, int> segments;
  for (const bench::FrameClaim& claim : series.claims) {
    segments[claim.frame] = claim.segment;
    channels.write("/claims", "stillpoint.Claim", {claim.t_ns}, claim_message(claim));
  }
  auto timing = series.timings.begin();
  for (const bench::FrameCounters& frame : series.counters) {
    const auto segment = segments.find(frame.frame);
    channels.write("/status", "stillpoint.Status", {frame.t_ns},
                   encode_status({.t = {frame.t_ns},
                                  .frame = frame.frame,
                                  .status = frame.status,
                                  .reason = "",
                                  .segment = segment == segments.end() ? 0 : segment->second,
                                  .counters = odometry_counters(frame)}));
    while (timing != series.timings.end() && timing->frame < frame.frame) ++timing;
    const auto begin = timing;
    while (timing != series.timings.end() && timing->frame == frame.frame) ++timing;
    if (timing != begin)
      channels.write("/timings", "stillpoint.Timings", {frame.t_ns},
                     encode_timings({frame.t_ns}, frame.frame, {begin, timing}));
  }
}

/// The annotated images, at the times of their frames. @return their number
std::size_t write_stored_images(const bench::Store& store, const bench::StoredRun& run,
                                const StoredSeries& series, RecordingChannels& channels) {
  std::size_t count = 0;
  for (const auto& [kind, blob] : run.blobs) {
    if (!kind.starts_with(bench::kImageKind)) continue;
    const std::string_view digits = std::string_view(kind).substr(bench::kImageKind.size());
    std::int64_t frame = -1;
    std::from_chars(digits.data(), digits.data() + digits.size(), frame);
    const auto found = std::ranges::find(series.counters, frame, &bench::FrameCounters::frame);
    if (found == series.counters.end()) continue;
    const Timestamp t{found->t_ns};
    channels.write("/camera/image", "foxglove.CompressedImage", t,
                   datasets::encode_jpeg_message({t, kCameraFrame}, store.attachment(run, kind)));
    ++count;
  }
  return count;
}

}  // namespace

StoredRecording write_stored_recording(const std::filesystem::path& file, const bench::Store& store,
                                       const bench::StoredRun& run) {
  const StoredSeries series = series_of(store, run);
  const std::optional<Timestamp> first = first_time(series);
  if (!first)
    throw InputError("run " + run.key, "has neither poses nor counters, of which a recording is made");
  if (first->ns < 0)
    throw InputError("run " + run.key, "has negative times, which MCAP files do not have; omit --mcap");
  RecordingChannels channels(file, *first);
  write_poses(series, channels);
  write_frames(series, channels);
  for (const bench::StoredLoop& loop : series.loops)
    channels.write("/loops", "stillpoint.Loop", loop.query_t, stored_loop_message(loop));
  const std::size_t images = write_stored_images(store, run, series, channels);
  channels.finish();
  StoredRecording recording{.missing = {"inertial samples and biases", "full covariances", "features",
                                        "boxes", "landmarks", "the calibration", "the pose of the body"}};
  const auto add = [&](bool is_empty, const char* what) {
    if (is_empty) recording.missing.emplace_back(what);
  };
  add(series.estimate.poses.empty(), "the estimate");
  add(series.truth.poses.empty(), "the ground truth");
  add(series.counters.empty(), "status and counters");
  add(series.claims.empty(), "claimed deviations");
  add(series.timings.empty(), "timings");
  add(images == 0, "images");
  return recording;
}

}  // namespace stillpoint::report
