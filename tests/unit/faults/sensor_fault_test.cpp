// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/sensor_fault.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

TEST(SensorFault, ListsEveryKindOnceAndInOrder) {
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    EXPECT_EQ(&descriptor_of(descriptor.kind), &descriptor) << descriptor.name;
    EXPECT_GE(descriptor.typical, descriptor.min) << descriptor.name;
    EXPECT_LE(descriptor.typical, descriptor.max) << descriptor.name;
  }
  EXPECT_EQ(fault_descriptors().back().kind, FaultKind::kFrameDuplicated);
}

TEST(SensorFault, ParsesItsOwnText) {
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    const SensorFault typical = parse_fault(descriptor.name);
    EXPECT_EQ(typical.amount, descriptor.typical);
    EXPECT_EQ(parse_fault(fault_text(typical)), typical) << fault_text(typical);
  }
  const SensorFault fault = parse_fault("shock:start=1.5,duration=0.25,every=3,amount=4,seed=7");
  EXPECT_EQ(fault, (SensorFault{.kind = FaultKind::kShock,
                                .start_s = 1.5,
                                .duration_s = 0.25,
                                .every_s = 3.0,
                                .amount = 4.0,
                                .seed = 7}));
  EXPECT_EQ(parse_fault(fault_text(fault)), fault);
}

TEST(SensorFault, RejectsWhatItDoesNotKnow) {
  for (const char* text :
       {"", "blnk", "blank:start", "blank:begin=1", "blank:start=x", "blank:start=nan", "blank:start=-1",
        "blank:start=inf", "blank:amount=256", "imu_gap:amount=1", "blank:duration=2,every=2",
        "occluder:amount=1.1", "focal_error:start=1", "rig:duration=2", "rig:amount=11", "jpeg:amount=0"}) {
    EXPECT_THROW(static_cast<void>(parse_fault(text)), InputError) << text;
  }
}

TEST(SensorFault, IsActiveWithinItsIntervals) {
  const SensorFault once = parse_fault("blank:start=2,duration=1");
  EXPECT_FALSE(once.is_active(1.99));
  EXPECT_TRUE(once.is_active(2.0));
  EXPECT_TRUE(once.is_active(2.99));
  EXPECT_FALSE(once.is_active(3.0));
  const SensorFault periodic = parse_fault("blank:start=2,duration=1,every=4");
  EXPECT_FALSE(periodic.is_active(0.5));
  EXPECT_TRUE(periodic.is_active(6.5));
  EXPECT_FALSE(periodic.is_active(7.5));
  EXPECT_EQ(periodic.onset_s(6.5), 6.0);
}

TEST(SensorFault, ImperfectionsLastForTheWholeSequence) {
  for (const FaultDescriptor& descriptor : fault_descriptors()) {
    const SensorFault fault = parse_fault(descriptor.name);
    EXPECT_EQ(fault.is_permanent(), descriptor.imperfection) << descriptor.name;
    EXPECT_EQ(fault.is_active(-0.1), descriptor.imperfection) << descriptor.name;
  }
  EXPECT_FALSE(parse_fault("imu_noise:start=2,duration=1").is_permanent());
}

}  // namespace
}  // namespace stillpoint::datasets
