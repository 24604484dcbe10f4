// SPDX-License-Identifier: BSD-3-Clause
#include "eval/protocols/protocol_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "eval/protocols/protocol.h"
#include "tests/support/expect_input_error.h"

namespace stillpoint::eval {
namespace {

TEST(ParsePublished, TakesTheLastDigitAsRounded) {
  EXPECT_DOUBLE_EQ(parse_published("0.0150").value, 0.015);
  EXPECT_DOUBLE_EQ(parse_published("0.0150").half_digit, 5e-5);
  EXPECT_DOUBLE_EQ(parse_published("3").half_digit, 0.5);
  EXPECT_DOUBLE_EQ(parse_published("1.5e-2").half_digit, 5e-4);
  for (const char* text : {"", "-1", "0", "1,5", "0x1", "nan", "1.5 m", "inf"})
    expect_input_error([&] { static_cast<void>(parse_published(text)); }, {"positive decimal number"});
}

/// A curved path of 3 s at 20 Hz, and an estimate that is rotated, 3 % too small and noisy.
struct TwoTrajectories {
  Trajectory gt;
  Trajectory est;

  TwoTrajectories() {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.2, 0.3, 1.0).normalized()));
    for (int i = 0; i < 60; ++i) {
      const double s = 0.05 * i;
      const Eigen::Vector3d p(std::cos(s), std::sin(0.7 * s), 0.3 * std::sin(1.3 * s));
      const Eigen::Quaterniond q(Eigen::AngleAxisd(0.5 * s, Eigen::Vector3d::UnitZ()));
      const Eigen::Vector3d noise(0.01 * std::sin(9.0 * s), 0.02 * std::cos(5.0 * s),
                                  0.01 * std::sin(7.0 * s));
      const Timestamp t{std::int64_t{50'000'000} * i};
      gt.poses.push_back({t, {q, p}});
      est.poses.push_back({t, {turn * q, turn * (0.97 * p + noise)}});
    }
  }
};

std::string published(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5f", value);
  return text;
}

/// Whether a definition is among those that agree with the number as printed.
bool is_found(const TwoTrajectories& both, double value, const std::string& protocol,
              const std::string& options, const std::string& metric = "ATE rmse m") {
  const std::vector<DefinedNumber> found =
      search_protocols(both.gt, both.est, parse_published(published(value)));
  return std::ranges::any_of(found, [&](const DefinedNumber& defined) {
    return defined.agrees && defined.protocol == protocol && defined.options == options &&
           defined.metric == metric;
  });
}

TEST(SearchProtocols, FindsTheAlignmentOfANumber) {
  const TwoTrajectories both;
  const ProtocolOptions sim3{.alignment = Alignment::kSim3};
  const double value = evaluate("compat:tum", {both.gt, both.est, sim3}).ate_m->rmse;
  EXPECT_TRUE(is_found(both, value, "compat:tum", "--align sim3"));
  EXPECT_FALSE(is_found(both, value, "compat:tum", ""));
}

TEST(SearchProtocols, FindsTheIntervalAndTheStatisticOfANumber) {
  const TwoTrajectories both;
  const ProtocolOptions frames{.rpe_delta = 10.0, .rpe_unit = RpeUnit::kFrames};
  EXPECT_TRUE(is_found(both, evaluate("compat:evo", {both.gt, both.est, frames}).rpe_m->mean, "compat:evo",
                       "--rpe-delta 10 --rpe-unit f", "RPE over 10 f, mean m"));
}

TEST(SearchProtocols, ListsTheNearestWithoutAgreement) {
  const TwoTrajectories both;
  const std::vector<DefinedNumber> found = search_protocols(both.gt, both.est, parse_published("123.4567"));
  ASSERT_GT(found.size(), 50u);
  EXPECT_TRUE(std::ranges::none_of(found, &DefinedNumber::agrees));
  EXPECT_LE(std::abs(found[0].value - 123.4567), std::abs(found[1].value - 123.4567));
}

}  // namespace
}  // namespace stillpoint::eval
