// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/network_detector.h"

#include <opencv2/core/utility.hpp>

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_onnx.h"
#include "tests/unit/detector/blank_frame.h"

namespace stillpoint {
namespace {

constexpr int kInput = 64;

/// One box (x, y, w, h), objectness and two scores, in the layout of YOLOv5.
std::string one_person_onnx() { return constant_onnx({16, 24, 16, 16, 1.0F, 0.1F, 0.8F}, {1, 1, 7}, kInput); }

/// A network in a temporary folder.
struct NetworkFiles {
  TemporaryFolder folder;
  DetectorConfig config;

  explicit NetworkFiles(const std::string& onnx = one_person_onnx(),
                        const std::string& names = "cat\nperson\n") {
    config.kind = DetectorKind::kNetwork;
    config.layout = NetworkLayout::kYolov5;
    config.input_px = kInput;
    config.weights = folder.write("net.onnx", onnx).string();
    config.names = folder.write("net.names", names).string();
  }
};

const std::vector<std::string> kPerson = {"person"};

void expect_rejected(const DetectorConfig& config, const std::vector<std::string>& parts,
                     std::span<const std::string> dynamic_classes = kPerson) {
  expect_input_error([&] { NetworkDetector(config, dynamic_classes); }, parts);
}

TEST(NetworkDetector, RunsAnOnnxNetworkAndKeepsTheAspectRatio) {
  const NetworkFiles files;
  NetworkDetector detector(files.config, kPerson);
  // 640 px are scaled to 64: boxes times 10. Center (160, 240), size (160, 160).
  const DetectionSet found = detector.detect(blank_frame(3));
  EXPECT_EQ(found.t, blank_frame(3).t);
  EXPECT_EQ(found.state, DetectionState::kPresent);
  ASSERT_EQ(found.detections.size(), 1U);
  EXPECT_EQ(found.detections[0].class_name, "person");
  EXPECT_NEAR(found.detections[0].score, 0.8, 1e-5);
  EXPECT_NEAR(found.detections[0].box.x_min, 80.0, 1e-3);
  EXPECT_NEAR(found.detections[0].box.y_min, 160.0, 1e-3);
  EXPECT_NEAR(found.detections[0].box.x_max, 240.0, 1e-3);
  EXPECT_NEAR(found.detections[0].box.y_max, 320.0, 1e-3);
}

TEST(NetworkDetector, LeavesTheNumberOfOpencvThreadsOfOtherModulesUnchanged) {
  NetworkFiles files;
  const int before = cv::getNumThreads();
  files.config.threads = before + 1;
  NetworkDetector detector(files.config, kPerson);
  EXPECT_EQ(cv::getNumThreads(), before);
  static_cast<void>(detector.detect(blank_frame(3)));
  EXPECT_EQ(cv::getNumThreads(), before);
}

TEST(NetworkDetector, DescribesTheActualImplementation) {
  const NetworkFiles files;
  const NetworkDetector detector(files.config, kPerson);
  const std::string text = detector.description();
  for (const char* const part : {"net.onnx", "opencv", "cpu", "1 thread"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " / " << text;
}

TEST(NetworkDetector, RejectsMissingFiles) {
  NetworkFiles files;
  files.config.weights = "";
  expect_rejected(files.config, {"detector.weights", "not set"});
  files.config.weights = "/nowhere/net.onnx";
  expect_rejected(files.config, {"/nowhere/net.onnx", "is not a file"});
  NetworkFiles darknet;
  darknet.config.layout = NetworkLayout::kDarknet;
  expect_rejected(darknet.config, {"detector.cfg", "not set"});
  NetworkFiles nameless;
  nameless.config.names = "/nowhere/net.names";
  expect_rejected(nameless.config, {"/nowhere/net.names", "detector.names"});
}

TEST(NetworkDetector, RejectsFilesThatAreNotANetwork) {
  const NetworkFiles garbage("this is not a network file");
  expect_rejected(garbage.config, {"net.onnx", "not a network"});
  const NetworkFiles truncated(one_person_onnx().substr(0, 120));
  expect_rejected(truncated.config, {"net.onnx"});
  NetworkFiles darknet;
  darknet.config.layout = NetworkLayout::kDarknet;
  darknet.config.cfg = darknet.folder.write("net.cfg", "[net]\nwidth=oops\n[nonsense]\n").string();
  expect_rejected(darknet.config, {"net.onnx", "not a network"});
}

TEST(NetworkDetector, RejectsAWrongNumberOfClasses) {
  const NetworkFiles files(one_person_onnx(), "cat\nperson\ndog\n");
  expect_rejected(files.config, {"net.onnx", "1 x 1 x 7", "3 classes"});
}

TEST(NetworkDetector, RejectsAWrongLayout) {
  NetworkFiles files;
  files.config.layout = NetworkLayout::kYolov8;
  expect_rejected(files.config, {"net.onnx", "detector.layout"});
}

TEST(NetworkDetector, RejectsEmptyNames) {
  const NetworkFiles files(one_person_onnx(), "\n\n");
  expect_rejected(files.config, {"net.names", "no class names"});
}

TEST(NetworkDetector, ReadsNamesBehindAByteOrderMark) {
  const NetworkFiles files(one_person_onnx(), "\xEF\xBB\xBFperson\r\ncat\r\n");
  EXPECT_NO_THROW(NetworkDetector(files.config, kPerson));
}

TEST(NetworkDetector, RejectsNetworksWithoutAnyDynamicClass) {
  const NetworkFiles files;
  expect_rejected(files.config, {"net.names", "dynamic.classes", "\"cat\""},
                  std::vector<std::string>{"body"});
  EXPECT_NO_THROW(NetworkDetector(files.config, {}));
}

TEST(NetworkDetector, RejectsAnUnavailableBackendInsteadOfFallingBack) {
  NetworkFiles files;
  files.config.backend = NetworkBackend::kCuda;
  if (!cv::dnn::getAvailableTargets(cv::dnn::DNN_BACKEND_CUDA).empty()) GTEST_SKIP() << "CUDA is available";
  expect_rejected(files.config, {"detector.backend", "opencv"});
}

}  // namespace
}  // namespace stillpoint
