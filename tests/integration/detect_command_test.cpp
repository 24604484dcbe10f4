// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint detect`: records the boxes of a network on a sequence.
#include <filesystem>

#include <gtest/gtest.h>

#include "datasets/io/detections_file.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/tiny_onnx.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Arguments of `detect` for the rendered sequence and a network that always reports one person.
std::vector<std::string> detect_arguments(const TemporaryFolder& folder,
                                          const std::string& names = "person\n") {
  const fs::path network =
      folder.write("net.onnx", constant_onnx({16, 24, 16, 16, 1.0F, 0.8F}, {1, 1, 6}, 64));
  return {"detect",       rendered_sequence().string(),
          "--out",        (folder.path() / "detections.txt").string(),
          "--set",        "detector.layout=yolov5",
          "--set",        "detector.input_px=64",
          "--names",      folder.write("names", names).string(),
          "--weights",    network.string(),
          "--max-frames", "5"};
}

TEST(DetectCommand, RecordsTheBoxesOfEachFrame) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(detect_arguments(folder));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("5 boxes in 5 frames"), std::string::npos) << result.out;
  FaultLog strict;
  const auto sets = datasets::read_detections(folder.path() / "detections.txt", strict);
  ASSERT_EQ(sets.size(), 5U);
  ASSERT_EQ(sets[4].detections.size(), 1U);
  // Network input is 64 px for 320 px: scale factor 5.
  EXPECT_EQ(sets[4].detections[0].box, (Box{.x_min = 40, .y_min = 80, .x_max = 120, .y_max = 160}));
}

TEST(DetectCommand, RejectsNetworksWithoutDynamicClasses) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(detect_arguments(folder, "teapot\n"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("dynamic.classes"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "detections.txt"));
}

TEST(DetectCommand, RequiresANetwork) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(
      {"detect", rendered_sequence().string(), "--out", (folder.path() / "detections.txt").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("detector.names"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("data get yolo_fastest/coco"), std::string::npos) << result.err;
}

TEST(DetectCommand, UsesTheDownloadedNetworkWithoutOptions) {
  const TemporaryFolder folder;
  for (const std::string name : {"yolo-fastest-1.1.weights", "yolo-fastest-1.1.cfg", "coco.names"})
    folder.write("yolo_fastest/downloads/" + name, "person\n");  // not a network: the error names the file
  const ProgramResult result = run_program(
      {"detect", rendered_sequence().string(), "--out", (folder.path() / "detections.txt").string()},
      {.environment = {"STILLPOINT_DATA=" + folder.path().string()}});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("yolo_fastest/downloads/yolo-fastest-1.1"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
