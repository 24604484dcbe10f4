// SPDX-License-Identifier: BSD-3-Clause
#include "reports/drawing/openloris_figure.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "reports/drawing/drawing.h"
#include "reports/drawing/theme.h"

namespace stillpoint::report {
namespace {

constexpr double kFigureWidth = 1000.0;
constexpr double kNameWidth = 176.0;
constexpr double kGap = 14.0;  // between scenes
constexpr double kHeader = 70.0;
constexpr double kRow = 92.0;
constexpr double kFooter = 34.0;
constexpr double kFontSize = 21.0;  // 5.3 pt at the column width of 252 pt
constexpr Color kDivider{215, 215, 215};
constexpr Color kCorrectPose{20, 70, 180};
constexpr Color kTracked{120, 170, 240};
constexpr double kBarWidth = 7.0;
constexpr Color kWrongPose{200, 40, 40};

struct DisplayName {
  std::string_view system;
  std::string_view first;
  std::string_view second;
};

/// The systems evaluated by the authors of the data set (Shi et al., ICRA 2020), in the order of the paper:
/// inertial, visual, dense, wheel odometry.
constexpr std::array<DisplayName, 9> kKnownSystems{{
    {"vins_mono_color_imu_with_loop", "VINS-Mono", "color + IMU"},
    {"vins_mono_fisheye_imu_with_loop", "VINS-Mono", "fisheye + IMU"},
    {"orbslam2_rgbd", "ORB-SLAM2", "RGB-D"},
    {"orbslam2_t265", "ORB-SLAM2", "stereo fisheye"},
    {"ds-slam", "DS-SLAM", "RGB-D"},
    {"dso", "DSO", "RGB, scaled"},
    {"infinitam_aligned_depth", "InfiniTAM", "RGB-D"},
    {"efusion_reloc_aligned_depth", "ElasticFusion", "RGB-D"},
    {"odom", "odometry", "wheels"},
}};

DisplayName display_name(const std::string& system) {
  for (const DisplayName& known : kKnownSystems) {
    if (known.system == system) return known;
  }
  const std::string_view name = system;
  const std::size_t slash = name.rfind('/');
  if (slash == std::string_view::npos) return {name, name, ""};
  return {name, name.substr(slash + 1), name.substr(0, slash)};
}

/// Other systems first, then the known ones in the above order.
std::vector<std::string> ordered_systems(const eval::OpenlorisBenchmark& benchmark) {
  std::vector<std::string> names;
  for (const auto& [name, scenes] : benchmark.systems) names.push_back(name);
  const auto rank = [](const std::string& name) {
    for (std::size_t i = 0; i < kKnownSystems.size(); ++i) {
      if (kKnownSystems[i].system == name) return i + 1;
    }
    return std::size_t{0};
  };
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return names;
}

/// In the order of the paper, followed by other scenes.
std::vector<std::string> ordered_scenes(const eval::OpenlorisBenchmark& benchmark) {
  std::vector<std::string> scenes;
  for (const char* const known : {"office", "home", "cafe", "corridor", "market"}) {
    if (benchmark.gt_durations_s.contains(known)) scenes.emplace_back(known);
  }
  for (const auto& [scene, durations] : benchmark.gt_durations_s) {
    if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) scenes.push_back(scene);
  }
  return scenes;
}

std::string or_dash(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

/// Horizontal extent of one scene in the figure and the start times of its sequences.
struct Panel {
  double left = 0.0;
  double width = 0.0;
  double duration_s = 0.0;
  std::map<int, double> begins_s;

  [[nodiscard]] double x(double seconds) const { return left + width * seconds / duration_s; }
};

Panel panel_of(const std::map<int, double>& durations_s, double left, double width) {
  Panel panel{left, width, 0.0, {}};
  for (const auto& [sequence, seconds] : durations_s) {
    panel.begins_s[sequence] = panel.duration_s;
    panel.duration_s += seconds;
  }
  return panel;
}

void draw_header(Drawing& drawing, const Panel& panel, const std::string& scene) {
  const double y = kHeader - 18.0;
  const std::string heading = fmt::format("{} ({:.0f} s)", scene, panel.duration_s);
  const double size = kFontSize * 1.1;
  drawing.marks.push_back(Label{{panel.left + 0.5 * panel.width, 30.0},
                                heading,
                                size * std::min(1.0, panel.width / text_width(heading, size)),
                                Anchor::kMiddle,
                                theme::kBlack});
  drawing.marks.push_back(Polyline{{{panel.left, y}, {panel.left + panel.width, y}}, theme::kBlack, 2.0});
  for (const auto& [sequence, begin_s] : panel.begins_s) {
    drawing.marks.push_back(Disc{{panel.x(begin_s), y}, 6.0, theme::kBlack});
  }
}

void draw_runs(Drawing& drawing, const Panel& panel, const eval::OpenlorisScene& scene, double y) {
  drawing.marks.push_back(Polyline{{{panel.left, y}, {panel.left + panel.width, y}}, kDivider, 2.0});
  for (const auto& [sequence, run] : scene.runs) {
    const double begin_s = panel.begins_s.at(sequence);
    for (const eval::TrackedSpan& span : run.score.tracked_spans) {
      drawing.marks.push_back(Polyline{
          {{panel.x(begin_s + span.begin_s), y}, {panel.x(begin_s + span.end_s), y}}, kTracked, kBarWidth});
    }
    if (!run.score.relocalization_time_s) continue;
    const bool correct = run.score.relocalization_score > 0.0;
    drawing.marks.push_back(Disc{
        {panel.x(begin_s + *run.score.relocalization_time_s), y}, 5.0, correct ? kCorrectPose : kWrongPose});
  }
}

void draw_numbers(Drawing& drawing, const Panel& panel, const eval::OpenlorisScene& scene, double y) {
  const eval::OpenlorisSceneScore& score = scene.score;
  const double right = panel.left + panel.width;
  drawing.marks.push_back(
      Label{{panel.left, y - 10.0},
            scene.runs.empty() ? "-" : fmt::format("{:.1f}%", 100.0 * score.figure_correct_rate),
            kFontSize,
            Anchor::kLeft,
            theme::kBlack});
  drawing.marks.push_back(Label{
      {right, y - 10.0}, or_dash(score.weighted_ate_rmse_m, 3), kFontSize, Anchor::kRight, theme::kBlack});
  drawing.marks.push_back(
      Label{{right, y + 26.0},
            or_dash(score.rpe.trans_rmse_m_per_s, 3) + "  " + or_dash(score.rpe.rot_rmse_deg_per_s, 2),
            kFontSize,
            Anchor::kRight,
            theme::kBlack});
}

void draw_name(Drawing& drawing, const std::string& system, double y) {
  const DisplayName name = display_name(system);
  drawing.marks.push_back(
      Label{{6.0, y - 4.0}, std::string(name.first), kFontSize, Anchor::kLeft, theme::kBlack});
  drawing.marks.push_back(
      Label{{6.0, y + 22.0}, std::string(name.second), kFontSize * 0.9, Anchor::kLeft, theme::kBlack});
}

}  // namespace

Drawing openloris_figure(const eval::OpenlorisBenchmark& benchmark) {
  const std::vector<std::string> systems = ordered_systems(benchmark);
  const std::vector<std::string> scenes = ordered_scenes(benchmark);
  const double rows = static_cast<double>(systems.size());
  Drawing drawing{kFigureWidth, kHeader + kRow * rows + kFooter, {}};
  const double count = static_cast<double>(scenes.size());
  const double width = (kFigureWidth - kNameWidth - kGap * count) / count;
  double left = kNameWidth;
  for (const std::string& scene : scenes) {
    const Panel panel = panel_of(benchmark.gt_durations_s.at(scene), left, width);
    left += width + kGap;
    draw_header(drawing, panel, scene);
    double y = kHeader + 0.45 * kRow;
    for (const std::string& system : systems) {
      const eval::OpenlorisScene& result = benchmark.systems.at(system).at(scene);
      draw_runs(drawing, panel, result, y);
      draw_numbers(drawing, panel, result, y);
      y += kRow;
    }
  }
  for (std::size_t i = 0; i < systems.size(); ++i) {
    draw_name(drawing, systems[i], kHeader + kRow * (static_cast<double>(i) + 0.45));
  }
  drawing.marks.push_back(
      Label{{6.0, drawing.height - 12.0},
            "above: correct rate, ATE [m]; below: strict T.RPE [m/s], R.RPE [deg/s]; -: no data",
            kFontSize * 0.9,
            Anchor::kLeft,
            theme::kBlack});
  return drawing;
}

}  // namespace stillpoint::report
