// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/calibration_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/fields.h"
#include "reports/drawing/theme.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// With as many digits as the deviation supports.
std::string number_text(double value, double sigma) {
  const int digits = sigma > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 6) : 4;
  return fmt::format("{:.{}f}", value, digits);
}

double sigmas_of(const ParameterEstimate& parameter) {
  return parameter.sigma > 0.0 ? std::abs(parameter.difference()) / parameter.sigma : 0.0;
}

std::string outcome_text(const ParameterEstimate& parameter) {
  if (parameter.outcome == ParameterOutcome::kNotObserved) return "not observed";
  if (parameter.outcome == ParameterOutcome::kAgrees)
    return fmt::format("agrees ({:.1f} sigma)", sigmas_of(parameter));
  return fmt::format("differs by {} ({:.1f} sigma)", number_text(parameter.difference(), parameter.sigma),
                     sigmas_of(parameter));
}

std::string_view outcome_name(ParameterOutcome outcome) {
  constexpr std::string_view kNames[] = {"not_observed", "agrees", "differs"};
  return kNames[static_cast<std::size_t>(outcome)];
}

/// A value that no data sheet errs by: the estimate began far from it, where axes or units are wrong.
bool is_implausible(const ParameterEstimate& parameter) {
  constexpr double kMaxPriorSigmas = 5.0;
  return !parameter.name.starts_with("truth") &&
         std::abs(parameter.difference()) > kMaxPriorSigmas * parameter.prior_sigma;
}

/// What limits the result; empty if nothing does.
std::vector<std::string> remarks(const CalibrationSubject& subject, const CalibrationResult& result) {
  std::vector<std::string> lines;
  if (result.interrupted) lines.emplace_back("interrupted: the values are those of the last iteration");
  if (!result.usable) lines.emplace_back("doubtful: the solver failed, or the deviations cannot be computed");
  if (const auto found = std::ranges::find_if(result.parameters, is_implausible);
      found != result.parameters.end())
    lines.push_back(fmt::format(
        "doubtful: {} is far beyond its prior, as with swapped axes, an inverse T_b_c or another unit; find "
        "the cause with `stillpoint diagnose`, correct the stated calibration, and calibrate again",
        found->name));
  if (!subject.has_imu && result.truth_poses == 0)
    lines.emplace_back(
        "without an IMU the scale is that of the depth sensor: the depth scale cannot be observed");
  if (result.deviation_factor > 3.0)
    lines.push_back(
        fmt::format("doubtful: the halves of the recording differ {:.1f} times more than their residuals "
                    "explain; the deviations are increased by it",
                    result.deviation_factor));
  const HeldOutResiduals& held_out = result.held_out;
  if (result.has_held_out && held_out.pixel_after_px > 1.02 * held_out.pixel_before_px)
    lines.emplace_back("doubtful: with the calibration of one half the residuals of the other half increase");
  return lines;
}

std::string vector_text(const Eigen::Vector3d& values, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", values.x(), digits, values.y(), digits, values.z(),
                     digits);
}

/// Biases in motion; noise and bias where the sensors rest, if they do.
std::vector<std::string> sensor_lines(const CalibrationResult& result) {
  std::vector<std::string> lines;
  if (result.biases) {
    lines.push_back(fmt::format("mean biases: gyroscope {} rad/s, accelerometer {} m/s^2",
                                vector_text(result.biases->gyro, 4), vector_text(result.biases->accel, 3)));
  }
  if (!result.rest) return lines;
  const RestingNoise& rest = *result.rest;
  const ImuNoise& stated = result.calibration.rig.imu_noise;
  const auto density = [&](double value, double stated_value) {
    return fmt::format("{:.2e} +- {:.0f} % (stated {:.2e})", value, 100.0 * rest.relative_sigma,
                       stated_value);
  };
  lines.push_back(fmt::format(
      "at rest ({:.0f} s): gyro_noise {}, accel_noise {}, gyroscope bias {} +- {:.4f} rad/s", rest.seconds,
      density(rest.gyro_noise, stated.gyro_noise), density(rest.accel_noise, stated.accel_noise),
      vector_text(rest.gyro_bias, 4), rest.gyro_bias_sigma));
  return lines;
}

/// Factors below 1 are not estimated.
std::string factor_text(double factor) {
  return fmt::format("{}{:.1f}", factor > 1.0 ? "" : "at most ", factor);
}

std::string residual_text(const CalibrationResult& result) {
  std::string text = fmt::format(
      "{} keyframes, {} points, {} observations, {} depths, {} inertial intervals\n"
      "deviation of a pixel {:.3f} px, of an inverse depth {:.4f} 1/m",
      result.keyframes, result.landmarks, result.observations, result.depths, result.inertial_factors,
      result.pixel_sigma_px, result.inverse_depth_sigma);
  if (result.inertial_factors > 0)
    text += fmt::format("; noise of the IMU {} (gyro) and {} (accel) times the stated one",
                        factor_text(result.imu_noise.gyro), factor_text(result.imu_noise.accel));
  text += '\n';
  for (const std::string& line : sensor_lines(result)) text += line + '\n';
  if (result.truth_poses > 0)
    text += fmt::format(
        "ground truth at {} keyframes; deviation of its positions {:.1f} mm, of its rotations "
        "{:.2f} deg\n",
        result.truth_poses, 1e3 * result.truth_sigma_m, result.truth_sigma_rad * 180.0 / std::numbers::pi);
  if (!result.has_held_out) return text;
  const HeldOutResiduals& held_out = result.held_out;
  return text +
         fmt::format(
             "held out (second half, calibration of the first): pixels {:.3f} -> {:.3f} px, inverse depths "
             "{:.4f} -> {:.4f} 1/m; deviations times {:.2f} by the difference of the halves\n",
             held_out.pixel_before_px, held_out.pixel_after_px, held_out.depth_before, held_out.depth_after,
             result.deviation_factor);
}

}  // namespace

std::string calibration_table(const CalibrationSubject& subject, const CalibrationResult& result) {
  report::TableRows rows = {{"parameter", "unit", "value", "deviation", "stated", "prior", "conclusion"}};
  for (const ParameterEstimate& p : result.parameters) {
    rows.push_back({p.name, p.unit, number_text(p.value, p.sigma), number_text(p.sigma, p.sigma),
                    number_text(p.stated, p.sigma), number_text(p.prior_sigma, p.prior_sigma),
                    outcome_text(p)});
  }
  std::string text = report::format_table(rows, report::TableStyle::kText) + residual_text(result);
  for (const std::string& line : remarks(subject, result)) text += line + '\n';
  return text;
}

std::string calibration_json(const CalibrationSubject& subject, const CalibrationResult& result) {
  Json parameters = Json::array();
  for (const ParameterEstimate& p : result.parameters) {
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"value", p.value},
                          {"sigma", p.sigma},
                          {"stated", p.stated},
                          {"prior_sigma", p.prior_sigma},
                          {"outcome", outcome_name(p.outcome)}});
  }
  const HeldOutResiduals& h = result.held_out;
  Json json = {{"schema", 3},
               {"sequence", subject.sequence},
               {"keyframes", result.keyframes},
               {"landmarks", result.landmarks},
               {"observations", result.observations},
               {"depths", result.depths},
               {"inertial_intervals", result.inertial_factors},
               {"pixel_sigma_px", result.pixel_sigma_px},
               {"inverse_depth_sigma", result.inverse_depth_sigma},
               {"imu_noise_factors", {{"gyro", result.imu_noise.gyro}, {"accel", result.imu_noise.accel}}},
               {"deviation_factor", result.deviation_factor},
               {"parameters", parameters},
               {"interrupted", result.interrupted},
               {"remarks", remarks(subject, result)}};
  if (result.biases)
    json["biases"] = {{"gyro", std::span(result.biases->gyro.data(), 3)},
                      {"gyro_spread", std::span(result.biases->gyro_spread.data(), 3)},
                      {"accel", std::span(result.biases->accel.data(), 3)},
                      {"accel_spread", std::span(result.biases->accel_spread.data(), 3)}};
  if (result.rest)
    json["rest"] = {{"seconds", result.rest->seconds},
                    {"gyro_noise", result.rest->gyro_noise},
                    {"accel_noise", result.rest->accel_noise},
                    {"relative_sigma", result.rest->relative_sigma},
                    {"gyro_bias", std::span(result.rest->gyro_bias.data(), 3)},
                    {"gyro_bias_sigma", result.rest->gyro_bias_sigma}};
  if (result.truth_poses > 0)
    json["truth"] = {{"keyframes", result.truth_poses},
                     {"sigma_m", result.truth_sigma_m},
                     {"sigma_rad", result.truth_sigma_rad}};
  if (result.has_held_out)
    json["held_out"] = {{"pixel_before_px", h.pixel_before_px},
                        {"pixel_after_px", h.pixel_after_px},
                        {"depth_before", h.depth_before},
                        {"depth_after", h.depth_after}};
  return json.dump(2) + "\n";
}

namespace {

/// Lines of a rig file with comments about the estimated values.
class RigLines {
 public:
  explicit RigLines(const CalibrationResult& result) : result_(result) {}

  /// "key = value  # ...": the comment of the parameters with this prefix.
  void add(const std::string& key, double value, const std::string& parameter = "") {
    add_text(key, fmt::format("{:.17g}", value), parameter.empty() ? key : parameter);
  }
  void add_pose(const std::string& key, const Pose& pose) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
    for (const ParameterEstimate& p : result_.parameters) {
      if (p.name.starts_with(key + " ")) text_ += fmt::format("# {}: {}\n", p.name, comment(p));
    }
    text_ += fmt::format("{} = [{:.17g}]\n", key, fmt::join(rows.data(), rows.data() + 16, ", "));
  }
  /// Axes of a sensor: "gyro" or "accel".
  void add_axes(const std::string& sensor, const Eigen::Matrix3d& axes) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = axes;
    for (const ParameterEstimate& p : result_.parameters) {
      if (p.name.starts_with(sensor + " ")) text_ += fmt::format("# {}: {}\n", p.name, comment(p));
    }
    text_ += fmt::format("{}_axes = [{:.17g}]\n", sensor, fmt::join(rows.data(), rows.data() + 9, ", "));
  }
  void add_text(const std::string& key, const std::string& value, const std::string& parameter = "") {
    const auto found = std::ranges::find(result_.parameters, parameter, &ParameterEstimate::name);
    text_ += fmt::format("{} = {}{}\n", key, value,
                         found == result_.parameters.end() ? "" : "  # " + comment(*found));
  }
  void add_line(const std::string& line) { text_ += line + '\n'; }
  /// A comment of its own line.
  void add_comment(const std::string& parameter) {
    const auto found = std::ranges::find(result_.parameters, parameter, &ParameterEstimate::name);
    if (found != result_.parameters.end()) add_line(fmt::format("# {}: {}", parameter, comment(*found)));
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string comment(const ParameterEstimate& p) {
    if (p.outcome == ParameterOutcome::kNotObserved && p.difference() == 0.0)
      return "not observed, as stated";
    const std::string unit = p.unit.empty() ? "" : " " + p.unit;
    return fmt::format(
        "{}{} +- {}{}, was {}",
        p.outcome == ParameterOutcome::kNotObserved ? "not observed, changed with the others: " : "",
        number_text(p.value, p.sigma), number_text(p.sigma, p.sigma), unit, number_text(p.stated, p.sigma));
  }

  const CalibrationResult& result_;
  std::string text_;
};

std::string model_text(CameraModel model) {
  for (const auto& [value, name] : enum_names(CameraModel{})) {
    if (value == model) return fmt::format("\"{}\"", name);
  }
  return "";
}

std::string calibrated_rig_text(const CalibrationSubject& subject, const CalibrationResult& result) {
  const Rig& rig = result.calibration.rig;
  RigLines lines(result);
  lines.add_line("# By `stillpoint calibrate` from " + report::clean_line(subject.sequence) +
                 ": value +- standard deviation, was the stated value");
  for (const std::string& line : remarks(subject, result)) lines.add_line("# " + line);
  lines.add_line("[camera]");
  lines.add_text("width", fmt::format("{}", rig.camera.width));
  lines.add_text("height", fmt::format("{}", rig.camera.height));
  lines.add("fx", rig.camera.fx);
  lines.add("fy", rig.camera.fy);
  lines.add("cx", rig.camera.cx);
  lines.add("cy", rig.camera.cy);
  lines.add_text("model", model_text(rig.camera.model));
  lines.add_comment("k1");
  lines.add_comment("k2");
  lines.add_text("distortion", fmt::format("[{:.17g}]", fmt::join(rig.camera.coefficients(), ", ")));
  lines.add("rolling_shutter_s", std::max(0.0, rig.rolling_shutter_s));
  lines.add_line("\n[depth]");
  lines.add("scale", rig.depth_units_per_m, "depth scale");
  lines.add("offset", rig.depth_offset, "depth offset");
  lines.add_comment("depth shift x");
  lines.add_comment("depth shift y");
  if (subject.has_depth_camera) {
    const Camera& camera = result.calibration.depth_camera;
    lines.add_text("width", fmt::format("{}", camera.width));
    lines.add_text("height", fmt::format("{}", camera.height));
    lines.add("fx", camera.fx, "depth fx");
    lines.add("fy", camera.fy, "depth fy");
    lines.add("cx", camera.cx, "depth cx");
    lines.add("cy", camera.cy, "depth cy");
    lines.add_pose("T_c_d", result.calibration.T_c_d);
  }
  if (!rig.has_imu) return lines.text();
  lines.add_line("\n[imu]");
  lines.add_pose("T_b_c", rig.T_b_c);
  for (const std::string& line : sensor_lines(result)) lines.add_line("# " + line);
  lines.add("gyro_noise", rig.imu_noise.gyro_noise);
  lines.add("accel_noise", rig.imu_noise.accel_noise);
  lines.add("gyro_walk", rig.imu_noise.gyro_walk);
  lines.add("accel_walk", rig.imu_noise.accel_walk);
  lines.add("time_offset_s", rig.time_offset_s);
  lines.add_axes("gyro", rig.imu_axes.gyro);
  lines.add_axes("accel", rig.imu_axes.accel);
  return lines.text();
}

}  // namespace

std::string calibration_file_text(const CalibrationSubject& subject, const CalibrationResult& result,
                                  datasets::RigFormat format) {
  if (format == datasets::RigFormat::kStillpoint) return calibrated_rig_text(subject, result);
  std::string text = datasets::rig_text(result.calibration.rig, format);
  // At the end: OpenCV requires the first line of YAML files.
  if (const double offset = result.calibration.rig.depth_offset; offset != 0.0)
    text +=
        fmt::format("# inverse depths are {:.4f} 1/m too large, which this format does not state\n", offset);
  for (const std::string& line : remarks(subject, result)) text += "# " + line + '\n';
  return text;
}

namespace {

namespace theme = report::theme;
using report::Point2;

constexpr int kColumns = 16;
constexpr int kLeastCount = 5;  // residuals in a cell whose mean is drawn
constexpr double kPanelWidth = 240.0, kMargin = 10.0, kHeading = 34.0;

struct Cell {
  Eigen::Vector2d sum_px = Eigen::Vector2d::Zero();
  int count = 0;

  [[nodiscard]] bool is_drawn() const { return count >= kLeastCount; }
  [[nodiscard]] Eigen::Vector2d mean_px() const { return sum_px / count; }
};

/// Means over a grid of square cells, row by row.
struct Field {
  std::vector<Cell> cells;
  int rows = 1;

  Field(std::span<const ImageResidual> residuals, const Camera& camera) {
    const double side_px = static_cast<double>(camera.width) / kColumns;
    rows = std::max(1, static_cast<int>(std::ceil(camera.height / side_px)));
    cells.resize(static_cast<std::size_t>(rows * kColumns));
    for (const ImageResidual& residual : residuals) {
      const int column = std::clamp(static_cast<int>(residual.pixel.x() / side_px), 0, kColumns - 1);
      const int row = std::clamp(static_cast<int>(residual.pixel.y() / side_px), 0, rows - 1);
      Cell& cell = cells[static_cast<std::size_t>(row * kColumns + column)];
      cell.sum_px += residual.error_px;
      ++cell.count;
    }
  }

  [[nodiscard]] double largest_px() const {
    double largest = 0.0;
    for (const Cell& cell : cells)
      if (cell.is_drawn()) largest = std::max(largest, cell.mean_px().norm());
    return largest;
  }

  [[nodiscard]] double rms_px() const {
    double sum = 0.0;
    int count = 0;
    for (const Cell& cell : cells) {
      if (!cell.is_drawn()) continue;
      sum += cell.mean_px().squaredNorm();
      ++count;
    }
    return count == 0 ? 0.0 : std::sqrt(sum / count);
  }
};

void add_line(report::Drawing& drawing, std::vector<Point2> points, const report::Color& color,
              double width) {
  drawing.marks.emplace_back(report::Polyline{.points = std::move(points), .color = color, .width = width});
}

/// A line from the tail with a disc at the tail: the other end is where the prediction is.
void add_arrow(report::Drawing& drawing, const Point2& tail, const Eigen::Vector2d& along) {
  const report::Color& color = theme::kEstimates.front().color;
  drawing.marks.emplace_back(report::Disc{.center = tail, .radius = 0.9, .color = color});
  add_line(drawing, {tail, {tail.x + along.x(), tail.y + along.y()}}, color, theme::kEstimateWidth);
}

/// @param scale units of the drawing per pixel of the residuals
void add_panel(report::Drawing& drawing, const Field& field, double left, double scale) {
  const double side = kPanelWidth / kColumns, bottom = kHeading + field.rows * side;
  add_line(drawing,
           {{left, kHeading},
            {left + kPanelWidth, kHeading},
            {left + kPanelWidth, bottom},
            {left, bottom},
            {left, kHeading}},
           theme::kFrame, theme::kFrameWidth);
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Cell& cell = field.cells[static_cast<std::size_t>(row * kColumns + column)];
      if (!cell.is_drawn()) continue;
      add_arrow(drawing, {left + (column + 0.5) * side, kHeading + (row + 0.5) * side},
                scale * cell.mean_px());
    }
  }
}

void add_text(report::Drawing& drawing, const Point2& at, const std::string& text) {
  drawing.marks.emplace_back(
      report::Label{.at = at, .text = text, .size = theme::kFontSizePt, .color = theme::kBlack});
}

}  // namespace

report::Drawing parameter_figure(const CalibrationSubject& subject, const CalibrationResult& result) {
  constexpr double kRow = 12.0, kColumnsAt[] = {kMargin, 100.0, 130.0, 180.0, 230.0, 280.0};
  report::Drawing drawing{.width = 2.0 * kPanelWidth + 3.0 * kMargin,
                          .height = kRow * (static_cast<double>(result.parameters.size()) + 3.0),
                          .title = "Parameters",
                          .unit_is_a_point = true};
  double y = kRow;
  const auto add_row = [&](const std::array<std::string, 6>& cells, const report::Color& color) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      drawing.marks.emplace_back(report::Label{
          .at = {kColumnsAt[i], y}, .text = cells[i], .size = theme::kFontSizePt, .color = color});
    y += kRow;
  };
  add_text(drawing, {kMargin, y}, "calibration from " + report::clean_line(subject.sequence));
  y += 1.5 * kRow;
  add_row({"parameter", "unit", "value", "deviation", "stated", "conclusion"}, theme::kBlack);
  add_line(drawing, {{kMargin, y - 0.75 * kRow}, {drawing.width - kMargin, y - 0.75 * kRow}}, theme::kFrame,
           theme::kFrameWidth);
  for (const ParameterEstimate& p : result.parameters)
    add_row({p.name, p.unit, number_text(p.value, p.sigma), number_text(p.sigma, p.sigma),
             number_text(p.stated, p.sigma), outcome_text(p)},
            p.outcome == ParameterOutcome::kDiffers  ? theme::kRed
            : p.outcome == ParameterOutcome::kAgrees ? theme::kBlack
                                                     : theme::kFrame);
  return drawing;
}

report::Drawing residual_figure(const HeldOutResiduals& residuals, const Camera& camera) {
  const Field before(residuals.before, camera), after(residuals.after, camera);
  const double side = kPanelWidth / kColumns;
  const double largest_px = std::max({before.largest_px(), after.largest_px(), 1e-6});
  const double cell_px = 2.0 * largest_px;  // the longest line ends at the border of its cell
  report::Drawing drawing{.width = 2.0 * kPanelWidth + 3.0 * kMargin,
                          .height = kHeading + before.rows * side + 20.0,
                          .title = "Residual fields",
                          .unit_is_a_point = true};
  const double left[] = {kMargin, 2.0 * kMargin + kPanelWidth};
  add_text(drawing, {left[0], 12.0}, "stated calibration");
  add_text(drawing, {left[1], 12.0}, "found calibration, that of the first half");
  const auto summary = [](double rms_px, const Field& field) {
    return fmt::format("residuals {:.3f} px, means of cells {:.3f} px", rms_px, field.rms_px());
  };
  add_text(drawing, {left[0], 26.0}, summary(residuals.pixel_before_px, before));
  add_text(drawing, {left[1], 26.0}, summary(residuals.pixel_after_px, after));
  add_panel(drawing, before, left[0], side / cell_px);
  add_panel(drawing, after, left[1], side / cell_px);
  add_text(drawing, {left[0], drawing.height - 6.0},
           fmt::format("lines: mean of a cell of {:.0f} px, from where points are seen (dots) to where they "
                       "are predicted, in the second half; the side of a cell is {:.2f} px",
                       static_cast<double>(camera.width) / kColumns, cell_px));
  return drawing;
}

}  // namespace stillpoint::bench
