// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/run_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "bench/config/config_file.h"
#include "bench/config/config_hash.h"
#include "bench/model/run_csv.h"
#include "bench/profile/timeline.h"
#include "bench/record/result_values.h"
#include "bench/run/rig_report.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "eval/io/trajectory_file.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;

Json skipped_json(const std::vector<SkippedFrame>& skipped) {
  Json list = Json::array();
  for (const SkippedFrame& frame : skipped)
    list.push_back({{"index", frame.index}, {"reason", frame.reason}});
  return list;
}

Json timing_json(const TimingSamples& samples, bool threads) {
  Json table = Json::object();
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    const auto module = static_cast<Module>(i);
    const std::optional<TimingStatistics> statistics = samples.statistics(module);
    if (is_thread(module) != threads || !statistics) continue;
    table[std::string(module_name(module))] = {{"mean", statistics->mean},
                                               {"median", statistics->median},
                                               {"p95", statistics->p95},
                                               {"max", statistics->max},
                                               {"calls", statistics->calls}};
  }
  return table;
}

Json matrix_json(const std::optional<Eigen::Matrix2d>& matrix) {
  if (!matrix) return nullptr;
  const Eigen::Matrix2d& m = *matrix;
  return {{m(0, 0), m(0, 1)}, {m(1, 0), m(1, 1)}};
}

/// Fraction of the frames that the recorded boxes lack; nullopt without recorded boxes or frames.
std::optional<double> fraction_without_boxes(const RunSummary& summary) {
  const std::optional<std::int64_t>& unrecorded = summary.detector_counters.unrecorded;
  if (!unrecorded || summary.frames == 0) return std::nullopt;
  return static_cast<double>(*unrecorded) / static_cast<double>(summary.frames);
}

Json detector_json(const RunSummary& summary) {
  const DetectorCounters& counters = summary.detector_counters;
  return {{"description", summary.detector},
          {"processed", counters.processed},
          {"skipped", counters.skipped},
          {"boxes", counters.boxes},
          {"clipped", counters.clipped},
          {"rejected", counters.rejected},
          {"fraction_without_boxes", number_or_null(fraction_without_boxes(summary))}};
}

Json realtime_json(const RunSummary& summary) {
  if (!summary.realtime) return nullptr;
  const RealtimeReport& report = *summary.realtime;
  const auto latency = [&](double p) { return eval::percentile(report.latencies_ms, p).value_or(0.0); };
  return {{"deadline_ms", report.deadline_ms},
          {"dropped_frames", report.dropped},
          {"late_detections", report.late_detections},
          {"deadline_misses", report.deadline_misses()},
          {"latency_ms", {{"p50", latency(0.5)}, {"p95", latency(0.95)}, {"p99", latency(0.99)}}}};
}

Json labels_json(const OdometryRun& run) {
  if (!run.label_score) return nullptr;
  const auto group = [](const LabelScore::Group& of) -> Json {
    return {
        {"features", of.all}, {"flagged", of.flagged}, {"flagged_ratio", number_or_null(of.flagged_ratio())}};
  };
  return {{"precision", number_or_null(run.label_score->precision())},
          {"people", group(run.label_score->people)},
          {"undetectable_objects", group(run.label_score->undetectable_objects)},
          {"background", group(run.label_score->background)}};
}

/// Time that the odometry waited for decoded frames; null if it was not measured.
Json image_waits_s(const RunSummary& summary) {
  const auto waits = std::ranges::find(summary.waits, kDecodedFrames, &ChannelWaits::channel);
  if (waits == summary.waits.end()) return nullptr;
  return 1e-9 * static_cast<double>(waits->for_items.ns);
}

Json lens_json(const Eigen::Vector4d& lens) {
  return {{"focal", lens[0]}, {"k1", lens[1]}, {"center_x", lens[2]}, {"center_y", lens[3]}};
}

/// The report on the rig: a result per parameter.
Json rig_report_json(const EstimatedCalibration& calibration) {
  Json report = Json::array();
  for (const RigFinding& finding : rig_report(calibration)) {
    report.push_back({{"parameter", finding.parameter},
                      {"result", result_name(finding.result)},
                      {"difference", finding.difference},
                      {"sigma", finding.sigma}});
  }
  return report;
}

Json calibration_json(const EstimatedCalibration& calibration) {
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
  const auto& [q, p] = calibration.T_b_c;
  return {{"time_offset_s", calibration.time_offset_s},
          {"time_offset_sigma_s", or_null(calibration.time_offset_sigma_s)},
          {"depth_scale", calibration.depth_scale},
          {"depth_scale_sigma", or_null(calibration.depth_scale_sigma)},
          {"lens_correction", lens_json(calibration.lens)},
          {"lens_sigma", calibration.lens_sigma ? lens_json(*calibration.lens_sigma) : Json(nullptr)},
          {"T_b_c", {{"p_m", {p.x(), p.y(), p.z()}}, {"q_xyzw", {q.x(), q.y(), q.z(), q.w()}}}},
          {"extrinsics_sigma_m", or_null(calibration.extrinsics_sigma_m)},
          {"extrinsics_sigma_rad", or_null(calibration.extrinsics_sigma_rad)},
          {"agrees_with_rig",
           {{"extrinsics", or_null(calibration.extrinsics_agree)},
            {"depth_scale", or_null(calibration.depth_scale_agrees)},
            {"lens", or_null(calibration.lens_agrees)}}},
          {"frames_at_bound",
           {{"time_offset", calibration.time_offset_at_bound},
            {"extrinsics", calibration.extrinsics_at_bound},
            {"depth_scale", calibration.depth_scale_at_bound}}}};
}

/// Hash of the detector's network weights; null without a network.
Json weights_json(const DetectorConfig& detector) {
  if (detector.kind != DetectorKind::kNetwork) return nullptr;
  std::ifstream file(detector.weights, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return hash_text(content_hash(bytes));
}

std::string manifest_json(const RunManifest& manifest) {
  Json config = Json::object();
  // These values have the same syntax in TOML and JSON.
  for (const auto& [key, value] : config_entries(manifest.config)) config[key] = Json::parse(value);
  Json json;
  json["schema"] = 1;
  json["started"] = manifest.started;
  json["sequence"] = {
      {"name", manifest.sequence},
      {"format", manifest.sequence_format},
      {"checksum", manifest.sequence_checksum.empty() ? Json(nullptr) : Json(manifest.sequence_checksum)}};
  json["faults"] = manifest.faults;
  json["config"] = {{"base", manifest.base},
                    {"variant", manifest.variant},
                    {"hash", config_hash(manifest.config)},
                    {"resolved", config}};
  json["map"] = nullptr;
  if (!manifest.map_checksum.empty()) json["map"] = {{"checksum", manifest.map_checksum}};
  json["mode"] = manifest.mode;
  json["seed"] = manifest.config.seed;
  json["weights"] = weights_json(manifest.config.detector);
  json["threads"] = {{"odometry", 1},
                     {"detection_pool", manifest.config.frontend.grid.threads},
                     {"decoding", kMaxDecodingThreads}};
  json["build"] = {{"version", manifest.build.version},         {"git_commit", manifest.build.git_commit},
                   {"git_time", manifest.build.git_time},       {"git_dirty", manifest.build.git_dirty},
                   {"git_changes", manifest.build.git_changes}, {"type", manifest.build.build_type},
                   {"compiler", manifest.build.compiler},       {"flags", manifest.build.flags},
                   {"packages", manifest.build.packages}};
  json["host"] = host_json(manifest.host);
  return json.dump(kIndent) + "\n";
}

/// Time per frame and module of the odometry.
std::string timings_csv(const OdometryRun& run) {
  std::vector<TimingSample> samples;
  for (std::size_t frame = 0; frame < run.frame_timings.size(); ++frame) {
    for (std::size_t i = 0; i < kModuleCount; ++i) {
      const auto module = static_cast<Module>(i);
      const ModuleTime& time = run.frame_timings[frame][module];
      if (time.calls == 0 || module == Module::kImageDecoding) continue;
      samples.push_back({.frame = static_cast<std::int64_t>(frame),
                         .module = std::string(module_name(module)),
                         .ns = time.ns,
                         .calls = time.calls});
    }
  }
  return timing_text(samples);
}

/// Hash of each module's state after each frame.
std::string frames_csv(const OdometryRun& run) {
  std::string text = "frame,tracking,dynamic,optimization\n";
  for (std::size_t frame = 0; frame < run.frame_hashes.size(); ++frame) {
    const StateHashes& hashes = run.frame_hashes[frame];
    text += std::to_string(frame) + "," + hash_text(hashes.tracking) + "," + hash_text(hashes.dynamic) + "," +
            hash_text(hashes.optimization) + "\n";
  }
  return text;
}

/// Claims about all frames, with the poses that the trajectory does not contain.
std::string status_csv(const OdometryRun& run) {
  std::vector<FrameClaim> claims;
  for (std::size_t i = 0; i < run.claims.size(); ++i) {
    const eval::ClaimedPose& claim = run.claims[i];
    claims.push_back({.frame = run.frame_counters[i].frame,
                      .t_ns = claim.t.ns,
                      .status = run.frame_counters[i].status,
                      .segment = claim.segment,
                      .T_w_c = claim.T_w_c,
                      .sigma_m = claim.sigma_m,
                      .sigma_rad = claim.sigma_rad});
  }
  return claim_text(claims);
}

/// `run` and the modes of `profile` may use the same folder.
std::vector<std::vector<std::string>> marks() {
  return {{"result.json", "manifest.json"}, {"profile.json"}, {"device.json"}, {"instructions.json"}};
}

/// @return the file, unless it contains something else than a heartbeat
const std::filesystem::path& checked(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) &&
      std::filesystem::file_size(file, error) > sizeof(std::int64_t))
    throw InputError(file.string(), "exists and is no heartbeat file; remove it or choose another name");
  return file;
}

}  // namespace

std::string result_json(const RunResult& result) {
  const RunSummary& summary = result.run.summary;
  Json json;
  json["schema"] = 1;
  json["sequence"] = result.sequence;
  json["variant"] = result.variant;
  json["mode"] = result.mode;
  json["status"] = status_name(result.outcome);
  json["failure"] = result.failure.empty() ? Json(nullptr) : Json(result.failure);
  json["frames_planned"] = result.run.frames_planned;
  json.update(metric_members(measurements_of(result)));
  json["skipped_frames"] = skipped_json(summary.skipped);
  json["imu_health"] = {
      {"rejected_samples", summary.imu_health.rejected_samples},
      {"gaps", summary.imu_health.gaps},
      {"noise_factors", {{"gyro", result.run.imu_noise.gyro}, {"accel", result.run.imu_noise.accel}}}};
  json["detector"] = detector_json(summary);
  json["dynamic_features"] = result.run.dynamic_features;
  json["dynamic_labels"] = labels_json(result.run);
  json["realtime"] = realtime_json(summary);
  const Eigen::Quaterniond& q_level_w = result.run.q_level_w;
  json["leveling_rotation_xyzw"] = {q_level_w.x(), q_level_w.y(), q_level_w.z(), q_level_w.w()};
  json["leveling_covariance_rad2"] = matrix_json(result.run.level_covariance);
  json["calibration"] = calibration_json(result.run.calibration);
  json["rig_report"] = rig_report_json(result.run.calibration);
  json["notes"] = result.notes;
  json["warnings"] = result.warnings;
  json["start_s"] = result.start_s;
  json["image_waits_s"] = image_waits_s(summary);
  json["timings"] = {{"unit", "ms"},
                     {"modules", timing_json(result.run.timings, false)},
                     {"threads", timing_json(result.run.timings, true)}};
  return json.dump(kIndent) + "\n";
}

std::string trajectory_text(const RunResult& result) {
  const std::string poses = eval::format_tum(result.run.trajectory);
  return result.outcome == Outcome::kInterrupted ? "# partial: " + result.failure + "\n" + poses : poses;
}

namespace {

/// Removes files that only an earlier command wrote; folders are left.
/// @param names of all files that it may have written
void remove_other_outputs(const std::filesystem::path& folder, const std::vector<std::string>& names,
                          const std::vector<OutputFile>& written) {
  for (const std::string& name : names) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(folder / name, ignored) &&
        std::ranges::find(written, name, &OutputFile::name) == written.end())
      std::filesystem::remove(folder / name, ignored);
  }
}

}  // namespace

void write_run(const std::filesystem::path& folder, const RunResult& result, const RunManifest& manifest) {
  std::vector<OutputFile> files;
  files.push_back({"trajectory.tum", trajectory_text(result)});
  files.push_back({"result.json", result_json(result)});
  files.push_back({"timings.csv", timings_csv(result.run)});
  files.push_back({"frames.csv", frames_csv(result.run)});
  files.push_back({"counters.csv", counter_text(result.run.frame_counters)});
  files.push_back({"status.csv", status_csv(result.run)});
  files.push_back({"stacks.folded", folded_stacks(result.run.spans)});
  files.push_back({"manifest.json", manifest_json(manifest)});
  if (result.run.imu_rate)
    files.push_back({"trajectory_imu.tum", eval::format_tum(result.run.imu_rate->trajectory)});
  if (result.run.loops) {
    files.push_back({"trajectory_loop.tum", eval::format_tum(result.run.loops->causal)});
    files.push_back({"trajectory_optimized.tum", eval::format_tum(result.run.loops->optimized)});
    files.push_back({"loops.csv", loop_text(result.run.loops->report.loops)});
    files.push_back({"keyframes.csv", keyframe_text(result.run.loops->report.keyframes)});
  }
  write_files(folder, files);
  remove_other_outputs(folder, run_layout().names, files);
}

void write_profile(const std::filesystem::path& folder, const std::vector<OutputFile>& files) {
  write_files(folder, files);
  std::vector<std::string> names = profile_layout().names;
  if (std::filesystem::exists(folder / "result.json")) {
    const std::vector<std::string> of_run = run_layout().names;
    std::erase_if(names, [&](const std::string& name) { return std::ranges::count(of_run, name) > 0; });
  }
  remove_other_outputs(folder, names, files);
}

OutputLayout run_layout() {
  return {.names = {"trajectory.tum", "trajectory_imu.tum", "trajectory_loop.tum", "trajectory_optimized.tum",
                    "loops.csv", "keyframes.csv", "result.json", "timings.csv", "frames.csv", "counters.csv",
                    "status.csv", "stacks.folded", "manifest.json", "labels.csv", "cost.svg", "loop_cost.svg",
                    "images", "landmarks.csv", "surfaces.ply"},
          .marks = marks()};
}

OutputLayout video_layout() { return {.names = {"video.mp4", "frames"}, .marks = {{"video.mp4", "frames"}}}; }

OutputLayout profile_layout() {
  return {.names = {"profile.json", "trace.json", "stacks.folded", "device.json", "trajectory.tum",
                    "instructions.json"},
          .marks = marks()};
}

Heartbeat::Heartbeat(const std::filesystem::path& file)
    : descriptor_(open(checked(file).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw InputError(file.string(),
                     std::string("cannot be written: ") + std::strerror(errno) + "; check its folder");
  }
}

Heartbeat::~Heartbeat() { close(descriptor_); }

void Heartbeat::beat(std::int64_t frame) const {
  // One write of 8 bytes, so that a reader never sees a partial number. A failure does not abort the run.
  static_cast<void>(!pwrite(descriptor_, &frame, sizeof frame, 0));
}

std::optional<std::int64_t> read_heartbeat(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::int64_t frame = 0;
  if (!stream.read(reinterpret_cast<char*>(&frame), sizeof frame)) return std::nullopt;
  return frame;
}

}  // namespace stillpoint::bench
