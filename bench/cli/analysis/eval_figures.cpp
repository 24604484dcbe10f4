// SPDX-License-Identifier: BSD-3-Clause
// Figures of `stillpoint eval`.
#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/analysis/eval_results.h"
#include "bench/cli/command_line.h"
#include "core/base/error.h"
#include "datasets/mapping/occupancy_grid.h"
#include "datasets/tiles/map_tiles.h"
#include "eval/io/text_reader.h"
#include "reports/drawing/evaluation/figures.h"

namespace stillpoint::bench {
namespace {

constexpr double kPixelsPerPoint = report::theme::kPixelsPerInch / 72.0;

/// "column", "page", or a length in millimeters: "85mm".
double width_mm(const std::string& text) {
  if (text == "column") return report::theme::kColumnWidthMm;
  if (text == "page") return report::theme::kPageWidthMm;
  constexpr std::string_view kUnit = "mm";
  constexpr double kLeast = 40.0;
  constexpr double kMost = 1000.0;
  const std::string_view view = text;
  const auto number =
      view.ends_with(kUnit) ? eval::parse_number(view.substr(0, view.size() - kUnit.size())) : std::nullopt;
  if (!number || !(*number >= kLeast && *number <= kMost)) {
    throw InputError("--width " + text,
                     fmt::format("expected column, page, or a length from {:g}mm to {:g}mm", kLeast, kMost));
  }
  return *number;
}

/// The kinds of --figure, "all" being all; without any, path and errors.
std::vector<report::FigureKind> figure_kinds(const EvalArguments& arguments) {
  std::vector<report::FigureKind> kinds;
  for (const std::string& name : arguments.figures) {
    const std::size_t before = kinds.size();
    for (const auto& [kind, known] : enum_names(report::FigureKind{}))
      if (name == "all" || name == known) kinds.push_back(kind);
    if (kinds.size() == before) {
      throw InputError("--figure", fmt::format("unknown value \"{}\"; expected one of: {}, all", name,
                                               enum_list<report::FigureKind>()));
    }
  }
  if (kinds.empty()) kinds = {report::FigureKind::kPath, report::FigureKind::kError};
  return kinds;
}

bool draws(const EvalArguments& arguments, std::initializer_list<report::FigureKind> any_of) {
  const std::vector<report::FigureKind> kinds = figure_kinds(arguments);
  return !arguments.plot.empty() && std::ranges::any_of(kinds, [&](auto kind) {
    return std::ranges::find(any_of, kind) != any_of.end();
  });
}

/// @throws InputError naming the first option of the path figure that changes nothing of what is drawn
void require_path_figure(const EvalArguments& arguments) {
  const std::array<std::pair<const char*, bool>, 8> options{
      {{"--plot-mode", !arguments.plot_mode.empty()},
       {"--path-mark", !arguments.path_marks.empty()},
       {"--path-color", !arguments.path_color.empty()},
       {"--colormap-min", arguments.colormap_min > 0.0},
       {"--colormap-max", arguments.colormap_max > 0.0},
       {"--colormap-percentile", arguments.colormap_percentile > 0.0},
       {"--occupancy-grid", !arguments.occupancy_grid.empty()},
       {"--map-tiles", !arguments.map_tiles.empty()}}};
  const bool draws_path = !arguments.map.empty() || draws(arguments, {report::FigureKind::kPath});
  for (const auto& [name, is_given] : options) {
    if (!is_given) continue;
    if (!draws_path)
      throw InputError(name, "changes the path figure only; add --plot FILE.pdf --figure path");
    const bool colors = std::string_view(name).find("color") != std::string_view::npos;
    if (colors && arguments.files.estimates.size() > 1)
      throw InputError(name, "only the path of a single estimate is colored by its error; give one EST");
  }
}

/// @throws InputError for a map that is not below the paths, or lacks what it requires
void require_map(const EvalArguments& arguments, std::optional<report::PlotMode> mode) {
  const bool has_tiles = !arguments.map_tiles.empty();
  const bool has_plane = !mode || *mode == report::PlotMode::kXy || *mode == report::PlotMode::kYx;
  for (const auto& [name, is_given] :
       {std::pair{"--occupancy-grid", !arguments.occupancy_grid.empty()}, {"--map-tiles", has_tiles}}) {
    if (is_given && !has_plane) throw InputError(name, "is a map in x and y; use --plot-mode xy or yx");
  }
  for (const auto& [name, value] :
       {std::pair{"--map-crs", &arguments.map_crs}, std::pair{"--map-credit", &arguments.map_credit}}) {
    if (!has_tiles && !value->empty()) throw InputError(name, "changes --map-tiles only; add it");
  }
  if (!has_tiles) return;
  if (!arguments.occupancy_grid.empty())
    throw InputError("--map-tiles", "cannot be combined with --occupancy-grid; omit one of them");
  if (arguments.map_crs.empty()) {
    throw InputError("--map-tiles",
                     "requires the coordinate reference system of the ground truth; add for example "
                     "--map-crs EPSG:32632");
  }
  if (arguments.map_tiles.starts_with("http") && arguments.map_credit.empty()) {
    throw InputError("--map-tiles",
                     "tiles of a server require the attribution of their provider; add for example "
                     "--map-credit \"OpenStreetMap contributors\"");
  }
  datasets::require_map_tiles({arguments.map_tiles, arguments.map_crs});
}

/// The map below the paths; empty without one.
datasets::MapSource map_source(const EvalArguments& arguments) {
  if (!arguments.map_tiles.empty()) {
    return [tiles = datasets::MapTiles{arguments.map_tiles, arguments.map_crs}](const auto& window) {
      return datasets::map_image(tiles, window);
    };
  }
  if (arguments.occupancy_grid.empty()) return {};
  return [grid = datasets::read_occupancy_grid(arguments.occupancy_grid)](const auto& window) {
    return datasets::map_image(grid, window);
  };
}

/// @throws InputError for an option of the path figure that is unknown or has nothing to change
report::PathOptions path_options(const EvalArguments& arguments) {
  require_path_figure(arguments);
  report::PathOptions options{.least_error = arguments.colormap_min};
  if (!arguments.plot_mode.empty())
    options.mode = enum_of<report::PlotMode>("--plot-mode", arguments.plot_mode);
  if (!arguments.path_color.empty())
    options.color = enum_of<report::PathColor>("--path-color", arguments.path_color);
  for (const std::string& mark : arguments.path_marks) {
    if (mark != "axes" && mark != "correspondences") {
      throw InputError("--path-mark",
                       fmt::format("unknown value \"{}\"; expected one of: axes, correspondences", mark));
    }
    (mark == "axes" ? options.pose_axes : options.correspondences) = true;
  }
  if (arguments.colormap_max > 0.0) options.most_error = arguments.colormap_max;
  if (arguments.colormap_percentile > 0.0) options.most_percentile = arguments.colormap_percentile;
  if (options.most_error && arguments.colormap_percentile > 0.0)
    throw InputError("--colormap-percentile", "is another upper limit than --colormap-max; omit one of them");
  require_map(arguments, options.mode);
  options.map_credit = arguments.map_credit;
  return options;
}

/// @throws InputError for an axis that is unknown, or over which nothing is drawn
std::optional<report::ErrorAxis> error_axis(const EvalArguments& arguments) {
  if (arguments.error_axis.empty()) return std::nullopt;
  const auto axis = enum_of<report::ErrorAxis>("--error-axis", arguments.error_axis);
  if (!draws(arguments,
             {report::FigureKind::kError, report::FigureKind::kRelative, report::FigureKind::kTransform})) {
    throw InputError(
        "--error-axis",
        "changes the figures error, relative and transform only; add --plot FILE.pdf --figure error");
  }
  return axis;
}

/// A figure, or nullopt with a warning if it has no data and was not named.
std::optional<report::Drawing> figure_if_any(report::FigureKind kind, const report::FigureInput& input,
                                             const report::FigureSize& size, bool was_named) {
  try {
    return report::figure(kind, input, size);
  } catch (const InputError& error) {
    if (was_named) throw;
    spdlog::warn("figure omitted: {}", error.what());
    return std::nullopt;
  }
}

}  // namespace

void require_figures(const EvalArguments& arguments, const OutputRules& rules) {
  if (!arguments.labels.empty() && arguments.labels.size() != arguments.files.estimates.size()) {
    throw InputError("--label", fmt::format("{} names for {} estimates; give one for each, in their order",
                                            arguments.labels.size(), arguments.files.estimates.size()));
  }
  const std::set<std::string> names(arguments.labels.begin(), arguments.labels.end());
  if (names.size() < arguments.labels.size())
    throw InputError("--label", "gives two estimates one name; they could not be told apart");
  static_cast<void>(figure_kinds(arguments));
  static_cast<void>(path_options(arguments));
  static_cast<void>(error_axis(arguments));
  static_cast<void>(width_mm(arguments.width));
  if (!arguments.figures.empty() && arguments.plot.empty())
    throw InputError("--figure", "needs a file: --plot FILE.pdf");
  if (!arguments.plot.empty()) report::require_drawing_file(arguments.plot, rules);
  if (!arguments.map.empty()) report::require_drawing_file(arguments.map, rules);
}

void write_figures(const EvalArguments& arguments, const Trajectory& gt,
                   const std::vector<report::EvaluatedRun>& runs, const OutputRules& rules) {
  std::vector<report::PlottedRun> plotted;
  plotted.reserve(runs.size());
  for (const report::EvaluatedRun& run : runs)
    plotted.push_back({run.name, &run.est, &run.evaluations.front()});
  report::FigureInput input{.gt = gt, .runs = plotted, .offset_s = arguments.offset_s};
  input.path = path_options(arguments);
  input.path.map = map_source(arguments);
  input.error_axis = error_axis(arguments);
  const RpeDelta delta = rpe_deltas(arguments).front();
  input.rpe_delta = delta.value;
  input.rpe_unit = delta.unit;
  if (arguments.max_difference_s > 0.0) input.max_gap_s = arguments.max_difference_s;
  const report::FigureSize size{width_mm(arguments.width), arguments.font_size_pt};
  if (!arguments.plot.empty()) {
    const bool all = std::ranges::find(arguments.figures, "all") != arguments.figures.end();
    std::vector<report::Drawing> drawings;
    for (const report::FigureKind kind : figure_kinds(arguments)) {
      if (auto drawing = figure_if_any(kind, input, size, !all)) drawings.push_back(std::move(*drawing));
    }
    report::write_drawings(arguments.plot, drawings, kPixelsPerPoint, rules);
  }
  if (!arguments.map.empty()) {
    const std::array<report::Drawing, 1> map{report::plan_map(input, size)};
    report::write_drawings(arguments.map, map, kPixelsPerPoint, rules);
  }
}

}  // namespace stillpoint::bench
