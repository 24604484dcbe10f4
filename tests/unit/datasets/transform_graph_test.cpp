// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/transform_graph.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/geometry/so3.h"

namespace stillpoint::datasets {
namespace {

const Pose kT_a_b{exp_so3({0.0, 0.0, 0.5}), {1.0, 0.0, 0.0}};
const Pose kT_c_b{exp_so3({0.2, 0.0, 0.0}), {0.0, 2.0, 0.0}};

TEST(FindTransform, TraversesLinksInBothDirections) {
  const std::vector<NamedTransform> links{{"a", "b", kT_a_b}, {"c", "b", kT_c_b}};
  const Pose expected = kT_a_b * kT_c_b.inverse();
  EXPECT_TRUE(find_transform(links, "a", "c")->matrix().isApprox(expected.matrix(), 1e-12));
  EXPECT_TRUE(find_transform(links, "c", "a")->matrix().isApprox(expected.inverse().matrix(), 1e-12));
  EXPECT_TRUE(find_transform(links, "a", "a")->matrix().isIdentity());
}

TEST(FindTransform, ReturnsNothingForUnconnectedFrames) {
  const std::vector<NamedTransform> links{{"a", "b", kT_a_b}, {"x", "y", kT_c_b}};
  EXPECT_FALSE(find_transform(links, "a", "y").has_value());
  EXPECT_FALSE(find_transform(links, "a", "unknown_frame").has_value());
}

}  // namespace
}  // namespace stillpoint::datasets
