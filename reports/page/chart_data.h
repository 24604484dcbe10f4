// SPDX-License-Identifier: BSD-3-Clause
/// Data of the charts of a report page: times at which sensor faults were injected, per-frame time series of
/// a run (position, errors, counters and module times), relative pose error over path segments of increasing
/// length, box plots of module times, and stacks of a flame chart.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/run_csv.h"
#include "bench/store/store.h"
#include "eval/io/ply_file.h"

namespace stillpoint::report {

/// A fault is active during [begin, end), in seconds since the first frame.
struct FaultBand {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string fault;  ///< as in `--fault`
};

/// One value per frame; NaN = missing.
struct SeriesColumn {
  std::string name;  ///< e.g. "error_m", "x", "ms:feature_tracking"
  std::vector<double> values;
};

/// Per-frame time series of a run.
struct RunSeries {
  double start_s = 0.0;     ///< stamp of the first frame
  std::vector<double> t_s;  ///< since the first frame
  /// x, y, z [m] of the camera aligned to the ground truth (unaligned without one), qx, qy, qz of its
  /// rotation (a unit quaternion with qw >= 0), error_m, error_deg, three_sigma_m and three_sigma_deg
  /// (claimed, along the least certain direction), frame_to_frame_error_m (see frame_to_frame_error.h),
  /// features, landmarks, dynamic (fraction of the features), status (position in `OdometryStatus`),
  /// ms:MODULE. Empty columns are omitted.
  std::vector<SeriesColumn> columns;
  /// Indices into `t_s` by falling frame-to-frame error: the frames that have an image, else the 20 worst.
  std::vector<std::size_t> worst;
  std::vector<FaultBand> faults;                 ///< injected ones
  std::vector<std::size_t> numbers;              ///< indices of the frames before thinning; empty: all frames
  std::map<std::size_t, std::string> images;     ///< attachment kind by index into `t_s`
  std::vector<bench::LandmarkSample> landmarks;  ///< aligned like the positions, static ones first
  std::vector<eval::CloudPoint> surfaces;        ///< static ones, aligned like the positions
};

/// The series with about `frames` frames, and at most as many landmarks: equal steps, every frame in which
/// the status changes, and all of `worst` and `images`, whose indices follow. A thinned one has no surfaces:
/// see `thinned_cloud`.
[[nodiscard]] RunSeries thinned(const RunSeries& series, std::size_t frames);

/// @throws InputError if files of the run are missing or damaged
[[nodiscard]] RunSeries run_series(const bench::Store& store, const bench::StoredRun& run);

/// Relative pose error of a variant over path segments of increasing length.
struct SegmentCurve {
  std::string label;
  std::size_t runs = 0;  ///< with any error
  /// Per segment length: median over the variant's runs of each run's mean translational error [% of the
  /// length]; nullopt where no run has a segment of that length.
  std::vector<std::optional<double>> translation_percent;
};

/// All variants on one sequence.
struct SegmentFigure {
  std::string sequence;
  std::vector<double> lengths_m;  ///< 10, 20, 30, 40 and 50 % of the ground truth's path length
  std::vector<SegmentCurve> curves;
};

/// Runs outside sweeps with a ground truth. Metric: Zhang and Scaramuzza, IROS 2018.
/// @throws InputError if files of a run are missing or damaged
[[nodiscard]] std::vector<SegmentFigure> segment_figures(const bench::Store& store,
                                                         std::span<const bench::StoredRun> runs);

/// Quartiles, 5th and 95th percentile, and maximum.
struct PlotBox {
  std::string group;  ///< heading of consecutive boxes, e.g. the module
  std::string label;
  double p5 = 0.0;
  double q1 = 0.0;
  double median = 0.0;
  double q3 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
  std::size_t count = 0;
};

/// @return nullopt without values
[[nodiscard]] std::optional<PlotBox> box_of(std::string group, std::string label,
                                            std::span<const double> values);

/// An SVG on a logarithmic axis, colored by the page's style sheet; empty without boxes.
[[nodiscard]] std::string box_plot_svg(std::span<const PlotBox> boxes, const std::string& title,
                                       const std::string& unit);

/// Stack "outer;inner" -> self time of the innermost entry [ns].
using StackTimes = std::map<std::string, double>;

/// Sums the lines "outer;inner ns" of a file by stack.
/// @param source name of the text in error messages
/// @throws InputError with the number of the first invalid line
[[nodiscard]] StackTimes parse_stacks(std::string_view folded, const std::string& source);

}  // namespace stillpoint::report
