// SPDX-License-Identifier: BSD-3-Clause
// Real network on real data: Yolo-Fastest 1.1 on 40 images of two people in a living room.
#include <gtest/gtest.h>

#include <fstream>

#include "core/detector/network_detector.h"
#include "datasets/open_sequence.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace stillpoint {
namespace {

constexpr const char* kPeople = "two_people_d435";
constexpr const char* kKitchen = "kitchen_rgbd";
constexpr const char* kDetectors = "detectors";

/// Yolo-Fastest trained on COCO, with the settings of its authors.
DetectorConfig yolo_fastest(const std::filesystem::path& folder) {
  DetectorConfig config;
  config.kind = DetectorKind::kNetwork;
  config.cfg = (folder / "yolo-fastest-1.1_coco__yolo-fastest-1.1.cfg").string();
  config.weights = (folder / "yolo-fastest-1.1_coco__yolo-fastest-1.1.weights").string();
  config.names = (folder / "yolo-fastest-1.1_coco__coco.names").string();
  return config;
}

const std::vector<std::string> kPerson = {"person"};

int people_in(const DetectionSet& set) {
  return static_cast<int>(std::count_if(set.detections.begin(), set.detections.end(),
                                        [](const Detection& found) { return found.class_name == "person"; }));
}

TEST(YoloFastest, DetectsBothPeople) {
  const auto sequence = find_test_data(kPeople);
  const auto detectors = find_test_data(kDetectors);
  if (!sequence || !detectors) GTEST_SKIP() << missing_test_data(sequence ? kDetectors : kPeople);
  const auto stream = datasets::open_sequence(*sequence);
  NetworkDetector detector(yolo_fastest(*detectors), kPerson);
  int frames_with_two = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    if (people_in(detector.detect(stream->load_frame(i))) == 2) ++frames_with_two;
  }
  RecordProperty("frames_with_two", frames_with_two);
  EXPECT_GE(frames_with_two, 38);
  EXPECT_EQ(detector.counters().processed, 40);
}

TEST(YoloFastest, DetectsNoPeopleInAnEmptyKitchen) {
  const auto sequence = find_test_data(kKitchen);
  const auto detectors = find_test_data(kDetectors);
  if (!sequence || !detectors) GTEST_SKIP() << missing_test_data(sequence ? kDetectors : kKitchen);
  const auto stream = datasets::open_sequence(*sequence);
  NetworkDetector detector(yolo_fastest(*detectors), kPerson);
  for (std::size_t i = 0; i < 400; i += 20) {
    EXPECT_EQ(people_in(detector.detect(stream->load_frame(i))), 0) << "frame " << i;
  }
}

TEST(YoloFastest, RejectsATruncatedWeightsFile) {
  const auto detectors = find_test_data(kDetectors);
  if (!detectors) GTEST_SKIP() << missing_test_data(kDetectors);
  DetectorConfig config = yolo_fastest(*detectors);
  std::ifstream whole(config.weights, std::ios::binary);
  const std::string content((std::istreambuf_iterator<char>(whole)), {});
  const TemporaryFolder folder;
  config.weights = folder.write("short.weights", content.substr(0, content.size() - 8)).string();
  expect_input_error([&] { NetworkDetector(config, kPerson); }, {"short.weights", "truncated"});
}

}  // namespace
}  // namespace stillpoint
