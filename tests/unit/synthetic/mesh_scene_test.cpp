// SPDX-License-Identifier: BSD-3-Clause
// Scenes from files of scanned surfaces.
#include "datasets/synthetic/scenes/mesh_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/io/image_io.h"
#include "datasets/open_sequence.h"
#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/render/frame_renderer.h"
#include "datasets/synthetic/scenes/mesh_file.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "datasets/synthetic/sequence/request_rig.h"
#include "datasets/synthetic/sequence/scene_setup.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

/// A room of 6 x 6 x 3 m around the origin, floor at `floor`, as a PLY of squares of 0.25 m with random
/// colors.
class RoomScan {
 public:
  /// @param scale of all coordinates
  explicit RoomScan(double floor, double scale = 1.0) : scale_(scale) {
    for (const double side : {-3.0, 3.0}) {
      add_side({side, -3.0, floor}, {0.0, 6.0, 0.0}, {0.0, 0.0, 3.0});
      add_side({-3.0, side, floor}, {6.0, 0.0, 0.0}, {0.0, 0.0, 3.0});
    }
    for (const double height : {floor, floor + 3.0})
      add_side({-3.0, -3.0, height}, {6.0, 0.0, 0.0}, {0.0, 6.0, 0.0});
  }

  [[nodiscard]] std::string ply() const {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face "
        "{}\nproperty list uchar int vertex_indices\nend_header\n{}{}",
        vertices_, faces_, vertex_lines_, face_lines_);
  }

 private:
  void add_side(const Vector3d& corner, const Vector3d& u, const Vector3d& v) {
    constexpr double kCell_m = 0.25;
    const int columns = static_cast<int>(u.norm() / kCell_m), rows = static_cast<int>(v.norm() / kCell_m);
    for (int row = 0; row <= rows; ++row) {
      for (int column = 0; column <= columns; ++column) {
        const Vector3d p = scale_ * (corner + u * column / columns + v * row / rows);
        vertex_lines_ += fmt::format("{} {} {} {} {} {}\n", p.x(), p.y(), p.z(), random_.uniform(0, 255),
                                     random_.uniform(0, 255), random_.uniform(0, 255));
        if (row == rows || column == columns) continue;
        const int at = vertices_ + row * (columns + 1) + column;
        face_lines_ += fmt::format("4 {} {} {} {}\n", at, at + 1, at + columns + 2, at + columns + 1);
        ++faces_;
      }
    }
    vertices_ += (rows + 1) * (columns + 1);
  }

  double scale_;
  cv::RNG random_{7};
  std::string vertex_lines_, face_lines_;
  int vertices_ = 0, faces_ = 0;
};

/// A camera that looks along +x and moves 0.2 m/s along y at 1.5 m, 6 s at 30 Hz from time 50 s on.
std::string camera_path(double height) {
  std::string text;
  for (int i = 0; i <= 180; ++i)
    text +=
        fmt::format("{:.4f} -1.5 {:.4f} {} -0.5 0.5 -0.5 0.5\n", 50.0 + i / 30.0, i / 150.0 - 0.6, height);
  return text;
}

SynthRequest mesh_request(const TemporaryFolder& folder, double floor) {
  SynthRequest request = preset_request("mesh");
  request.mesh_file = folder.write("room.ply", RoomScan(floor).ply());
  request.trajectory_file = folder.write("path.txt", camera_path(floor + 1.5));
  request.width = 160, request.height = 120, request.focal_px = 134.0;
  request.seconds = 0.2;
  return request;
}

Exposure exposure_of(const Pose& T_w_c) {
  Exposure exposure;
  exposure.poses.emplace_back().fill(T_w_c);
  exposure.mid_times = {0.5F};
  return exposure;
}

/// What a camera of 40 x 40 px at the origin sees that looks along +x.
RenderedFrame view_along_x(const World& world) {
  const Camera camera{.width = 40, .height = 40, .fx = 40.0, .fy = 40.0, .cx = 19.5, .cy = 19.5};
  const RayTracer tracer(world);
  return FrameRenderer(world, tracer, camera)
      .render(exposure_of({camera_attitude(0.0, 0.0, 0.0), {}}), nullptr);
}

double red_at(const RenderedFrame& frame, int row, int column) {
  return static_cast<double>(
      std::sqrt(frame.radiance[static_cast<std::size_t>(row * frame.width + column)][0]));
}

TEST(MeshFile, ColorsOfVerticesAreInterpolatedAcrossATriangle) {
  const TemporaryFolder folder;
  World world;
  // At x = 2: black at the lower left corner of the view, red 200 at the others.
  read_mesh(folder.write("t.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
                         "blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                         "2 2 -2 0 0 0\n2 -2 -2 200 0 0\n2 2 2 200 0 0\n3 0 1 2\n"),
            world);
  const RenderedFrame frame = view_along_x(world);
  for (const auto& [row, column] : {std::pair{30, 8}, {20, 12}, {35, 20}, {10, 5}}) {
    // Barycentric coordinates of the pixel's point on the plane x = 2, from the black corner.
    const double right = (column - 19.5) / 40.0 * 2.0 / 4.0 + 0.5, up = (19.5 - row) / 40.0 * 2.0 / 4.0 + 0.5;
    EXPECT_NEAR(red_at(frame, row, column), (right + up) * 200.0 / 255.0, 0.01) << row << " " << column;
    EXPECT_NEAR(frame.depth_m[static_cast<std::size_t>(row * 40 + column)], 2.0, 1e-5);
  }
}

TEST(MeshFile, TexturesAreShownUprightAndUnmirrored) {
  const TemporaryFolder folder;
  cv::Mat image(48, 48, CV_8UC3, cv::Scalar(0, 0, 0));              // enlarged to 64 x 64
  image(cv::Rect(24, 0, 24, 24)).setTo(cv::Scalar(255, 255, 255));  // upper right
  datasets::write_png(folder.path() / "wall.png", image);
  folder.write("wall.mtl", "newmtl wall\nmap_Kd wall.png\n");
  World world;
  read_mesh(folder.write("wall.obj",
                         "mtllib wall.mtl\nv 2 1 -1\nv 2 -1 -1\nv 2 -1 1\nv 2 1 1\n"
                         "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl wall\nf 1/1 2/2 3/3 4/4\n"),
            world);
  ASSERT_EQ(world.textures.size(), 1u);
  EXPECT_EQ(world.textures.front().width(), 64);
  const RenderedFrame frame = view_along_x(world);
  EXPECT_GT(red_at(frame, 10, 30), 0.95);
  EXPECT_LT(red_at(frame, 10, 10), 0.05);
  EXPECT_LT(red_at(frame, 30, 30), 0.05);
}

TEST(MeshFile, WhatCannotBeRenderedIsNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const fs::path& file, const std::vector<std::string>& parts) {
    World world;
    expect_input_error([&] { read_mesh(file, world); }, parts);
  };
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  expect(folder.write("cloud.ply", header + "end_header\n0 0 0\n1 0 0\n0 1 0\n"),
         {"cloud.ply", "point cloud"});
  expect(
      folder.write("gray.ply", header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
      {"gray.ply", "neither vertex colors nor a texture"});
  expect(folder.write("text.ply", "not a mesh\n"), {"text.ply", "cannot be read as a mesh"});
  expect(folder.path() / "none.obj", {"none.obj", "no such file", "--mesh"});
  expect(folder.write("scan.stl", "solid\n"), {"scan.stl", ".ply or .obj"});
  expect(folder.write("seam.ply",
                      header + "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar "
                               "float texcoord\nend_header\n"),
         {"seam.ply", "per face", "OBJ"});
  // Read out of bounds before.
  for (const std::string vertex : {"3", "900000000"})
    expect(folder.write("far.ply", header +
                                       "element face 1\nproperty list uchar int vertex_indices\n"
                                       "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 " +
                                       vertex + "\n"),
           {"far.ply", "face 0 names vertex " + vertex + " of 3", "repair"});
  folder.write("lost.mtl", "newmtl wall\nmap_Kd none.png\n");
  expect(folder.write("lost.obj",
                      "mtllib lost.mtl\nv 2 1 -1\nv 2 -1 -1\nv 2 -1 1\nvt 0 0\nvt 1 0\nvt 1 1\n"
                      "usemtl wall\nf 1/1 2/2 3/3\n"),
         {"lost.obj", "none.png", "does not exist; copy it there"});
  expect(folder.write("two.ply",
                      "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\n" +
                          header.substr(header.find("element"))),
         {"two.ply", "2 textures", "OBJ"});
}

TEST(MeshFile, TexturesThatNeedTooMuchMemoryAreRefused) {
  const TemporaryFolder folder;
  std::string materials, faces;
  for (const std::string name : {"a", "b"}) {
    datasets::write_png(folder.path() / (name + ".png"), cv::Mat(64, 64, CV_8UC3, cv::Scalar(9, 9, 9)));
    materials += fmt::format("newmtl {0}\nmap_Kd {0}.png\n", name);
    faces += fmt::format("usemtl {}\nf 1/1 2/2 3/3\n", name);
  }
  folder.write("m.mtl", materials);
  const fs::path file =
      folder.write("m.obj", "mtllib m.mtl\nv 2 1 -1\nv 2 -1 -1\nv 2 -1 1\nvt 0 0\nvt 1 0\nvt 1 1\n" + faces);
  World world, refused;
  read_mesh(file, world, 2 * 64 * 64);
  EXPECT_EQ(world.textures.size(), 2U);
  expect_input_error([&] { read_mesh(file, refused, 2 * 64 * 64 - 1); },
                     {"m.obj", "too many pixels in 2 textures", "reduce the sizes"});
}

TEST(MeshScene, ThePathMustBeThatOfALevelCameraInTheMesh) {
  const TemporaryFolder folder;
  const fs::path room = folder.write("room.ply", RoomScan(0.0).ply());
  const auto build = [&](const Pose& T_w_c) {
    return [&room, T_w_c] { static_cast<void>(build_mesh_scene(room, std::array{T_w_c})); };
  };
  expect_input_error(build({camera_attitude(0.0, 0.0, 0.0), {40.0, 0.0, 1.0}}),
                     {"37 m", "frame of the mesh"});
  expect_input_error(build({camera_attitude(0.0, 0.0, 3.1), {0.0, 0.0, 1.0}}), {"upside down", "transform"});
  EXPECT_NO_THROW(build({camera_attitude(0.0, 1.4, 0.0), {0.0, 0.0, 1.0}})());   // looks down
  EXPECT_NO_THROW(build({camera_attitude(0.0, 0.0, 0.0), {-4.0, 0.0, 1.0}})());  // from outside
  expect_input_error(build({camera_attitude(3.1, 0.0, 0.0), {-4.0, 0.0, 1.0}}),
                     {"room.ply", "not in view", "quaternions"});
}

TEST(MeshScene, ARoomInCentimetersIsRefused) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  request.mesh_file = folder.write("room.ply", RoomScan(0.0, 100.0).ply());
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); },
                     {"room.ply", "600 m long", "path of the camera 1.2 m", "scale it to meters"});
}

TEST(MeshScene, PeopleWalkOnItsFloorWhereThereIsSpace) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.7);
  request.walkers = 1;
  const SceneSetup setup = make_scene_setup(request);
  ASSERT_EQ(setup.actors.size(), 1u);
  for (double t_s = 0.0; t_s < 60.0; t_s += 1.0) {
    double lowest = 10.0;
    const std::vector<Pose> parts = setup.actors.front().poses_at(t_s);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (const Eigen::Vector3f& point : setup.actors.front().parts[i].points) {
        const Vector3d p = parts[i] * Vector3d(point.cast<double>());
        lowest = std::min(lowest, p.z());
        EXPECT_LT(p.head<2>().cwiseAbs().maxCoeff(), 3.0) << "in a wall at " << t_s << " s";
      }
    }
    EXPECT_NEAR(lowest, 0.7, 0.05) << t_s;
  }
  request.seated = 1;
  expect_input_error([&] { static_cast<void>(make_scene_setup(request)); }, {"seated"});
}

TEST(MeshScene, ASequenceIsRenderedWithTheRigOfAFile) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  use_rig(request, folder.write("rig.toml",
                                "[camera]\nwidth = 160\nheight = 120\nfx = 140.0\nfy = 139.0\ncx = 78.0\n"
                                "cy = 61.0\ndistortion = [-0.2, 0.05, 0.001, 0.0]\n"
                                "[imu]\ngyro_noise = 0.002\n"));
  check_request(request);
  ASSERT_TRUE(render_sequence(request, folder.path() / "sequence"));
  const auto stream = datasets::open_sequence(folder.path() / "sequence");
  const Rig& rig = stream->info().rig;
  EXPECT_EQ(rig.camera.fy, 139.0);
  EXPECT_EQ(rig.camera.distortion[0], -0.2);
  EXPECT_NEAR(rig.imu_noise.gyro_noise, 0.002, 1e-9);
  // The wall at x = 3 is 4.5 m ahead of the camera, in z depth, in all parts of the bent image.
  const cv::Mat depth =
      datasets::read_depth(*fs::directory_iterator(folder.path() / "sequence/aligned_depth"));
  for (const auto& [row, column] : {std::pair{60, 80}, {60, 20}, {50, 140}})
    EXPECT_NEAR(depth.at<std::uint16_t>(row, column) / 1000.0, 4.5, 0.15);
}

TEST(MeshScene, ADepthUnitThatTheLayoutDoesNotHaveIsRefused) {
  SynthRequest request = preset_request("walking_xyz");
  request.depth.units_per_m = 5000.0;  // read as millimeters before
  expect_input_error([&] { check_request(request); }, {"units_per_m", "layout tum"});
  request.layout = SequenceLayout::kTum;
  EXPECT_NO_THROW(check_request(request));
}

TEST(MeshScene, RigsThatAreNotRenderedAreNamed) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  const auto expect = [&](const std::string& text, const std::vector<std::string>& parts) {
    const fs::path file = folder.write("rig.toml", text);
    expect_input_error([&] { use_rig(request, file); }, parts);
  };
  expect("[camera]\nmodel = \"kannala-brandt\"\n", {"rig.toml", "fisheye"});
  expect(
      "[depth]\nwidth = 10\nheight = 10\nfx = 10\nfy = 10\ncx = 5\ncy = 5\n"
      "T_c_d = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n",
      {"rig.toml", "depth camera"});
}

/// 6 s of a path with a pose every `step` tenths of a second, without those from `gap_from` to `gap_to` [s].
std::string path_with_gap(double step, double gap_from, double gap_to) {
  std::string text;
  for (double t = 0.0; t <= 6.0; t += step) {
    if (t > gap_from && t < gap_to) continue;
    text += fmt::format("{:.4f} -1.5 {:.4f} 1.5 -0.5 0.5 -0.5 0.5\n", 50.0 + t, 0.2 * t - 0.6);
  }
  return text;
}

TEST(MeshScene, ThePathMayBeAtALowRateButNotHaveGaps) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  request.trajectory_file = folder.write("slow.txt", path_with_gap(0.1, 9.0, 9.0));
  const SceneSetup setup = make_scene_setup(request);
  constexpr double kAt_s = 0.15;
  const Pose T_w_c = setup.body_path.pose_at(kAt_s) * setup.rig.T_b_c;
  EXPECT_NEAR(T_w_c.p.y(), -0.6 + 0.2 * (seconds_between(Timestamp{50'000'000'000}, setup.epoch) + kAt_s),
              1e-3);
  request.seconds = 2.0;
  // In the middle, at the end, over the whole of what is rendered, and one that a slow path may have.
  for (const std::string& text : {path_with_gap(0.1, 1.0, 1.7), path_with_gap(1.0 / 30.0, 2.0, 5.0),
                                  path_with_gap(1.0 / 30.0, 0.1, 5.0), path_with_gap(1.0 / 30.0, 1.0, 1.2)}) {
    request.trajectory_file = folder.write("gap.txt", text);
    expect_input_error([&] { static_cast<void>(make_scene_setup(request)); },
                       {"gap.txt", "no pose", "--start"});
  }
}

TEST(MeshScene, ThePathMustNotJump) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  request.seconds = 2.0;
  const auto path = [&](double turn_rad) {
    std::string text;
    for (int i = 0; i <= 180; ++i) {
      const bool is_after = i > 60;
      const Eigen::Quaterniond q = camera_attitude(is_after ? turn_rad : 0.0, 0.0, 0.0);
      text += fmt::format("{:.4f} -1.5 {:.4f} 1.5 {} {} {} {}\n", 50.0 + i / 30.0,
                          i / 150.0 - 0.6 + (is_after && turn_rad == 0.0 ? 0.5 : 0.0), q.x(), q.y(), q.z(),
                          q.w());
    }
    return folder.write("jump.txt", text);
  };
  for (const double turn_rad : {0.0, 2.5}) {
    request.trajectory_file = path(turn_rad);
    expect_input_error([&] { static_cast<void>(make_scene_setup(request)); },
                       {"jump.txt", "jumps near 5", "--start"});
  }
}

TEST(MeshScene, TheKeyOfARenderingDependsOnTexturesToo) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  request.mesh_file = folder.write("wall.obj", "mtllib wall.mtl\nv 0 0 0\n");
  folder.write("wall.mtl", "newmtl wall\n  map_Kd -clamp on wall.png\n");
  std::set<std::string> keys;
  for (const char* image : {"red", "blue"}) {
    folder.write("wall.png", image);
    keys.insert(request_key(request));
  }
  folder.write("wall.mtl", "newmtl other\n");
  keys.insert(request_key(request));
  EXPECT_EQ(keys.size(), 3U);
}

TEST(MeshScene, TheKeyOfARenderingDependsOnFilesWhoseNamesContainBlanks) {
  const TemporaryFolder folder;
  SynthRequest request = mesh_request(folder, 0.0);
  request.mesh_file = folder.write("wall.obj", "mtllib my walls.mtl\nv 0 0 0\n");
  std::set<std::string> keys;
  for (const char* line : {"map_Kd my wall.png", "map_kd -clamp on my wall.png \r"}) {
    folder.write("my walls.mtl", fmt::format("newmtl wall\n{}\n", line));
    for (const char* image : {"red", "blue"}) {
      folder.write("my wall.png", image);
      keys.insert(request_key(request));
    }
  }
  EXPECT_EQ(keys.size(), 4U);
}

}  // namespace
}  // namespace stillpoint::synth
