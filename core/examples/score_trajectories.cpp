// SPDX-License-Identifier: BSD-3-Clause
/// Scores estimated trajectories (TUM text files) against a ground truth: ATE and RPE.
///   score_trajectories GROUND_TRUTH ESTIMATE...
/// The estimates must be of the same body frame as the ground truth.
#include <cstdio>
#include <exception>

#include "eval/io/trajectory_file.h"
#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"

namespace eval = stillpoint::eval;

namespace {

void print_scores(const stillpoint::Trajectory& truth, const char* file) {
  const stillpoint::Trajectory estimate = eval::read_tum(file).trajectory;
  std::printf("%s: %zu poses\n", file, estimate.poses.size());
  if (const auto ate = eval::ate(truth, estimate)) {
    std::printf("  ATE %.4f m RMSE, %.2f deg RMSE over %zu matched poses\n", ate->translation_m.rmse,
                ate->rotation_deg.rmse, ate->pairs);
  } else {
    std::printf("  ATE n/a: fewer than two poses match in time\n");
  }
  const eval::RpeOptions over_one_second{.delta = 1.0, .unit = eval::RpeUnit::kSeconds};
  if (const auto rpe = eval::rpe(truth, estimate, over_one_second)) {
    std::printf("  RPE %.4f m RMSE, %.2f deg RMSE over 1 s\n", rpe->translation_m.rmse,
                rpe->rotation_deg.rmse);
  } else {
    std::printf("  RPE n/a: no two poses are 1 s apart\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s GROUND_TRUTH ESTIMATE...\n", argv[0]);
    return 2;
  }
  try {
    const stillpoint::Trajectory truth = eval::read_tum(argv[1]).trajectory;
    for (int i = 2; i < argc; ++i) print_scores(truth, argv[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
