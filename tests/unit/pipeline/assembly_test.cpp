// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/assembly.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/sliding_plane.h"

namespace stillpoint {
namespace {

OdometryConfig visual() {
  OdometryConfig config;
  config.imu.enabled = false;
  return config;
}

TEST(Assembly, DisablesTheDetectorIfTheMaskIsOff) {
  const SlidingPlane plane(1);
  OdometryConfig config = visual();
  config.dynamic.mask = DynamicMask::kOff;
  EXPECT_EQ(assemble(plane.input(), config).detector->description(), "none");
}

TEST(Assembly, ASimulatedDetectorRequiresTrueBoxes) {
  const SlidingPlane plane(1);
  OdometryConfig config = visual();
  config.detector.kind = DetectorKind::kSimulated;
  expect_input_error([&] { static_cast<void>(assemble(plane.input(), config)); },
                     {"detector.kind", "true boxes"});
}

TEST(Assembly, InertialOdometryRequiresAnImu) {
  const SlidingPlane plane(1);
  expect_input_error([&] { static_cast<void>(assemble(plane.input(), OdometryConfig{})); },
                     {"imu.enabled", "--variant vo"});
}

TEST(WindowRate, AdmitsEveryThirdFrameAt10Of30Hz) {
  WindowRate rate(10.0);
  int admitted = 0;
  for (int i = 0; i < 300; ++i) admitted += rate.admits(Timestamp{i * 33'333'333LL});
  EXPECT_EQ(admitted, 100);  // three intervals are 1 ns less than 0.1 s, within the tolerance
}

}  // namespace
}  // namespace stillpoint
