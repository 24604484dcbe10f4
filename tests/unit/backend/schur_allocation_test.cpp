// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bench/profile/meters/allocation_counter.h"
#include "core/backend/health/tracking_monitor.h"
#include "core/backend/solvers/schur_solver.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

TEST(SchurSolver, ASecondSolveDoesNotAllocate) {
  SimulatedWindowOptions options{.frames = 14, .points = 80};
  options.config.solver = WindowSolverKind::kSchur;
  const Window start = simulated_window(options);
  SchurSolver solver;
  Window first = start;
  Window second = start;
  const std::size_t before = bench::allocation_count();
  ASSERT_TRUE(solver.solve(first, options.config, kSimulatedFocal_px).usable);
  const std::size_t between = bench::allocation_count();
  ASSERT_TRUE(solver.solve(second, options.config, kSimulatedFocal_px).usable);
  EXPECT_EQ(bench::allocation_count(), between);
  ASSERT_TRUE(solver.covariance(first, options.config, kSimulatedFocal_px, true));
  const std::size_t after_first = bench::allocation_count();
  ASSERT_TRUE(solver.covariance(second, options.config, kSimulatedFocal_px, true));
  EXPECT_EQ(bench::allocation_count(), after_first);
  EXPECT_GT(between, before);  // the counter works
}

TEST(TrustedMap, AnUpdateAfterAClearDoesNotAllocate) {
  const Window window = simulated_window({.frames = 14, .points = 80});
  TrustedMap map;
  map.update(window, Matrix6::Zero());
  map.clear();
  EXPECT_TRUE(map.empty());
  const std::size_t before = bench::allocation_count();
  map.update(window, Matrix6::Zero());
  EXPECT_EQ(bench::allocation_count(), before);
  EXPECT_FALSE(map.empty());
}

}  // namespace
}  // namespace stillpoint
