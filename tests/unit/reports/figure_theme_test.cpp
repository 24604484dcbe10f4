// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "reports/drawing/chart.h"
#include "reports/drawing/theme.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

/// IEC 61966-2-1.
Eigen::Vector3d linear_rgb(const Color& color) {
  const auto linear = [](int part) {
    const double value = part / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  return {linear(color.red), linear(color.green), linear(color.blue)};
}

double luminance(const Color& color) {
  return Eigen::Vector3d(0.2126, 0.7152, 0.0722).dot(linear_rgb(color));
}

/// As in WCAG 2.1.
double contrast(const Color& a, const Color& b) {
  const auto [dark, light] = std::minmax({luminance(a), luminance(b)});
  return (light + 0.05) / (dark + 0.05);
}

/// L* a* b* with the white point D65.
Eigen::Vector3d cielab(const Eigen::Vector3d& rgb) {
  Eigen::Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Eigen::Vector3d xyz = (to_xyz * rgb).cwiseQuotient(Eigen::Vector3d(0.9505, 1.0, 1.089));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(xyz.y()) - 16.0, 500.0 * (f(xyz.x()) - f(xyz.y())), 200.0 * (f(xyz.y()) - f(xyz.z()))};
}

/// Matrices of Machado et al., IEEE TVCG 2009, severity 1: identity, protanopia, deuteranopia, tritanopia.
std::vector<Eigen::Matrix3d> vision_models() {
  std::vector<Eigen::Matrix3d> models(4, Eigen::Matrix3d::Identity());
  models[1] << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  models[2] << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  models[3] << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
  return models;
}

constexpr Color kPaper{255, 255, 255};

/// Smallest distance in CIELAB of two of the colors, for any kind of vision.
double smallest_distance(const std::vector<Color>& colors) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& model : vision_models()) {
    std::vector<Eigen::Vector3d> seen;
    for (const Color& color : colors) {
      seen.push_back(cielab((model * linear_rgb(color)).cwiseMax(0.0).cwiseMin(1.0)));
      for (std::size_t i = 0; i + 1 < seen.size(); ++i)
        smallest = std::min(smallest, (seen.back() - seen[i]).norm());
    }
  }
  return smallest;
}

TEST(FigureTheme, ColorsDifferFromPaper) {
  for (const theme::LineStyle& style : theme::kEstimates) EXPECT_GE(contrast(style.color, kPaper), 3.0);
  EXPECT_GE(contrast(theme::kTruth.color, kPaper), 12.0);
}

TEST(FigureTheme, ColorsDifferForEveryKindOfVision) {
  std::vector<Color> colors;
  for (const theme::LineStyle& style : theme::kEstimates) colors.push_back(style.color);
  EXPECT_GE(smallest_distance(colors), 30.0);
}

TEST(FigureTheme, ColorsDifferInGray) {
  std::vector<double> lightness;
  for (const theme::LineStyle& style : theme::kEstimates)
    lightness.push_back(cielab(linear_rgb(style.color)).x());
  std::ranges::sort(lightness);
  for (std::size_t i = 1; i < lightness.size(); ++i) EXPECT_GE(lightness[i] - lightness[i - 1], 5.0);
}

TEST(FigureTheme, LineStylesDifferWithoutColor) {
  for (std::size_t i = 0; i < theme::kEstimates.size(); ++i) {
    EXPECT_NE(theme::kEstimates[i].dashes, theme::kTruth.dashes);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(theme::kEstimates[i].dashes, theme::kEstimates[j].dashes);
  }
}

TEST(FigureTheme, LinesOf36EstimatesDiffer) {
  for (std::size_t i = 0; i < 36; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const theme::LineStyle a = theme::style_of_estimate(i);
      const theme::LineStyle b = theme::style_of_estimate(j);
      EXPECT_TRUE(a.color.red != b.color.red || a.dashes != b.dashes) << i << " " << j;
    }
  }
}

TEST(FigureTheme, LargeErrorsAreDarker) {
  for (int k = 0; k < 20; ++k)
    EXPECT_GE(luminance(error_color(k / 20.0, 1.0)), luminance(error_color((k + 1) / 20.0, 1.0)) - 1e-3) << k;
}

/// Colors of report page and dashboard in one theme, by the name of their variable in page.css.
using PageColors = std::map<std::string, Color>;

/// The variables "--NAME: #rrggbb" of a block.
PageColors variables_of(const std::string& block) {
  PageColors colors;
  for (std::size_t at = block.find("--"); at != std::string::npos; at = block.find("--", at + 2)) {
    const std::size_t end = block.find(": #", at);
    unsigned rgb = 0;
    if (end == std::string::npos) break;
    const char* digits = block.data() + end + 3;
    if (std::from_chars(digits, digits + 6, rgb, 16).ptr != digits + 6) continue;
    colors[block.substr(at + 2, end - at - 2)] =
        Color{static_cast<int>(rgb >> 16), static_cast<int>(rgb >> 8 & 0xFF), static_cast<int>(rgb & 0xFF)};
  }
  return colors;
}

/// From the beginning of a selector to the end of its block.
std::string block_of(const std::string& selector) {
  const std::string css(web_file("page.css"));
  const std::size_t begin = css.find(selector + " {");
  EXPECT_NE(begin, std::string::npos) << selector;
  return css.substr(begin, css.find('}', begin) - begin);
}

std::vector<PageColors> page_themes() {
  return {variables_of(block_of(":root")), variables_of(block_of(":root[data-theme=\"dark\"]"))};
}

std::vector<Color> colors_of(const PageColors& page, const std::vector<std::string>& names) {
  std::vector<Color> colors;
  for (const std::string& name : names) colors.push_back(page.at(name));
  return colors;
}

bool is_same(const Color& a, const Color& b) {
  return a.red == b.red && a.green == b.green && a.blue == b.blue;
}

/// color-mix(in srgb, COLOR SHARE, OTHER)
Color mixed(const Color& color, double share, const Color& other) {
  const auto part = [&](int a, int b) {
    return static_cast<int>(std::lround(share * a + (1.0 - share) * b));
  };
  return {part(color.red, other.red), part(color.green, other.green), part(color.blue, other.blue)};
}

TEST(PageTheme, TheDarkColorsAreTheSameByButtonAndBySystem) {
  const std::string by_button = block_of(":root[data-theme=\"dark\"]");
  const std::string by_system = block_of(":root:not([data-theme=\"light\"])");
  EXPECT_EQ(variables_of(by_button).size(), page_themes().front().size());
  const PageColors other = variables_of(by_system);
  for (const auto& [name, color] : variables_of(by_button))
    EXPECT_TRUE(is_same(color, other.at(name))) << name;
}

// WCAG 2.1, level AA: text 4.5 (1.4.3), lines and marks 3 (1.4.11).
TEST(PageTheme, TextsLinesAndMarksHaveTheContrastOfLevelAa) {
  for (const PageColors& page : page_themes()) {
    for (const char* name : {"ink", "faint", "accent", "bad"})
      EXPECT_GE(contrast(page.at(name), page.at("background")), 4.5) << name;
    for (const char* name : {"ink", "accent", "bad"})  // controls and code
      EXPECT_GE(contrast(page.at(name), page.at("soft")), 4.5) << name;
    for (const char* name :
         {"c0", "c1", "c2", "c3", "c4", "c5", "good", "caution", "other", "worse", "better"})
      EXPECT_GE(contrast(page.at(name), page.at("background")), 3.0) << name;
  }
}

TEST(PageTheme, LinesDifferForEveryKindOfVision) {
  for (const PageColors& page : page_themes()) {
    EXPECT_GE(smallest_distance(colors_of(page, {"c0", "c1", "c2", "c3", "c4", "c5"})), 30.0);
    EXPECT_GE(smallest_distance(colors_of(page, {"worse", "better"})), 30.0);
  }
}

// Areas need smaller distances than lines: the model of Stone, Szafir and Setlur (Color and Imaging
// Conference 2014) has 7, 10 and 13 in L*, a* and b* as noticeable for half of the viewers at 14 px (0.37
// degrees).
TEST(PageTheme, StatusColorsDifferForEveryKindOfVision) {
  for (const PageColors& page : page_themes()) {
    std::vector<Color> colors = colors_of(page, {"bad", "caution", "other", "good"});
    colors.push_back(mixed(page.at("accent"), 0.35, page.at("background")));  // tracking
    EXPECT_GE(smallest_distance(colors), 20.0);
    colors.back() = page.at("faint");  // accepted changes of the dashboard
    EXPECT_GE(smallest_distance(colors), 20.0);
  }
}

TEST(PageTheme, TheLightPageHasTheLinesOfFigures) {
  const PageColors page = page_themes().front();
  for (std::size_t i = 0; i < theme::kEstimates.size(); ++i)
    EXPECT_TRUE(is_same(page.at("c" + std::to_string(i)), theme::kEstimates[i].color)) << i;
}

}  // namespace
}  // namespace stillpoint::report
