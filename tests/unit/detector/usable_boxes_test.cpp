// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/object_detector.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/expect_input_error.h"

namespace stillpoint {
namespace {

const cv::Size kImageSize(100, 80);

Detection detection(double x_min, double y_min, double x_max, double y_max) {
  return {.class_name = "person",
          .score = 1.0,
          .box = {.x_min = x_min, .y_min = y_min, .x_max = x_max, .y_max = y_max}};
}

TEST(UsableBoxes, KeepsBoxesInsideTheImage) {
  const auto [boxes, counters] = usable_boxes({detection(0, 0, 99, 79)}, kImageSize);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].box.x_max, 99.0);
  EXPECT_EQ(counters.boxes, 1);
  EXPECT_EQ(counters.clipped, 0);
  EXPECT_EQ(counters.rejected, 0);
}

TEST(UsableBoxes, ClipsAndCountsBoxesThatExceedTheImage) {
  const auto [boxes, counters] = usable_boxes({detection(-20, 10, 50, 500)}, kImageSize);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].box, (Box{.x_min = 0, .y_min = 10, .x_max = 50, .y_max = 79}));
  EXPECT_EQ(counters.clipped, 1);
}

TEST(UsableBoxes, RejectsAndCountsInvalidBoxes) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto [boxes, counters] = usable_boxes({detection(50, 10, 20, 40), detection(150, 10, 200, 40),
                                               detection(10, 10, 10, 40), detection(10, kNan, 20, 40)},
                                              kImageSize);
  EXPECT_TRUE(boxes.empty());
  EXPECT_EQ(counters.rejected, 4);
  EXPECT_EQ(counters.boxes, 0);
}

TEST(RequireIncreasing, RejectsSetsOutOfOrder) {
  const auto at = [](std::int64_t ns) { return DetectionSet{.t = Timestamp{ns}}; };
  EXPECT_NO_THROW(require_increasing(std::vector{at(1), at(2)}, "boxes"));
  expect_input_error(
      [&] {
        require_increasing(std::vector{at(2'000'000'000), at(1'000'000'000)}, "boxes");
      },
      {"boxes", "set 1 at 1.0", "sort"});
  expect_input_error([&] { require_increasing(std::vector{at(1), at(1)}, "boxes"); }, {"boxes"});
}

}  // namespace
}  // namespace stillpoint
