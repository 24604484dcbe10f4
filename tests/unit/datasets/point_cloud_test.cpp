// SPDX-License-Identifier: BSD-3-Clause
// Point clouds: their fusion from depth images, their files, and their comparison.
#include <fstream>

#include <gtest/gtest.h>

#include "datasets/mapping/voxel_map.h"
#include "eval/io/ply_file.h"
#include "eval/metrics/cloud_distance.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

using datasets::VoxelMap;
using datasets::VoxelMapOptions;
using eval::CloudPoint;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
const Camera kCamera{.width = kWidth, .height = kHeight, .fx = 50.0, .fy = 50.0, .cx = 31.5, .cy = 23.5};

/// A wall at 2 m, with a person of 1 m distance in the columns [first, last).
Frame frame_with_person(int first, int last) {
  Frame frame{.gray = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(90)),
              .color = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(10, 20, 30)),
              .depth = cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(2000))};
  if (last > first) frame.depth.colRange(first, last).setTo(cv::Scalar(1000));
  return frame;
}

std::size_t nearer_than(const std::vector<CloudPoint>& cloud, float z) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud, [z](const CloudPoint& point) { return point.p.z() < z; }));
}

TEST(VoxelMap, AWallIsFusedToItsPlaneAndColor) {
  VoxelMap map(kCamera, {.voxel_m = 0.05});
  // The wall is at z = 2 in the world: the camera moves along z, and its depth changes with it.
  for (int i = 0; i < 5; ++i) {
    Frame frame = frame_with_person(0, 0);
    frame.depth.setTo(cv::Scalar(2000 - 100 * i));
    map.add(frame, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1 * i}}, {});
  }
  const std::vector<CloudPoint> cloud = map.cloud();
  ASSERT_GT(cloud.size(), 500U);
  for (const CloudPoint& point : cloud) {
    EXPECT_NEAR(point.p.z(), 2.0F, 1e-5F);
    EXPECT_EQ(point.rgb, (std::array<std::uint8_t, 3>{10, 20, 30}));
  }
}

TEST(VoxelMap, APersonWhoLeavesIsRemovedOnceTheWallBehindIsSeen) {
  VoxelMap map(kCamera, {.voxel_m = 0.05});
  for (int i = 0; i < 4; ++i) map.add(frame_with_person(20, 40), {}, {});
  EXPECT_GT(nearer_than(map.cloud(), 1.5F), 50U);
  for (int i = 0; i < 4; ++i) map.add(frame_with_person(0, 0), {}, {});
  EXPECT_EQ(nearer_than(map.cloud(), 1.5F), 0U);
  EXPECT_GT(map.cloud().size(), 500U);
}

TEST(VoxelMap, ExcludedPixelsAreLeftOut) {
  VoxelMap map(kCamera, {.voxel_m = 0.05});
  const auto person = [](int, int, double depth_m) { return depth_m < 1.5; };
  for (int i = 0; i < 5; ++i) map.add(frame_with_person(20, 40), {}, person);
  EXPECT_EQ(nearer_than(map.cloud(), 1.5F), 0U);
  EXPECT_GT(map.cloud().size(), 300U);
}

TEST(VoxelMap, APersonWhoStaysIsRemovedByTheImagesInWhichThePersonIsDetected) {
  VoxelMap map(kCamera, {.voxel_m = 0.05});
  const auto person = [](int, int, double depth_m) { return depth_m < 1.5; };
  for (int i = 0; i < 4; ++i) map.add(frame_with_person(20, 40), {}, {});
  for (int i = 0; i < 4; ++i) map.add(frame_with_person(20, 40), {}, person);
  EXPECT_EQ(nearer_than(map.cloud(), 1.5F), 0U);
}

TEST(VoxelMap, PointsOfTooFewImagesAndBeyondTheRangeAreLeftOut) {
  VoxelMap few(kCamera, {.voxel_m = 0.05, .min_images = 3});
  for (int i = 0; i < 2; ++i) few.add(frame_with_person(0, 0), {}, {});
  EXPECT_TRUE(few.cloud().empty());
  VoxelMap near(kCamera, {.voxel_m = 0.05, .max_depth_m = 1.9, .min_images = 1});
  near.add(frame_with_person(0, 0), {}, {});
  EXPECT_TRUE(near.cloud().empty());
}

TEST(PlyFile, AWrittenCloudIsReadBack) {
  const TemporaryFolder folder;
  const std::vector<CloudPoint> cloud = {{{1.5F, -2.0F, 3e-7F}, {1, 2, 255}}, {{0.0F, 4.0F, 5.0F}, {}}};
  std::ofstream(folder.path() / "a.ply", std::ios::binary) << eval::ply_bytes(cloud);
  const std::vector<CloudPoint> read = eval::read_ply(folder.path() / "a.ply");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].p, cloud[0].p);
  EXPECT_EQ(read[0].rgb, cloud[0].rgb);
}

TEST(PlyFile, TextWithOtherPropertiesAndTypesIsRead) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "a.ply")
      << "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 2\nproperty double z\nproperty int label\n"
         "property double x\nproperty double y\nelement face 1\nproperty list uchar int vertex_indices\n"
         "end_header\n3 7 1 2\n6 7 4 5\n3 0 1 0\n";
  const std::vector<CloudPoint> read = eval::read_ply(folder.path() / "a.ply");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].p, Eigen::Vector3f(4, 5, 6));
}

TEST(PlyFile, TextIsReadBackInMillimeters) {
  const std::vector<CloudPoint> read =
      eval::parse_ply(eval::ply_text({{{1.23456F, -2.0F, 4096.0F}, {1, 2, 255}}}), "a");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_NEAR(read[0].p.x(), 1.235F, 1e-6F);
  EXPECT_EQ(read[0].p.tail<2>(), Eigen::Vector2f(-2, 4096));
  EXPECT_EQ(read[0].rgb, (std::array<std::uint8_t, 3>{1, 2, 255}));
}

TEST(PlyFile, DefectiveFilesAreErrors) {
  const TemporaryFolder folder;
  const std::string good = eval::ply_bytes({{{1, 2, 3}, {}}});
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"hello", "no PLY file"},
      {good.substr(0, good.size() - 1), "ends before its last point"},
      {head + "element vertex 99999999999\n" + xyz + "end_header\n1 2 3\n", "ends before its last point"},
      {head + "element vertex 1\n" + xyz + "end_header\n1 nan 3\n", "no finite number"},
      {head + "element vertex 1\nproperty float x\nend_header\n1\n", "x, y and z"},
      {head + "element vertex 0\n" + xyz + "end_header\n", "no points"},
      {head + "element vertex 1\nproperty list uchar int x\nend_header\n1\n", "no lists"},
      {"ply\nformat binary_big_endian 1.0\nelement vertex 1\n" + xyz + "end_header\n", "binary_big_endian"}};
  for (const auto& [text, problem] : cases) {
    std::ofstream(folder.path() / "bad.ply", std::ios::binary) << text;
    expect_input_error([&] { static_cast<void>(eval::read_ply(folder.path() / "bad.ply")); },
                       {"bad.ply", problem.c_str()});
  }
}

TEST(ThinnedCloud, HasOnePointPerCell) {
  std::vector<CloudPoint> plane;
  for (int row = 0; row < 100; ++row)
    for (int column = 0; column < 100; ++column)
      plane.push_back({.p = {0.04F * static_cast<float>(column), 0.04F * static_cast<float>(row), 1.0F}});
  EXPECT_EQ(eval::thinned_cloud(plane, 10000).size(), 10000U);
  const std::vector<CloudPoint> thin = eval::thinned_cloud(plane, 2500);
  EXPECT_LE(thin.size(), 2500U);
  EXPECT_GT(thin.size(), 1500U);
  // Every part of the plane keeps points: its quarters have a quarter of them.
  EXPECT_NEAR(static_cast<double>(std::ranges::count_if(
                  thin, [](const auto& point) { return point.p.x() < 2.0F && point.p.y() < 2.0F; })),
              0.25 * static_cast<double>(thin.size()), 0.05 * static_cast<double>(thin.size()));
  for (CloudPoint& point : plane) point.p -= Eigen::Vector3f(2.02F, 2.02F, 0.0F);
  EXPECT_LE(eval::thinned_cloud(plane, 8).size(), 8U);
}

TEST(CloudDistance, TheTreeFindsTheNearestPoint) {
  Random random(1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i) points.push_back(random.normal3().cast<float>());
  const eval::PointTree tree(points);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f query = (2.0 * random.normal3()).cast<float>();
    float nearest = 1e9F;
    for (const Eigen::Vector3f& point : points) nearest = std::min(nearest, (point - query).norm());
    EXPECT_NEAR(tree.distance(query), nearest, 1e-6);
  }
}

TEST(CloudDistance, WorldsAreAlignedByOrientationsAlsoWithoutMotion) {
  const Pose T{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, 3).normalized())), {1, 2, 3}};
  const Pose still{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}};
  const std::vector<eval::MatchedPose> matches(3, {.t = {}, .gt = T * still, .est = still});
  const Pose aligned = eval::align_worlds(matches);
  EXPECT_LT((aligned.p - T.p).norm(), 1e-12);
  EXPECT_LT(aligned.q.angularDistance(T.q), 1e-7);
}

TEST(CloudDistance, TheScoreFollowsItsDefinition) {
  // Distances of the estimate to the truth: 0.01, 0.03, 1; of the truth to the estimate: 0.01, 0.03, 5 .. 1.
  const std::vector<Eigen::Vector3f> estimate = {{0, 0, 0.01F}, {1, 0, 0.03F}, {2, 0, 1}};
  const std::vector<Eigen::Vector3f> truth = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 0, 0}};
  const eval::CloudScore score = eval::score_cloud(estimate, truth, 0.05);
  EXPECT_NEAR(score.accuracy_m, 1.04 / 3.0, 1e-6);
  EXPECT_NEAR(score.accuracy_median_m, 0.03, 1e-6);
  EXPECT_NEAR(score.precision, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(score.completeness, 0.5, 1e-12);
  EXPECT_NEAR(score.f_score, 2.0 * (2.0 / 3.0) * 0.5 / (2.0 / 3.0 + 0.5), 1e-12);
}

}  // namespace
}  // namespace stillpoint
