// SPDX-License-Identifier: BSD-3-Clause
/// Arguments of `stillpoint eval`, and its output: tables, JSON and figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/cli/analysis/pose_files.h"
#include "bench/record/output_folder.h"
#include "eval/protocols/protocol.h"
#include "reports/drawing/theme.h"
#include "reports/text/evaluation_report.h"

namespace stillpoint::bench {

struct EvalArguments {
  PoseFilePaths files;
  std::vector<std::string> protocols;
  std::string alignment;
  int align_first = 0;
  std::vector<std::string> rpe_deltas;
  std::string rpe_unit = "s";
  double offset_s = 0.0;
  double max_difference_s = 0.0;
  std::string level;
  bool find_offset = false;
  bool statistics = false;
  bool explain = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
  std::string plot;
  std::string map;
  std::vector<std::string> figures;
  std::string plot_mode;
  std::vector<std::string> path_marks;
  std::string path_color;
  double colormap_min = 0.0;
  double colormap_max = 0.0;
  double colormap_percentile = 0.0;
  std::string occupancy_grid;
  std::string map_tiles;
  std::string map_crs;
  std::string map_credit;
  std::string error_axis;
  std::vector<std::string> labels;
  std::string width = "column";
  double font_size_pt = report::theme::kFontSizePt;
  std::string per_pose;
  bool force = false;
};

/// Interval of relative errors.
struct RpeDelta {
  double value = 1.0;
  eval::RpeUnit unit = eval::RpeUnit::kSeconds;
};

/// The intervals of --rpe-delta, at least one: "1", in --rpe-unit, or with a unit: "5m", "10f", "30deg".
/// @throws InputError for an unknown unit, or what is not a number from 1e-6 to 1e6
[[nodiscard]] std::vector<RpeDelta> rpe_deltas(const EvalArguments& arguments);

inline constexpr const char* kHandEyeAlignment = "hand-eye";

/// The options, with the first of `rpe_deltas`. Hand-eye calibration is followed by an SE(3) alignment.
[[nodiscard]] eval::ProtocolOptions protocol_options(const EvalArguments& arguments);

/// The estimate with --offset added to its stamps.
[[nodiscard]] Trajectory shifted_estimate(const EvalArguments& arguments, const report::EvaluatedRun& run);

/// With one pose, a run has failed: after alignment it has no error, whatever it is.
[[nodiscard]] bool has_failed(const report::EvaluatedRun& run);

/// The document of a single estimate has the keys of a result.json at its top level.
[[nodiscard]] nlohmann::ordered_json evaluation_document(const EvalArguments& arguments,
                                                         const eval::LoadedTrajectory& truth,
                                                         const std::vector<report::EvaluatedRun>& runs);

/// Prints the tables, and logs notes and warnings.
void print_evaluations(const EvalArguments& arguments, const Trajectory& gt,
                       const std::vector<report::EvaluatedRun>& runs);

/// Checks the options of figures, and the files that they would replace, before the work begins.
/// @throws InputError for an unknown figure, a width that is no length, or a file that must not be replaced
void require_figures(const EvalArguments& arguments, const OutputRules& rules);

/// Writes --plot and --map. A figure without data is an error if it was named, and a warning with "all".
/// @throws InputError as above, or if a file cannot be written
void write_figures(const EvalArguments& arguments, const Trajectory& gt,
                   const std::vector<report::EvaluatedRun>& runs, const OutputRules& rules);

}  // namespace stillpoint::bench
