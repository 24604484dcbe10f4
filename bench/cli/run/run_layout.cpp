// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/run_layout.h"

namespace stillpoint::bench {
namespace {

/// `run` and the modes of `profile` may use the same folder.
std::vector<std::vector<std::string>> marks() {
  return {{"result.json", "manifest.json"}, {"profile.json"}, {"device.json"}, {"instructions.json"}};
}

}  // namespace

OutputLayout run_layout() {
  return {.names = {"trajectory.tum", "trajectory_imu.tum", "trajectory_loop.tum", "trajectory_optimized.tum",
                    "loops.csv", "keyframes.csv", "result.json", "timings.csv", "frames.csv", "counters.csv",
                    "status.csv", "stacks.folded", "manifest.json", "labels.csv", "cost.svg", "loop_cost.svg",
                    "images"},
          .marks = marks()};
}

OutputLayout video_layout() { return {.names = {"video.mp4", "frames"}, .marks = {{"video.mp4", "frames"}}}; }

OutputLayout profile_layout() {
  return {.names = {"profile.json", "trace.json", "stacks.folded", "device.json", "trajectory.tum",
                    "instructions.json"},
          .marks = marks()};
}

}  // namespace stillpoint::bench
