// SPDX-License-Identifier: BSD-3-Clause
// Invalid detections and detectors are rejected with one error line, or counted and tolerated.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/rejection.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/tiny_onnx.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStamp = "1700000000.05";  // of the first frame

/// The rendered sequence with recorded `detections`.
struct DetectionRun {
  explicit DetectionRun(const std::string& detections) {
    replace_file(sequence / "detections.txt", detections);
  }
  [[nodiscard]] ProgramResult run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"run", sequence.string(), "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  [[nodiscard]] nlohmann::json result() const {
    return nlohmann::json::parse(std::ifstream(out / "result.json"));
  }

  TemporaryFolder folder;
  fs::path sequence = copy_of_rendered_sequence(folder);
  fs::path out = folder.path() / "out";
};

TEST(BadDetections, UnsortedFileIsRejected) {
  const DetectionRun run(std::string(kStamp) + " person 0.9 1 1 9 9\n1700000000.01 person 0.9 1 1 9 9\n");
  expect_rejected(run.run(), run.out, {"detections.txt:2", "sort the file by time"});
}

TEST(BadDetections, InvertedBoxIsRejected) {
  const DetectionRun run(std::string(kStamp) + " person 0.9 9 1 1 9\n");
  expect_rejected(run.run(), run.out, {"detections.txt:1", "inverted"});
}

TEST(BadDetections, BoxesOutsideTheImageAreClippedOrRejectedAndCounted) {
  // The image is 320 x 240: the first box is partly outside, the second one completely.
  const DetectionRun run(std::string(kStamp) + " person 0.9 -50 -50 100 100\n" + kStamp +
                         " person 0.9 900 900 950 950\n");
  const ProgramResult result = run.run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(run.result()["detector"]["clipped"], 1);
  EXPECT_EQ(run.result()["detector"]["rejected"], 1);
}

TEST(BadDetections, UnknownClassesLabelNoFeatureAsDynamic) {
  const DetectionRun teapot(std::string(kStamp) + " teapot 0.9 0 0 320 240\n"),
      person(std::string(kStamp) + " person 0.9 0 0 320 240\n"), nothing(std::string(kStamp) + "\n");
  for (const DetectionRun* run : {&teapot, &person, &nothing}) ASSERT_EQ(run->run().exit_code, 0);
  EXPECT_EQ(teapot.result()["detector"]["boxes"], 1);
  EXPECT_EQ(teapot.result()["dynamic_features"], nothing.result()["dynamic_features"]);
  EXPECT_GT(person.result()["dynamic_features"], nothing.result()["dynamic_features"]);
}

TEST(BadDetector, MissingWeightsAreRejected) {
  const DetectionRun run("");
  expect_rejected(run.run({"--set", "detector.kind=network", "--set", "detector.weights=/no/such.weights",
                           "--set", "detector.names=" + run.folder.write("names", "person\n").string()}),
                  run.out, {"/no/such.weights", "detector.weights"});
}

TEST(BadDetector, NetworkWithAnotherOutputLayoutIsRejected) {
  const DetectionRun run("");
  // Six values per box are the YOLOv5 layout for one class; YOLOX with a 64 px input has 84 rows.
  const fs::path network =
      run.folder.write("net.onnx", constant_onnx({16, 24, 16, 16, 1.0F, 0.8F}, {1, 1, 6}, 64));
  expect_rejected(run.run({"--set", "detector.kind=network", "--set", "detector.layout=yolox", "--set",
                           "detector.input_px=64", "--set", "detector.weights=" + network.string(), "--set",
                           "detector.names=" + run.folder.write("names", "person\n").string()}),
                  run.out, {"net.onnx", "layout"});
}

}  // namespace
}  // namespace stillpoint
