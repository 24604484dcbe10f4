// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run` with a stated lens that is wrong, while the camera turns.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// A prior that is linearized with the stated lens claimed rotations with a NEES / 3 of 25 after the lens was
/// found, and positions with one of 5.7.
TEST(WrongLens, TheClaimsHoldOnceItIsFound) {
  const TemporaryFolder folder;
  const std::string sequence = (folder.path() / "sequence").string(), out = (folder.path() / "out").string();
  const ProgramResult rendered =
      run_program({"data", "synth", "walking_rpy", "--seconds", "10", "--out", sequence});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  const ProgramResult run =
      run_program({"run", sequence, "--fault", "distortion_error:amount=0.05", "--out", out});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_LT(result.at("nees_rotation").get<double>(), 4.0);
  EXPECT_LT(result.at("nees_position").get<double>(), 4.0);
  EXPECT_LT(result.at("ate_rmse_m").get<double>(), 0.005);
}

}  // namespace
}  // namespace stillpoint
