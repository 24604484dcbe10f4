// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/box_association.h"

#include <gtest/gtest.h>

#include "core/types/box_geometry.h"

namespace stillpoint {
namespace {

using Joined = std::vector<std::optional<std::size_t>>;

constexpr double kMinIou = 0.3;

Joined associate(std::span<const ExpectedBox> objects, std::span<const Detection> detections,
                 double min_iou) {
  return BoxAssociation().associate(objects, detections, min_iou);
}

/// A square of 100 px from (x, y), in the reach of 20 px around it.
ExpectedBox expected(double x, double y, const std::string& name = "person") {
  const Box box{.x_min = x, .y_min = y, .x_max = x + 100, .y_max = y + 100};
  return {.class_name = name, .predicted = box, .reach = grown(box, 20.0)};
}

Detection found(double x, double y, const std::string& name = "person") {
  return {.class_name = name, .score = 1.0, .box = expected(x, y).predicted};
}

TEST(Overlap, IsIntersectionOverUnion) {
  // 50 x 100 common, 2 * 100 * 100 - 5000 covered.
  EXPECT_DOUBLE_EQ(overlap(expected(0, 0).predicted, expected(50, 0).predicted), 5000.0 / 15000.0);
  EXPECT_EQ(overlap(expected(0, 0).predicted, expected(100, 0).predicted), 0.0);
}

TEST(BoxAssociation, LargestOverlapComesFirst) {
  // Overlaps with the only object: shifts of 40 px and 10 px; only the nearer one is the object.
  EXPECT_EQ(associate(std::vector{expected(0, 0)}, std::vector{found(40, 0), found(10, 0)}, kMinIou),
            (Joined{std::nullopt, 0}));
}

TEST(BoxAssociation, IsOneToOne) {
  const std::vector objects = {expected(0, 0), expected(30, 0)};
  EXPECT_EQ(associate(objects, std::vector{found(5, 0), found(28, 0)}, kMinIou), (Joined{0, 1}));
  EXPECT_EQ(associate(objects, std::vector{found(28, 0), found(5, 0)}, kMinIou), (Joined{1, 0}));
}

TEST(BoxAssociation, OtherClassesAreOtherObjects) {
  EXPECT_EQ(associate(std::vector{expected(0, 0, "dog")}, std::vector{found(0, 0, "person")}, kMinIou),
            (Joined{std::nullopt}));
}

TEST(BoxAssociation, FallsBackToACentreInReach) {
  // Shift of (60, 0): IoU 40 / 160 = 0.25 < 0.3, but the centre (110, 50) lies in the reach up to x = 120.
  EXPECT_EQ(associate(std::vector{expected(0, 0)}, std::vector{found(60, 0)}, kMinIou), (Joined{0}));
  EXPECT_EQ(associate(std::vector{expected(0, 0)}, std::vector{found(71, 0)}, kMinIou),
            (Joined{std::nullopt}));  // centre at 121
}

TEST(BoxAssociation, OverlapGoesBeforeCentre) {
  // The first detection has its centre in reach and is nearer to nobody; the second overlaps and wins.
  EXPECT_EQ(associate(std::vector{expected(0, 0)}, std::vector{found(60, 0), found(45, 0)}, kMinIou),
            (Joined{std::nullopt, 0}));
}

TEST(BoxAssociation, OfEqualsTheEarlierComesFirst) {
  const std::vector twins = {expected(0, 0), expected(0, 0)};
  EXPECT_EQ(associate(twins, std::vector{found(0, 0), found(0, 0)}, kMinIou), (Joined{0, 1}));
}

TEST(BoxAssociation, NothingKnownJoinsNothing) {
  EXPECT_EQ(associate({}, std::vector{found(0, 0)}, kMinIou), (Joined{std::nullopt}));
  EXPECT_EQ(associate(std::vector{expected(0, 0)}, {}, kMinIou), Joined{});
}

}  // namespace
}  // namespace stillpoint
