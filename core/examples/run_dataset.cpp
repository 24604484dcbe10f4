// SPDX-License-Identifier: BSD-3-Clause
/// Runs the odometry on a sequence folder with the default config or another of the program, and writes its
/// poses in the TUM format.
///   run_dataset FOLDER OUT [CONFIG]     CONFIG: "dynamic_vins", ..., or a TOML file
#include <algorithm>
#include <cstdio>
#include <exception>

#include "bench/config/config_file.h"
#include "core/pipeline/odometry.h"
#include "datasets/open_sequence.h"
#include "eval/io/trajectory_file.h"

namespace {

stillpoint::Trajectory run(const stillpoint::datasets::SensorStream& sequence,
                           const stillpoint::OdometryConfig& config) {
  const stillpoint::datasets::SequenceInfo& info = sequence.info();
  stillpoint::Odometry odometry(config, info.rig);
  for (const stillpoint::ImuSample& sample : info.imu) odometry.add_imu(sample);
  stillpoint::Trajectory trajectory{.frame = "camera"};
  for (std::size_t i = 0; i < info.frame_times.size(); ++i) {
    const stillpoint::Frame frame = sequence.load_frame(i);
    const auto boxes = std::ranges::find(info.detections, frame.t, &stillpoint::DetectionSet::t);
    const stillpoint::OdometryUpdate& update =
        odometry.track(frame, boxes == info.detections.end() ? stillpoint::DetectionSet{} : *boxes);
    // A pose of a later segment, after a loss, has another origin.
    if (stillpoint::is_located(update.status) && update.segment == 0)
      trajectory.poses.push_back({frame.t, update.T_w_c});
  }
  return trajectory;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: %s FOLDER OUT [CONFIG]\n", argv[0]);
    return 2;
  }
  try {
    const stillpoint::OdometryConfig config =
        argc == 4 ? stillpoint::bench::load_config({.base = argv[3]}) : stillpoint::OdometryConfig{};
    const auto sequence = stillpoint::datasets::open_sequence(argv[1]);
    stillpoint::eval::write_tum(run(*sequence, config), argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
