// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/run_notes.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

StoredRun run_without(double frames_without_boxes) {
  return {.metrics = {{.name = "frames", .value = 90.0},
                      {.name = "frames_without_boxes", .value = frames_without_boxes}}};
}

TEST(MissingBoxesNote, IsOfTheRunThatLacksMost) {
  const StoredRun none = run_without(0.0);
  const StoredRun few = run_without(3.0);
  const StoredRun many = run_without(60.0);
  EXPECT_EQ(missing_boxes_note({&few, &many, &none}), "no recorded boxes in up to 60 of 90 frames");
}

TEST(MissingBoxesNote, IsEmptyWithoutMissingBoxes) {
  const StoredRun none = run_without(0.0);
  const StoredRun without_detector = {.metrics = {{.name = "frames", .value = 90.0}}};
  EXPECT_EQ(missing_boxes_note({&none, &without_detector}), "");
}

}  // namespace
}  // namespace stillpoint::bench
