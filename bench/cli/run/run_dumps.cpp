// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/run_dumps.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "eval/io/ply_file.h"
#include "reports/drawing/cost_plots.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::bench {

void LabelDump::add(const FrameReport& report) {
  const std::int64_t ns = report.tracked.t.ns;
  const std::string stamp = fmt::format("{}.{:09}", ns / 1'000'000'000, ns % 1'000'000'000);
  auto label = report.dynamic.labels.begin();
  for (const TrackedFeature& feature : report.tracked.features) {
    if (label == report.dynamic.labels.end() || label->id != feature.id) continue;
    fmt::format_to(std::back_inserter(text_), "{},{},{},{:.2f},{:.2f},{:.3f},{},{},{},{}\n",
                   report.tracked.id, stamp, feature.id, feature.pixel.x(), feature.pixel.y(), feature.depth,
                   feature.age, label_name(label->label), reason_name(label->reason),
                   label->residual_px ? fmt::format("{:.3f}", *label->residual_px) : "");
    ++label;
  }
}

namespace {

constexpr const char* kLabelsFile = "labels.csv";
constexpr const char* kCostFile = "cost.svg";
constexpr const char* kLoopCostFile = "loop_cost.svg";
constexpr const char* kImagesFolder = "images";
constexpr const char* kLandmarksFile = "landmarks.csv";
constexpr const char* kSurfacesFile = "surfaces.ply";

std::string cost_svg(const OdometryRun& run) {
  return report::svg_text(report::cost_plot(report::cost_trend(report::frame_costs(run))));
}

std::string loop_cost_svg(const LoopRun& loops) {
  return report::svg_text(report::loop_cost_plot(loops.report.keyframes));
}

void write_cloud(const std::filesystem::path& file, const std::vector<eval::CloudPoint>& cloud) {
  if (cloud.empty())
    throw InputError(
        file.string(),
        "is not written: no surface was measured in four located frames; the sequence lacks depth "
        "images, or was not tracked");
  write_output(file, eval::ply_bytes(cloud), {});
}

}  // namespace

void require_known_dumps(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (name != "labels" && name != "cost")
      throw InputError("--dump", "unknown value \"" + name + "\"; expected one of: labels, cost");
  }
}

RunDumps::RunDumps(DumpRequest request, const datasets::SensorStream& stream, const FrontendConfig& frontend)
    : request_(std::move(request)), stream_(stream) {
  const datasets::SequenceInfo& info = stream.info();
  const report::AnnotationStyle style = report::annotation_style(frontend);
  if (!request_.video.empty()) video_.emplace(request_.video, style, report::mean_rate_hz(info.frame_times));
  if (request_.images > 0) {
    worst_frames_.emplace(request_.folder / kImagesFolder, request_.images, style, info);
    surfaces_.emplace(info.rig.camera);
  }
  if (!request_.map_cloud.empty())
    map_.emplace(info.rig.camera, datasets::VoxelMapOptions{.voxel_m = request_.map_voxel_m});
  if (!request_.mcap.empty()) {
    recording_.emplace(
        request_.mcap, info,
        request_.mcap_images ? report::RecordedImages::kColorAndDepth : report::RecordedImages::kNone);
  }
}

template <class Action>
bool RunDumps::attempt(const char* name, const Action& action) {
  try {
    action();
    return true;
  } catch (const std::runtime_error& error) {  // InputError and errors of the file system
    const std::string text = error.what();
    failures_.push_back(text.starts_with(name) ? text : std::string(name) + ": " + text);
    return false;
  }
}

void RunDumps::add_to_map(const FrameReport& report) {
  constexpr double kInterval_s = 0.095;  // 10 Hz, with jitter
  const OdometryUpdate& update = report.update;
  const bool in_one_world = update.segment == 0 || request_.closes_loops;
  if (!is_located(update.status) || !in_one_world || report.dynamic.labels.empty()) return;
  if (map_t_ && seconds_between(*map_t_, report.frame.t) < kInterval_s) return;
  map_t_ = report.frame.t;
  if (request_.closes_loops) {
    map_frames_.push_back(
        {report.tracked.id, report.frame.t, update.segment, update.T_w_c, report.dynamic.mask});
  } else {
    report::add_static_pixels(*map_, report.frame, update.T_w_c, report.dynamic.mask);
  }
}

void RunDumps::fuse_optimized(const LoopRun* loops) {
  for (const MapFrame& kept : map_frames_) {
    Pose T_w_c = kept.T_w_c;
    if (loops == nullptr && kept.segment != 0) continue;  // of a world that nothing relates to the first one
    if (loops != nullptr) {
      const std::vector<StampedPose>& poses = loops->optimized.poses;
      const auto found = std::ranges::lower_bound(poses, kept.t, {}, &StampedPose::t);
      if (found == poses.end() || found->t != kept.t) continue;  // of a world that is not located in the map
      T_w_c = found->T_w_f;
    }
    report::add_static_pixels(*map_, stream_.load_frame(static_cast<std::size_t>(kept.index)), T_w_c,
                              kept.mask);
  }
}

void RunDumps::add(const FrameReport& report) {
  if (request_.labels) labels_.add(report);
  if (video_ && !attempt("--video", [&] { video_->add(report); })) video_.reset();
  if (worst_frames_ && !attempt("--images", [&] { worst_frames_->add(report); })) worst_frames_.reset();
  if (request_.images > 0) landmarks_.add(report);
  if (surfaces_ && !attempt("--images", [&] { surfaces_->add(report); })) surfaces_.reset();
  if (recording_ && !attempt("--mcap", [&] { recording_->add(report); })) recording_.reset();
  if (map_ && !attempt("--map-cloud", [&] { add_to_map(report); })) map_.reset();
}

std::vector<std::string> RunDumps::finish(const OdometryRun* run) {
  const LoopRun* const loops = run != nullptr && run->loops ? &*run->loops : nullptr;
  if (video_) attempt("--video", [&] { video_->finish(); });
  attempt("--images", [&] {
    if (worst_frames_)
      worst_frames_->finish();
    else
      report::remove_images(request_.folder / kImagesFolder);  // of an earlier run
  });
  if (recording_) attempt("--mcap", [&] { recording_->finish(loops); });
  if (map_) {
    attempt("--map-cloud", [&] {
      fuse_optimized(loops);
      write_cloud(request_.map_cloud, map_->cloud());
    });
  }
  if (request_.labels)
    attempt("--dump labels", [&] { write_files(request_.folder, {{kLabelsFile, labels_.text()}}); });
  if (request_.images > 0)
    attempt("--images", [&] { write_files(request_.folder, {{kLandmarksFile, landmarks_.text()}}); });
  if (const std::string surfaces = surfaces_ ? surfaces_->ply() : ""; !surfaces.empty())
    attempt("--images", [&] { write_files(request_.folder, {{kSurfacesFile, surfaces}}); });
  if (request_.cost && run != nullptr) {
    attempt("--dump cost", [&] {
      write_files(request_.folder, {{kCostFile, cost_svg(*run)}});
      if (loops != nullptr) write_files(request_.folder, {{kLoopCostFile, loop_cost_svg(*loops)}});
    });
  }
  return failures_;
}

}  // namespace stillpoint::bench
