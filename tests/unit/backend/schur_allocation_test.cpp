// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "bench/profile/allocation_counter.h"
#include "core/backend/schur/schur_solver.h"
#include "tests/support/flown_window.h"

namespace stillpoint {
namespace {

TEST(SchurSolver, ASecondSolveAllocatesNothing) {
  FlownOptions options{.pictures = 14, .points = 80};
  options.config.solver = WindowSolverKind::kSchur;
  const Window start = flown_window(options);
  SchurSolver solver;
  Window first = start;
  Window second = start;
  const std::size_t before = allocation_count();
  ASSERT_TRUE(solver.solve(first, options.config, kFlownFocal_px).usable);
  const std::size_t between = allocation_count();
  ASSERT_TRUE(solver.solve(second, options.config, kFlownFocal_px).usable);
  EXPECT_EQ(allocation_count(), between);
  EXPECT_GT(between, before);  // the counter counts
}

}  // namespace
}  // namespace stillpoint
