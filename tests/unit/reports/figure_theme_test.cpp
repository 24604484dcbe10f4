// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "reports/drawing/chart.h"
#include "reports/drawing/theme.h"

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

/// Contrast to white as in WCAG 2.1.
double contrast_to_white(const Color& color) { return 1.05 / (luminance(color) + 0.05); }

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

TEST(FigureTheme, ColorsDifferFromPaper) {
  for (const theme::LineStyle& style : theme::kEstimates) EXPECT_GE(contrast_to_white(style.color), 3.0);
  EXPECT_GE(contrast_to_white(theme::kTruth.color), 12.0);
}

TEST(FigureTheme, ColorsDifferForEveryKindOfVision) {
  for (const Eigen::Matrix3d& model : vision_models()) {
    const auto seen = [&](const theme::LineStyle& style) {
      return cielab((model * linear_rgb(style.color)).cwiseMax(0.0).cwiseMin(1.0));
    };
    for (std::size_t i = 0; i < theme::kEstimates.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GE((seen(theme::kEstimates[i]) - seen(theme::kEstimates[j])).norm(), 30.0) << i << ' ' << j;
    }
  }
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

TEST(FigureTheme, LargeErrorsAreDarker) {
  for (int k = 0; k < 20; ++k)
    EXPECT_GE(luminance(error_color(k / 20.0, 1.0)), luminance(error_color((k + 1) / 20.0, 1.0)) - 1e-3) << k;
}

}  // namespace
}  // namespace stillpoint::report
