// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/chart_data.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "core/types/odometry_update.h"
#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/sensor_fault.h"
#include "eval/io/text_reader.h"
#include "eval/metrics/frame_to_frame_error.h"
#include "eval/metrics/rpe.h"
#include "eval/metrics/statistics.h"
#include "eval/protocols/protocol.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMaxWorstFrames = 20;
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr double kStampToleranceS = 1e-3;  // some files round their stamps
/// As in the tables: TUM's association and rigid alignment over all pairs.
constexpr const char* kProtocol = "compat:tum";

/// Faults that are active for a part of the sequence.
/// @param manifest of the run, JSON; empty or without faults: no bands
/// @param first, last timestamps of the frames
/// @throws InputError for faults of an unknown kind
std::vector<FaultBand> fault_bands(const std::string& manifest, Timestamp first, Timestamp last) {
  std::vector<FaultBand> bands;
  const nlohmann::json json = nlohmann::json::parse(manifest, nullptr, false);
  if (!json.is_object()) return bands;
  for (const std::string& text : json.value("faults", std::vector<std::string>())) {
    const datasets::SensorFault fault = datasets::parse_fault(text);
    if (fault.is_permanent()) continue;
    for (const datasets::FaultInterval& interval : datasets::fault_intervals(fault, first, last)) {
      bands.push_back({seconds_between(first, interval.begin), seconds_between(first, interval.end), text});
    }
  }
  return bands;
}

/// Frame stamps; pose stamps for systems without frame counters.
std::vector<Timestamp> stamps_of(const std::vector<bench::FrameCounters>& counters, const Trajectory& path) {
  std::vector<Timestamp> stamps;
  stamps.reserve(counters.size());
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

/// @return the alignment to the ground truth
eval::Similarity fill_path(SeriesTable& table, const std::vector<Timestamp>& stamps, const Trajectory& path,
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
    const Pose aligned = S_w_v * pose.T_w_f;
    table.set("x", *frame, aligned.p.x());
    table.set("y", *frame, aligned.p.y());
    table.set("z", *frame, aligned.p.z());
    const double sign = aligned.q.w() < 0.0 ? -1.0 : 1.0;
    table.set("qx", *frame, sign * aligned.q.x());
    table.set("qy", *frame, sign * aligned.q.y());
    table.set("qz", *frame, sign * aligned.q.z());
  }
  for (const eval::PoseError& error : evaluation.per_pose) {
    const std::optional<std::size_t> frame = index_of(stamps, error.t);
    if (!frame) continue;
    table.set("error_m", *frame, error.translation_m);
    table.set("error_deg", *frame, error.rotation_deg);
  }
  return S_w_v;
}

/// Accuracy runs of this odometry have landmarks if their plan requests images.
std::vector<bench::LandmarkSample> aligned_landmarks(const bench::Store& store, const bench::StoredRun& run,
                                                     const eval::Similarity& S_w_v) {
  const std::string text = store.attachment(run, "landmarks");
  if (text.empty()) return {};
  std::vector<bench::LandmarkSample> landmarks = bench::parse_landmarks(text, "landmarks of run " + run.key);
  for (bench::LandmarkSample& landmark : landmarks) landmark.p_w = S_w_v * landmark.p_w;
  std::ranges::stable_partition(landmarks, [](const auto& landmark) { return !landmark.dynamic; });
  return landmarks;
}

/// Runs have surfaces if they have landmarks and depth images.
std::vector<eval::CloudPoint> aligned_surfaces(const bench::Store& store, const bench::StoredRun& run,
                                               const eval::Similarity& S_w_v) {
  const std::string text = store.attachment(run, "surfaces");
  if (text.empty()) return {};
  std::vector<eval::CloudPoint> surfaces = eval::parse_ply(text, "surfaces of run " + run.key);
  for (eval::CloudPoint& point : surfaces)
    point.p = (S_w_v * Eigen::Vector3d(point.p.cast<double>())).cast<float>();
  return surfaces;
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
  const eval::Similarity S_w_v = fill_path(table, stamps, path, truth);
  series.landmarks = aligned_landmarks(store, run, S_w_v);
  series.surfaces = aligned_surfaces(store, run, S_w_v);
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

namespace {

/// Indices of the frames that `thinned` keeps, ascending.
std::vector<std::size_t> kept_frames(const RunSeries& series, std::size_t step) {
  std::vector<bool> keep(series.t_s.size(), false);
  for (std::size_t i = 0; i < keep.size(); i += step) keep[i] = true;
  keep.back() = true;
  for (const std::size_t frame : series.worst) keep[frame] = true;
  for (const auto& [frame, kind] : series.images) keep[frame] = true;
  for (const SeriesColumn& column : series.columns) {
    if (column.name != "status") continue;
    for (std::size_t i = 1; i < keep.size(); ++i) {
      const bool both_missing = std::isnan(column.values[i]) && std::isnan(column.values[i - 1]);
      keep[i] = keep[i] || (!both_missing && column.values[i] != column.values[i - 1]);
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) kept.push_back(i);
  }
  return kept;
}

}  // namespace

RunSeries thinned(const RunSeries& series, std::size_t frames) {
  if (series.t_s.size() <= frames) return series;
  RunSeries thin;
  thin.start_s = series.start_s;
  thin.faults = series.faults;
  thin.numbers = kept_frames(series, (series.t_s.size() + frames - 1) / frames);
  std::map<std::size_t, std::size_t> indices;
  for (const std::size_t frame : thin.numbers) {
    indices[frame] = thin.t_s.size();
    thin.t_s.push_back(series.t_s[frame]);
  }
  for (const SeriesColumn& column : series.columns) {
    SeriesColumn& own = thin.columns.emplace_back(SeriesColumn{column.name, {}});
    for (const std::size_t frame : thin.numbers) own.values.push_back(column.values[frame]);
  }
  const std::size_t step = (series.landmarks.size() + frames - 1) / frames;
  for (std::size_t i = 0; i < series.landmarks.size(); i += step)
    thin.landmarks.push_back(series.landmarks[i]);
  for (const std::size_t frame : series.worst) thin.worst.push_back(indices.at(frame));
  for (const auto& [frame, kind] : series.images) thin.images[indices.at(frame)] = kind;
  return thin;
}

namespace {

// Of the path length; defaults of rpg_trajectory_evaluation (Zhang and Scaramuzza, IROS 2018).
constexpr double kLengthFractions[] = {0.1, 0.2, 0.3, 0.4, 0.5};

std::vector<double> lengths_of(const Trajectory& truth) {
  double path_m = 0.0;
  for (std::size_t i = 1; i < truth.poses.size(); ++i)
    path_m += (truth.poses[i].T_w_f.p - truth.poses[i - 1].T_w_f.p).norm();
  std::vector<double> lengths;
  for (const double fraction : kLengthFractions) lengths.push_back(fraction * path_m);
  return lengths;
}

/// Mean translational error per length [%]; nullopt where the run has no segment of that length.
std::vector<std::optional<double>> errors_of(const Trajectory& truth, const Trajectory& path,
                                             const std::vector<double>& lengths) {
  std::vector<std::optional<double>> errors(lengths.size());
  const std::vector<eval::MatchedPose> matches = eval::strict_matches(truth, path);
  for (const eval::SegmentErrors& segment : eval::segment_errors(matches, {.lengths_m = lengths})) {
    const auto found = std::find(lengths.begin(), lengths.end(), segment.length_m);
    if (found != lengths.end())
      errors[static_cast<std::size_t>(found - lengths.begin())] =
          100.0 * segment.translation_m.mean / segment.length_m;
  }
  return errors;
}

SegmentCurve curve_of(const bench::Store& store, const std::vector<const bench::StoredRun*>& runs,
                      const std::string& label, const std::vector<double>& lengths) {
  std::vector<std::vector<double>> errors(lengths.size());
  SegmentCurve curve{.label = label, .runs = 0, .translation_percent = {}};
  for (const bench::StoredRun* run : runs) {
    const auto own = errors_of(store.truth(*run), store.trajectory(*run), lengths);
    curve.runs +=
        std::any_of(own.begin(), own.end(), [](const auto& error) { return error.has_value(); }) ? 1 : 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      if (own[i]) errors[i].push_back(*own[i]);
    }
  }
  for (const std::vector<double>& values : errors)
    curve.translation_percent.push_back(eval::percentile(values, 0.5));
  return curve;
}

}  // namespace

std::vector<SegmentFigure> segment_figures(const bench::Store& store,
                                           std::span<const bench::StoredRun> runs) {
  std::vector<SegmentFigure> figures;
  for (const std::string& sequence :
       distinct(runs, [](const bench::RunIdentity& identity) { return identity.sequence; })) {
    SegmentFigure figure{.sequence = sequence, .lengths_m = {}, .curves = {}};
    for (const std::string& label : distinct(runs, system_label)) {
      const std::vector<const bench::StoredRun*> own = runs_of(runs, label, sequence);
      if (own.empty()) continue;
      if (figure.lengths_m.empty()) figure.lengths_m = lengths_of(store.truth(*own.front()));
      SegmentCurve curve = curve_of(store, own, label, figure.lengths_m);
      const auto& errors = curve.translation_percent;
      if (std::any_of(errors.begin(), errors.end(), [](const auto& error) { return error.has_value(); }))
        figure.curves.push_back(std::move(curve));
    }
    if (!figure.curves.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

namespace {

constexpr double kWidth = 900.0;
constexpr double kLabelWidth = 330.0;
constexpr double kRightMargin = 40.0;  // half of the last tick label
constexpr double kRowHeight = 20.0;
constexpr double kAxisHeight = 30.0;
constexpr double kMinAxisValue = 1e-3;  // 1 us on an axis in ms

/// Logarithmic axis over whole decades.
struct LogAxis {
  double low = 0.0;  ///< exponents of ten
  double high = 1.0;

  [[nodiscard]] double operator()(double value) const {
    const double fraction = (std::log10(std::max(value, std::pow(10.0, low))) - low) / (high - low);
    return kLabelWidth + fraction * (kWidth - kLabelWidth - kRightMargin);
  }
};

LogAxis axis_of(std::span<const PlotBox> boxes) {
  double low = boxes.front().p5;
  double high = boxes.front().max;
  for (const PlotBox& box : boxes) {
    low = std::min(low, box.p5);
    high = std::max(high, box.max);
  }
  LogAxis axis{std::floor(std::log10(std::max(low, kMinAxisValue))),
               std::ceil(std::log10(std::max(high, kMinAxisValue)))};
  if (axis.high <= axis.low) axis.high = axis.low + 1.0;
  return axis;
}

std::string ticks_svg(const LogAxis& axis, double height, const std::string& unit) {
  std::string text;
  for (double exponent = axis.low; exponent <= axis.high; exponent += 1.0) {
    const double value = std::pow(10.0, exponent);
    const double x = axis(value);
    text += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.1f}\"/>"
        "<text class=\"tick\" x=\"{0:.1f}\" y=\"{2:.1f}\">{3:g} {4}</text>",
        x, height, height + 18.0, value, escape_html(unit));
  }
  return text;
}

std::string box_svg(const PlotBox& box, const LogAxis& axis, double y) {
  const double middle = y + kRowHeight / 2.0;
  std::string text = fmt::format(
      "<g><title>{} {}: median {:.3g}, quartiles {:.3g} to {:.3g}, 95th percentile {:.3g}, max "
      "{:.3g}, {} frames</title>",
      escape_html(box.group), escape_html(box.label), box.median, box.q1, box.q3, box.p95, box.max,
      box.count);
  text += fmt::format("<text class=\"name\" x=\"{}\" y=\"{:.1f}\">{} (n = {})</text>", kLabelWidth - 8.0,
                      middle + 4.0, escape_html(box.label), box.count);
  text += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", axis(box.p5),
                      axis(box.p95), middle, middle);
  text += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", axis(box.q1),
                      y + 4.0, std::max(axis(box.q3) - axis(box.q1), 1.0), kRowHeight - 8.0);
  text += fmt::format("<line class=\"median\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                      axis(box.median), y + 3.0, y + kRowHeight - 3.0);
  return text + fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/></g>\n", axis(box.max), middle);
}

}  // namespace

std::optional<PlotBox> box_of(std::string group, std::string label, std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  const auto at = [&](double fraction) { return eval::percentile(values, fraction).value(); };
  return PlotBox{.group = std::move(group),
                 .label = std::move(label),
                 .p5 = at(0.05),
                 .q1 = at(0.25),
                 .median = at(0.5),
                 .q3 = at(0.75),
                 .p95 = at(0.95),
                 .max = at(1.0),
                 .count = values.size()};
}

std::string box_plot_svg(std::span<const PlotBox> boxes, const std::string& title, const std::string& unit) {
  if (boxes.empty()) return "";
  const LogAxis axis = axis_of(boxes);
  std::string marks;
  std::string group;
  double y = 0.0;
  for (const PlotBox& box : boxes) {
    if (box.group != group) {
      marks += fmt::format("<text class=\"group\" x=\"4\" y=\"{:.1f}\">{}</text>\n", y + kRowHeight - 6.0,
                           escape_html(box.group));
      group = box.group;
      y += kRowHeight;
    }
    marks += box_svg(box, axis, y);
    y += kRowHeight;
  }
  return fmt::format("<svg class=\"boxes\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {:.1f}\">\n",
                     escape_html(title), kWidth, y + kAxisHeight) +
         ticks_svg(axis, y, unit) + marks + "</svg>\n";
}

StackTimes parse_stacks(std::string_view folded, const std::string& source) {
  StackTimes times;
  eval::LineReader lines(folded);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    const std::size_t space = line->rfind(' ');
    const std::optional<double> ns =
        space == std::string_view::npos ? std::nullopt : eval::parse_number(line->substr(space + 1));
    if (!ns || space == 0)
      throw InputError(source, lines.line_number(),
                       "is not a folded stack; expected \"outer;inner nanoseconds\"");
    times[std::string(line->substr(0, space))] += *ns;
  }
  return times;
}

}  // namespace stillpoint::report
