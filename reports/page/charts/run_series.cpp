// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/charts/run_series.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>

#include "bench/model/run_csv.h"
#include "core/base/timestamp.h"
#include "core/types/odometry_update.h"
#include "eval/metrics/frame_to_frame_error.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMaxWorstFrames = 20;
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr double kStampToleranceS = 1e-3;  // some files round their stamps
/// As in the tables: TUM's association and rigid alignment over all pairs.
constexpr const char* kProtocol = "compat:tum";

/// Frame stamps; pose stamps for systems without frame counters.
std::vector<Timestamp> stamps_of(const std::vector<bench::FrameCounters>& counters, const Trajectory& path) {
  std::vector<Timestamp> stamps;
  for (const bench::FrameCounters& frame : counters) stamps.push_back({frame.t_ns});
  if (!stamps.empty()) return stamps;
  for (const StampedPose& pose : path.poses) stamps.push_back(pose.t);
  return stamps;
}

std::optional<std::size_t> index_of(const std::vector<Timestamp>& stamps, Timestamp t) {
  const auto next = std::lower_bound(stamps.begin(), stamps.end(), after(t, -kStampToleranceS));
  if (next == stamps.end() || *next > after(t, kStampToleranceS)) return std::nullopt;
  return static_cast<std::size_t>(next - stamps.begin());
}

/// Sparse columns of equal length, created on first use.
class SeriesTable {
 public:
  explicit SeriesTable(std::size_t frames) : frames_(frames) {}

  void set(const std::string& name, std::size_t frame, double value) {
    if (frame >= frames_) return;
    const auto found = std::find_if(columns_.begin(), columns_.end(),
                                    [&](const SeriesColumn& column) { return column.name == name; });
    SeriesColumn& column = found != columns_.end()
                               ? *found
                               : columns_.emplace_back(SeriesColumn{name, std::vector(frames_, kNan)});
    column.values[frame] = value;
  }

  [[nodiscard]] std::vector<SeriesColumn> take() { return std::move(columns_); }

 private:
  std::size_t frames_;
  std::vector<SeriesColumn> columns_;
};

void fill_path(SeriesTable& table, const std::vector<Timestamp>& stamps, const Trajectory& path,
               const Trajectory& truth) {
  eval::Similarity S_w_v;
  eval::Evaluation evaluation;
  if (!truth.poses.empty() && !path.poses.empty()) {
    evaluation = eval::evaluate(kProtocol, {.gt = truth, .est = path, .options = {}});
    S_w_v = evaluation.alignment.S_w_v;
  }
  for (const StampedPose& pose : path.poses) {
    const std::optional<std::size_t> frame = index_of(stamps, pose.t);
    if (!frame) continue;
    const Eigen::Vector3d position = S_w_v * pose.T_w_f.p;
    table.set("x", *frame, position.x());
    table.set("y", *frame, position.y());
    table.set("z", *frame, position.z());
  }
  for (const eval::PoseError& error : evaluation.per_pose) {
    const std::optional<std::size_t> frame = index_of(stamps, error.t);
    if (!frame) continue;
    table.set("error_m", *frame, error.translation_m);
    table.set("error_deg", *frame, error.rotation_deg);
  }
}

/// Position of a status in `OdometryStatus`; NaN for the names of other systems.
double status_number(const std::string& name) {
  for (int i = 0; i <= static_cast<int>(OdometryStatus::kRelocated); ++i) {
    if (status_name(static_cast<OdometryStatus>(i)) == name) return i;
  }
  return kNan;
}

void fill_counters(SeriesTable& table, const std::vector<bench::FrameCounters>& counters) {
  for (std::size_t i = 0; i < counters.size(); ++i) {
    const bench::FrameCounters& frame = counters[i];
    table.set("status", i, status_number(frame.status));
    table.set("features", i, static_cast<double>(frame.tracked_features));
    table.set("landmarks", i, static_cast<double>(frame.window_landmarks));
    const double all = static_cast<double>(frame.tracked_features);
    table.set("dynamic", i, all > 0.0 ? static_cast<double>(frame.dynamic_features) / all : kNan);
  }
}

/// Runs of other systems, and of older versions, have no claims.
void fill_claims(SeriesTable& table, const bench::Store& store, const bench::StoredRun& run) {
  const std::string text = store.attachment(run, "claims");
  if (text.empty()) return;
  const std::vector<bench::FrameClaim> claims = bench::parse_claims(text, "claims of run " + run.key);
  for (std::size_t i = 0; i < claims.size(); ++i) {
    if (claims[i].sigma_m <= 0.0) continue;  // not reported
    table.set("three_sigma_m", i, 3.0 * claims[i].sigma_m);
    table.set("three_sigma_deg", i, 3.0 * claims[i].sigma_rad * kDegreesPerRadian);
  }
}

/// Attachment kinds of the run's images by frame index.
std::map<std::size_t, std::string> images_of(const bench::StoredRun& run,
                                             const std::vector<bench::FrameCounters>& counters) {
  std::map<std::int64_t, std::size_t> indices;
  for (std::size_t i = 0; i < counters.size(); ++i) indices[counters[i].frame] = i;
  std::map<std::size_t, std::string> images;
  for (const auto& [kind, blob] : run.blobs) {
    if (!kind.starts_with(bench::kImageKind)) continue;
    const auto index = indices.find(std::strtoll(kind.c_str() + bench::kImageKind.size(), nullptr, 10));
    if (index != indices.end()) images[index->second] = kind;
  }
  return images;
}

void fill_worst(RunSeries& series, SeriesTable& table, const std::vector<Timestamp>& stamps,
                const std::vector<eval::MatchedPose>& matches) {
  std::vector<std::optional<eval::MatchedPose>> poses(stamps.size());
  for (const eval::MatchedPose& match : matches) {
    if (const std::optional<std::size_t> frame = index_of(stamps, match.t)) poses[*frame] = match;
  }
  eval::FrameToFrameError frame_to_frame;
  eval::WorstFrames worst(series.images.empty() ? kMaxWorstFrames : series.images.size());
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const double error_m = frame_to_frame.next(poses[frame]);
    if (std::isfinite(error_m)) table.set("frame_to_frame_error_m", frame, error_m);
    if (series.images.empty() || series.images.contains(frame))
      static_cast<void>(worst.insert(frame, error_m));
  }
  series.worst = worst.frames();
}

}  // namespace

RunSeries run_series(const bench::Store& store, const bench::StoredRun& run) {
  const std::vector<bench::FrameCounters> counters = store.frame_counters(run);
  const Trajectory path = store.trajectory(run);
  const std::vector<Timestamp> stamps = stamps_of(counters, path);
  RunSeries series;
  if (stamps.empty()) return series;
  series.start_s = to_seconds(stamps.front());
  for (const Timestamp t : stamps) series.t_s.push_back(seconds_between(stamps.front(), t));
  series.images = images_of(run, counters);
  SeriesTable table(stamps.size());
  const Trajectory truth = store.truth(run);
  fill_path(table, stamps, path, truth);
  fill_worst(series, table, stamps, eval::strict_matches(truth, path));
  fill_counters(table, counters);
  fill_claims(table, store, run);
  series.faults = fault_bands(store.manifest(run), stamps.front(), stamps.back());
  if (!counters.empty()) {
    for (const bench::TimingSample& sample : store.timing_samples(run)) {
      table.set("ms:" + sample.module, static_cast<std::size_t>(sample.frame),
                static_cast<double>(sample.ns) * 1e-6);
    }
  }
  series.columns = table.take();
  return series;
}

}  // namespace stillpoint::report
