// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint detect`: from a network and a sequence to a file of boxes.
#include <filesystem>

#include <gtest/gtest.h>

#include "datasets/detections_file.h"
#include "tests/support/program.h"
#include "tests/support/rendered_sequence.h"
#include "tests/support/tiny_onnx.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Arguments of a detection in the rendered sequence by a network that always sees one person.
std::vector<std::string> detection(const TemporaryFolder& folder, const std::string& names = "person\n") {
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

TEST(DetectCommand, RecordsTheBoxesOfEachPicture) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(detection(folder));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("5 boxes in 5 pictures"), std::string::npos) << result.out;
  FaultLog strict;
  const auto sets = read_detections(folder.path() / "detections.txt", strict);
  ASSERT_EQ(sets.size(), 5U);
  ASSERT_EQ(sets[4].detections.size(), 1U);
  // 320 px become 64: times 5.
  EXPECT_EQ(sets[4].detections[0].box, (Box{.x_min = 40, .y_min = 80, .x_max = 120, .y_max = 160}));
}

TEST(DetectCommand, RefusesNetworksThatKnowNobodyWhoMoves) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(detection(folder, "teapot\n"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("dynamic.classes"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "detections.txt"));
}

TEST(DetectCommand, AsksForANetwork) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(
      {"detect", rendered_sequence().string(), "--out", (folder.path() / "detections.txt").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("detector.names"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
