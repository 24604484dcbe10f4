// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run` with inertial samples whose time stamps are wrong from the start, while the camera turns
// fast.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// With samples 40 ms late, inertial data seems to have wrong biases until the offset is known; the check of
/// the biases must not withdraw the data that shows it.
TEST(TimeOffsetCommand, IsFoundByTheDefault) {
  const TemporaryFolder folder;
  const std::string sequence = (folder.path() / "sequence").string(), out = (folder.path() / "out").string();
  const ProgramResult rendered = run_program({"data", "synth", "walking_rpy_empty", "--width", "320",
                                              "--height", "240", "--seconds", "5", "--out", sequence});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  const ProgramResult run = run_program({"run", sequence, "--set", "detector.kind=none", "--out", out,
                                         "--fault", "time_offset:start=0,duration=100,amount=0.04"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  const nlohmann::json& calibration = result.at("calibration");
  const double error_s = std::abs(calibration.at("time_offset_s").get<double>() - 0.04);
  EXPECT_LT(error_s, 0.001);
  EXPECT_LT(error_s, 3.0 * calibration.at("time_offset_sigma_s").get<double>());
}

}  // namespace
}  // namespace stillpoint
