// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"

#include <gtest/gtest.h>

#include "core/types/detection.h"

namespace stillpoint {
namespace {

using Assignment = std::vector<std::optional<std::size_t>>;

constexpr double kMinIou = 0.3;

Assignment associate(std::span<const PredictedBox> objects, std::span<const Detection> detections,
                     double min_iou) {
  return BoxAssociation().associate(objects, detections, min_iou);
}

/// A box of 100 x 100 px with upper left corner (x, y), and a gate of 20 px around it.
PredictedBox predicted_at(double x, double y, const std::string& name = "person") {
  const Box box{.x_min = x, .y_min = y, .x_max = x + 100, .y_max = y + 100};
  return {.class_name = name, .box = box, .gate = expanded(box, 20.0)};
}

Detection detected_at(double x, double y, const std::string& name = "person") {
  return {.class_name = name, .score = 1.0, .box = predicted_at(x, y).box};
}

TEST(Overlap, IsIntersectionOverUnion) {
  // Intersection 50 x 100, union 2 * 100 * 100 - 5000.
  EXPECT_DOUBLE_EQ(intersection_over_union(predicted_at(0, 0).box, predicted_at(50, 0).box),
                   5000.0 / 15000.0);
  EXPECT_EQ(intersection_over_union(predicted_at(0, 0).box, predicted_at(100, 0).box), 0.0);
}

TEST(BoxAssociation, AssignsTheLargestOverlapFirst) {
  // Two detections of the only object, shifted by 40 px and 10 px; the nearer one is assigned.
  EXPECT_EQ(associate(std::vector{predicted_at(0, 0)}, std::vector{detected_at(40, 0), detected_at(10, 0)},
                      kMinIou),
            (Assignment{std::nullopt, 0}));
}

TEST(BoxAssociation, IsOneToOne) {
  const std::vector objects = {predicted_at(0, 0), predicted_at(30, 0)};
  EXPECT_EQ(associate(objects, std::vector{detected_at(5, 0), detected_at(28, 0)}, kMinIou),
            (Assignment{0, 1}));
  EXPECT_EQ(associate(objects, std::vector{detected_at(28, 0), detected_at(5, 0)}, kMinIou),
            (Assignment{1, 0}));
}

TEST(BoxAssociation, DoesNotAssignAcrossClasses) {
  EXPECT_EQ(
      associate(std::vector{predicted_at(0, 0, "dog")}, std::vector{detected_at(0, 0, "person")}, kMinIou),
      (Assignment{std::nullopt}));
}

TEST(BoxAssociation, FallsBackToACenterInsideTheGate) {
  // Shift of (60, 0): IoU 40 / 160 = 0.25 < 0.3, but the center (110, 50) is inside the gate, which ends at x
  // = 120.
  EXPECT_EQ(associate(std::vector{predicted_at(0, 0)}, std::vector{detected_at(60, 0)}, kMinIou),
            (Assignment{0}));
  EXPECT_EQ(associate(std::vector{predicted_at(0, 0)}, std::vector{detected_at(71, 0)}, kMinIou),
            (Assignment{std::nullopt}));  // center at 121
}

TEST(BoxAssociation, PrefersOverlapOverCenterDistance) {
  // The first detection only has its center inside the gate; the second overlaps enough and is assigned.
  EXPECT_EQ(associate(std::vector{predicted_at(0, 0)}, std::vector{detected_at(60, 0), detected_at(45, 0)},
                      kMinIou),
            (Assignment{std::nullopt, 0}));
}

TEST(BoxAssociation, ResolvesTiesByIndex) {
  const std::vector twins = {predicted_at(0, 0), predicted_at(0, 0)};
  EXPECT_EQ(associate(twins, std::vector{detected_at(0, 0), detected_at(0, 0)}, kMinIou), (Assignment{0, 1}));
}

TEST(BoxAssociation, AssignsNothingWithoutObjectsOrDetections) {
  EXPECT_EQ(associate({}, std::vector{detected_at(0, 0)}, kMinIou), (Assignment{std::nullopt}));
  EXPECT_EQ(associate(std::vector{predicted_at(0, 0)}, {}, kMinIou), Assignment{});
}

}  // namespace
}  // namespace stillpoint
