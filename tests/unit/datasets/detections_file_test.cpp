// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/detections_file.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

std::vector<DetectionSet> read(const std::string& text) {
  const TemporaryFolder folder;
  FaultLog strict;
  return read_detections(folder.write("detections.txt", text), strict);
}

void expect_rejected(const std::string& text, const std::vector<std::string>& parts) {
  expect_input_error([&] { static_cast<void>(read(text)); }, parts);
}

TEST(DetectionsFile, GroupsBoxesByTimestamp) {
  const auto sets = read(
      "# t class score box\n1.0 person 0.9 10 20 30 40\n1.0 traffic light 0.5 -5 0 7.5 700\n"
      "1.1 person 1 1 2 3 4\n");
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(sets[0].t, Timestamp{1'000'000'000});
  EXPECT_EQ(sets[0].state, DetectionState::kPresent);
  ASSERT_EQ(sets[0].detections.size(), 2U);
  EXPECT_EQ(sets[0].detections[0].class_name, "person");
  EXPECT_EQ(sets[0].detections[0].score, 0.9);
  EXPECT_EQ(sets[0].detections[0].box.y_max, 40.0);
  EXPECT_EQ(sets[0].detections[1].class_name, "traffic light");
  EXPECT_EQ(sets[0].detections[1].box.x_min, -5.0);
}

TEST(DetectionsFile, ARowWithOnlyATimestampIsAnEmptySet) {
  const auto sets = read("1.0\n1.1 person 0.5 1 2 3 4\n");
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(sets[0].state, DetectionState::kPresent);
  EXPECT_TRUE(sets[0].detections.empty());
}

TEST(DetectionsFile, RejectsInvalidBoxesAndScores) {
  expect_rejected("1 person 0.9 30 20 10 40\n", {"detections.txt:1", "inverted"});
  expect_rejected("1 person 0.9 10 20 30 20\n", {"detections.txt:1", "empty"});
  expect_rejected("1 person nan 10 20 30 40\n", {"detections.txt:1", "not finite"});
  expect_rejected("1 person 0.9 10 nan 30 40\n", {"detections.txt:1", "not finite"});
  expect_rejected("1 person 1.2 10 20 30 40\n", {"detections.txt:1", "outside [0, 1]"});
  expect_rejected("1 person 0.9 10 20 30\n", {"detections.txt:1", "expected"});
}

TEST(DetectionsFile, RejectsTimestampsOutOfOrder) {
  expect_rejected("2 person 0.9 1 2 3 4\n1 person 0.9 1 2 3 4\n",
                  {"detections.txt:2", "earlier than the previous row"});
}

TEST(DetectionsFile, RoundTripPreservesPresentSets) {
  const Detection person{.class_name = "person",
                         .score = 0.1234,
                         .box = {.x_min = -5.25, .y_min = 0.5, .x_max = 10, .y_max = 20}};
  Detection light = person;
  light.class_name = "traffic light";
  const Timestamp exact{1'700'000'000'000'000'001};
  const std::vector<DetectionSet> written = {
      {.t = exact, .state = DetectionState::kPresent, .detections = {person, light}},
      {.t = after(exact, 0.1), .state = DetectionState::kPresent, .detections = {}},
      {.t = after(exact, 0.2), .state = DetectionState::kNone, .detections = {}},
      {.t = after(exact, 0.3), .state = DetectionState::kLate, .detections = {person}}};
  const auto sets = read(detections_text(written));
  ASSERT_EQ(sets.size(), 2U);  // the last two are not kPresent
  EXPECT_EQ(sets[0].t, exact);
  ASSERT_EQ(sets[0].detections.size(), 2U);
  EXPECT_EQ(sets[0].detections[0].box, person.box);
  EXPECT_EQ(sets[0].detections[0].score, 0.1234);
  EXPECT_EQ(sets[0].detections[1].class_name, "traffic light");
  EXPECT_TRUE(sets[1].detections.empty());
}

}  // namespace
}  // namespace stillpoint::datasets
