// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/page_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "bench/model/run_csv.h"
#include "bench/model/run_notes.h"
#include "bench/profile/timeline.h"
#include "eval/io/base64.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint16_t kNoValue = 0xFFFF;
constexpr double kSteps = 65534.0;

}  // namespace

Json packed_series(std::span<const double> values) {
  double low = 0.0;
  double high = 0.0;
  bool is_first = true;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = is_first ? value : std::min(low, value);
    high = is_first ? value : std::max(high, value);
    is_first = false;
  }
  const double step = high > low ? (high - low) / kSteps : 1.0;
  std::string bytes;
  for (const double value : values) {
    const auto number =
        std::isfinite(value) ? static_cast<std::uint16_t>(std::lround((value - low) / step)) : kNoValue;
    bytes += static_cast<char>(number & 0xFF);
    bytes += static_cast<char>(number >> 8);
  }
  return {{"low", low}, {"step", step}, {"data", eval::base64(bytes)}};
}

namespace {

std::string image_base64(const bench::Store& store, const bench::StoredRun& run, const std::string& kind) {
  return eval::base64(store.attachment(run, kind));
}

/// Frames of a run that have an image, worst first.
std::vector<std::size_t> frames_with_image(const RunSeries& series) {
  std::vector<std::size_t> frames = series.worst;
  std::erase_if(frames, [&](std::size_t frame) { return !series.images.contains(frame); });
  return frames;
}

}  // namespace

std::vector<std::string> page_images(const bench::Store& store, std::span<const bench::StoredRun> runs,
                                     std::span<const RunSeries> series, std::size_t budget_bytes) {
  std::vector<Json> images(runs.size(), Json::object());
  std::vector<std::vector<std::size_t>> frames;
  std::size_t ranks = 0;
  for (const RunSeries& one : series) {
    frames.push_back(frames_with_image(one));
    ranks = std::max(ranks, frames.back().size());
  }
  bool is_full = false;
  for (std::size_t rank = 0; rank < ranks && !is_full; ++rank) {
    for (std::size_t run = 0; run < runs.size() && !is_full; ++run) {
      if (rank >= frames[run].size()) continue;
      const std::size_t frame = frames[run][rank];
      std::string text = image_base64(store, runs[run], series[run].images.at(frame));
      is_full = text.size() > budget_bytes;
      if (is_full) continue;
      budget_bytes -= text.size();
      images[run][std::to_string(frame)] = std::move(text);
    }
  }
  std::vector<std::string> texts;
  texts.reserve(images.size());
  for (const Json& json : images) texts.push_back(json.dump());
  return texts;
}

namespace {

constexpr std::size_t kMaxTruthPoints = 2000;  // more than a plot can resolve
// A page of 15 runs of a minute has less than 3 MB: scripts and licenses .5, images .8, series .8, landmarks
// .2, surfaces .4.
constexpr std::size_t kImageBudgetBytes = 800'000;
constexpr std::size_t kSeriesBudgetBytes = 800'000;
constexpr std::size_t kSurfaceBudgetBytes = 400'000;
constexpr std::size_t kSideImageBytes = 100'000'000;  // of all side files; a server holds them in memory
constexpr std::size_t kMinFrames = 300;       // of a run, whatever the number of runs: a chart stays readable
constexpr std::size_t kMinPoints = 300;       // of the surfaces of a run, likewise
constexpr double kBytesPerValue = 8.0 / 3.0;  // 16 bits in base64
constexpr double kValuesPerPoint = 4.0;       // x, y, z, color
constexpr const char* kModulePrefix = "ms:";

std::string dump_replacing_invalid_utf8(const Json& json) {
  return json.dump(-1, ' ', false, nlohmann::detail::error_handler_t::replace);
}

/// Remarks on the metrics of a run.
Json notes_json(const bench::StoredRun& run) {
  Json notes = Json::array();
  const std::vector<const bench::StoredRun*> runs = {&run};
  for (const bench::MetricDescriptor* metric : bench::metrics_of(bench::MetricSource::kTrajectory)) {
    if (const std::string note = bench::protocol_difference_note(runs, metric->id); !note.empty())
      notes.push_back(clean_line(note));
  }
  if (const std::string note = bench::doubtful_error_note(runs, bench::headline_metric().id); !note.empty())
    notes.push_back(clean_line(note));
  if (const std::string note = bench::missing_boxes_note(runs); !note.empty())
    notes.push_back(clean_line(note));
  return notes;
}

Json run_json(const bench::StoredRun& run) {
  const bench::RunIdentity& identity = run.identity;
  Json json = {{"key", run.key},
               {"label", clean_line(system_label(identity))},
               {"sequence", clean_line(identity.sequence)},
               {"seed", identity.seed},
               {"repetition", identity.repetition},
               {"mode", clean_line(identity.mode)},
               {"kind", clean_line(identity.kind)},
               {"build", clean_line(identity.build)},
               {"config", identity.config_hash},
               {"outcome", bench::outcome_name(run.outcome)},
               {"detail", clean_line(run.detail)},
               {"manifest", run.manifest_hash}};
  if (!identity.axis.empty())
    json["sweep"] = {{"axis", clean_line(identity.axis)}, {"value", identity.axis_value}};
  Json metrics = Json::array();
  for (const bench::Metric& metric : run.metrics) {
    metrics.push_back(
        {clean_line(metric.name), metric.value, clean_line(metric.unit), clean_line(metric.protocol)});
  }
  json["metrics"] = metrics;
  json["notes"] = notes_json(run);
  const auto truth = run.blobs.find("truth");
  json["truth"] = truth == run.blobs.end() ? Json(nullptr) : Json(truth->second);
  return json;
}

Json truth_json(const Trajectory& truth) {
  const std::size_t step = truth.poses.size() / kMaxTruthPoints + 1;
  std::vector<double> t;
  std::array<std::vector<double>, 3> p;
  for (std::size_t i = 0; i < truth.poses.size(); i += step) {
    const StampedPose& pose = truth.poses[i];
    t.push_back(seconds_between(truth.poses.front().t, pose.t));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      p[static_cast<std::size_t>(axis)].push_back(pose.T_w_f.p(axis));
  }
  return {{"start", to_seconds(truth.poses.front().t)},
          {"t", packed_series(t)},
          {"x", packed_series(p[0])},
          {"y", packed_series(p[1])},
          {"z", packed_series(p[2])}};
}

/// Recognized places of this run: times since the first frame [s], inliers, residual [px], and why it was
/// refused. Matches in a loaded map are not on the trajectory.
Json loops_json(const bench::Store& store, const bench::StoredRun& run, double start_s) {
  Json loops = Json::array();
  const std::string text = store.attachment(run, "loops");
  if (text.empty()) return loops;
  for (const bench::StoredLoop& loop : bench::parse_loops(text, "loops of run " + run.key)) {
    if (loop.in_map) continue;
    loops.push_back({to_seconds(loop.query_t) - start_s, to_seconds(loop.match_t) - start_s, loop.inliers,
                     loop.residual_px, loop.reason});
  }
  return loops;
}

Json faults_json(const std::vector<FaultBand>& faults) {
  Json list = Json::array();
  for (const FaultBand& band : faults) list.push_back({band.begin_s, band.end_s, clean_line(band.fault)});
  return list;
}

/// Positions, and how many of them, the first ones, are static.
Json landmarks_json(const std::vector<bench::LandmarkSample>& landmarks) {
  std::array<std::vector<double>, 3> p;
  for (const bench::LandmarkSample& landmark : landmarks) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      p[static_cast<std::size_t>(axis)].push_back(landmark.p_w(axis));
  }
  return {{"static", std::ranges::count(landmarks, false, &bench::LandmarkSample::dynamic)},
          {"x", packed_series(p[0])},
          {"y", packed_series(p[1])},
          {"z", packed_series(p[2])}};
}

/// Positions and colors, of 5 bits per channel: 1024 red + 32 green + blue.
Json surfaces_json(const std::vector<eval::CloudPoint>& surfaces) {
  std::array<std::vector<double>, 3> p;
  std::vector<double> color;
  for (const eval::CloudPoint& point : surfaces) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) p[static_cast<std::size_t>(axis)].push_back(point.p(axis));
    color.push_back((point.rgb[0] >> 3) << 10 | (point.rgb[1] >> 3) << 5 | point.rgb[2] >> 3);
  }
  return {{"x", packed_series(p[0])},
          {"y", packed_series(p[1])},
          {"z", packed_series(p[2])},
          {"color", packed_series(color)}};
}

Json series_json(const RunSeries& series, Json loops, const std::vector<eval::CloudPoint>& surfaces) {
  Json columns = Json::object();
  for (const SeriesColumn& column : series.columns)
    columns[clean_line(column.name)] = packed_series(column.values);
  Json json = {
      {"start", series.start_s}, {"frames", series.t_s.size()}, {"t", packed_series(series.t_s)},
      {"worst", series.worst},   {"loops", std::move(loops)},   {"faults", faults_json(series.faults)},
      {"columns", columns}};
  if (!series.landmarks.empty()) json["landmarks"] = landmarks_json(series.landmarks);
  if (!surfaces.empty()) json["surfaces"] = surfaces_json(surfaces);
  if (!series.numbers.empty())
    json["numbers"] = packed_series(std::vector<double>(series.numbers.begin(), series.numbers.end()));
  return json;
}

/// Frames of each of `runs` runs that the page contains.
std::size_t frames_per_run(const RunSeries& series, std::size_t runs) {
  const double bytes = kBytesPerValue * static_cast<double>(std::max<std::size_t>(1, series.columns.size()));
  return std::max(kMinFrames,
                  static_cast<std::size_t>(kSeriesBudgetBytes / bytes / static_cast<double>(runs)));
}

/// Points of the surfaces of each of `runs` runs that the page contains.
std::size_t points_per_run(std::size_t runs) {
  constexpr double kBytes = kBytesPerValue * kValuesPerPoint;
  return std::max(kMinPoints,
                  static_cast<std::size_t>(kSurfaceBudgetBytes / kBytes / static_cast<double>(runs)));
}

/// Times [ms] of all frames by module and variant.
using ModuleTimes = std::map<std::pair<std::string, std::string>, std::vector<double>>;

ModuleTimes with_times(ModuleTimes times, const RunSeries& series, const std::string& label) {
  for (const SeriesColumn& column : series.columns) {
    if (!column.name.starts_with(kModulePrefix)) continue;
    std::vector<double>& values = times[{column.name.substr(std::string_view(kModulePrefix).size()), label}];
    std::copy_if(column.values.begin(), column.values.end(), std::back_inserter(values),
                 [](double value) { return std::isfinite(value); });
  }
  return times;
}

std::vector<PlotBox> boxes_of(const ModuleTimes& times) {
  std::vector<PlotBox> boxes;
  for (const auto& [key, values] : times) {
    if (std::optional<PlotBox> box = box_of(key.first, key.second, values)) boxes.push_back(std::move(*box));
  }
  return boxes;
}

/// Summed stacks of all runs of a variant, and the number of frames they cover.
struct Flame {
  StackTimes stacks;
  std::size_t frames = 0;

  void add(const StackTimes& run, std::size_t run_frames) {
    for (const auto& [stack, ns] : run) stacks[stack] += ns;
    frames += run_frames;
  }
};

Json flames_json(const std::map<std::string, Flame>& flames) {
  Json json = Json::array();
  for (const auto& [label, flame] : flames) {
    StackTimes stacks = flame.stacks;
    // The decoding thread runs in parallel and mostly waits for input; it would dominate the chart.
    std::erase_if(stacks, [&](const auto& stack) {
      return stack.first.starts_with(bench::track_name(bench::Track::kDecoding));
    });
    json.push_back({{"label", label}, {"frames", flame.frames}, {"stacks", std::move(stacks)}});
  }
  return json;
}

Json segments_json(const std::vector<SegmentFigure>& figures) {
  Json json = Json::array();
  for (const SegmentFigure& figure : figures) {
    Json curves = Json::array();
    for (const SegmentCurve& curve : figure.curves) {
      Json errors = Json::array();
      for (const std::optional<double>& error : curve.translation_percent)
        errors.push_back(error ? Json(*error) : Json(nullptr));
      curves.push_back({{"label", clean_line(curve.label)}, {"runs", curve.runs}, {"errors", errors}});
    }
    json.push_back(
        {{"sequence", clean_line(figure.sequence)}, {"lengths", figure.lengths_m}, {"curves", curves}});
  }
  return json;
}

/// The metric of sweep curves.
Json headline_json() {
  const bench::MetricDescriptor& metric = bench::headline_metric();
  return {{"id", std::string(metric.id)},
          {"label", std::string(metric.label)},
          {"unit", std::string(metric.unit)}};
}

Json tooltips_json(std::span<const bench::StoredRun> runs) {
  Json json = Json::object();
  for (const bench::StoredRun& run : runs) {
    for (const bench::Metric& metric : run.metrics)
      json[clean_line(metric.name)] = bench::tooltip_of(metric.name);
  }
  return json;
}

}  // namespace

PageData page_data(const bench::Store& store, std::span<const bench::StoredRun> runs, RunData place) {
  const bool embeds = place == RunData::kEmbedded;
  PageData data;
  Json index = {{"runs", Json::array()}, {"truths", Json::object()}, {"manifests", Json::object()}};
  ModuleTimes times;
  std::map<std::string, Flame> flames;
  std::vector<RunSeries> all;
  for (const bench::StoredRun& run : runs) {
    RunSeries series = run_series(store, run);
    const std::vector<eval::CloudPoint> surfaces = std::exchange(series.surfaces, {});
    const std::size_t max_frames = embeds ? frames_per_run(series, runs.size()) : series.t_s.size();
    const RunSeries& shown = all.emplace_back(thinned(series, max_frames));
    Json& entry = index["runs"].emplace_back(run_json(run));
    entry["frames"] = series.t_s.size();
    entry["images"] = series.images.size();
    data.series.push_back(dump_replacing_invalid_utf8(
        series_json(shown, loops_json(store, run, series.start_s),
                    embeds ? eval::thinned_cloud(surfaces, points_per_run(runs.size())) : surfaces)));
    if (has_shown_times(runs, run)) {
      times = with_times(std::move(times), series, system_label(run.identity));
      if (const std::string folded = store.attachment(run, "stacks"); !folded.empty()) {
        flames[clean_line(system_label(run.identity))].add(parse_stacks(folded, "stacks of run " + run.key),
                                                           series.t_s.size());
      }
    }
    const bool has_truth = entry["truth"].is_string();
    if (!embeds) {
      data.truths.push_back(has_truth ? truth_json(store.truth(run)).dump() : "null");
    } else if (has_truth && !index["truths"].contains(entry["truth"].get<std::string>())) {
      index["truths"][entry["truth"].get<std::string>()] = truth_json(store.truth(run));
    }
    if (!run.manifest_hash.empty() && !index["manifests"].contains(run.manifest_hash)) {
      index["manifests"][run.manifest_hash] = Json::parse(store.manifest(run), nullptr, false);
    }
  }
  index["headline"] = headline_json();
  index["tooltips"] = tooltips_json(runs);
  index["flames"] = flames_json(flames);
  index["segments"] = segments_json(segment_figures(store, runs));
  data.index = dump_replacing_invalid_utf8(index);
  data.module_boxes = boxes_of(times);
  data.images = page_images(store, runs, all, embeds ? kImageBudgetBytes : kSideImageBytes);
  return data;
}

}  // namespace stillpoint::report
