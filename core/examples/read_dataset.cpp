// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence folder of any supported format and prints what it contains.
///   read_dataset FOLDER
#include <cstdio>
#include <exception>

#include "datasets/open_sequence.h"

namespace datasets = stillpoint::datasets;

namespace {

void print_content(const datasets::SensorStream& sequence) {
  const datasets::SequenceInfo& info = sequence.info();
  const stillpoint::Camera& camera = info.rig.camera;
  const double seconds = seconds_between(info.frame_times.front(), info.frame_times.back());
  std::printf("%s (%s)\n", info.name.c_str(), info.format.c_str());
  std::printf("  %zu frames over %.2f s\n", info.frame_times.size(), seconds);
  std::printf("  camera %dx%d, fx %.1f, fy %.1f\n", camera.width, camera.height, camera.fx, camera.fy);
  std::printf("  %zu IMU samples, %zu ground-truth poses of \"%s\"\n", info.imu.size(),
              info.ground_truth.trajectory.poses.size(), info.ground_truth.trajectory.frame.c_str());
  std::printf("  recorded detections for %zu timestamps\n", info.detections.size());
  for (const std::string& note : info.notes) std::printf("  note: %s\n", note.c_str());
}

/// Images are decoded on demand, one frame at a time.
void print_frame(const stillpoint::Frame& frame) {
  std::size_t measured = 0;
  for (int row = 0; row < frame.depth.rows; ++row) {
    for (int column = 0; column < frame.depth.cols; ++column) {
      if (frame.depth.at<std::uint16_t>(row, column) != 0) ++measured;
    }
  }
  std::printf("first frame: t = %.3f s, %s, %zu of %zu pixels with depth\n", to_seconds(frame.t),
              frame.color.empty() ? "gray" : "color", measured, frame.gray.total());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  try {
    const auto sequence = datasets::open_sequence(argv[1]);
    print_content(*sequence);
    print_frame(sequence->load_frame(0));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
