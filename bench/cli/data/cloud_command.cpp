// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint data cloud`: the point cloud of a sequence by its ground truth, to compare the map of a run
// with.
#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/plan/plan_sequences.h"
#include "bench/record/output_folder.h"
#include "bench/run/sequence_source.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/mapping/voxel_map.h"
#include "datasets/open_sequence.h"
#include "datasets/sensor_stream.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::bench {
namespace {

struct CloudArguments {
  std::string sequence, out, format, rig;
  std::vector<std::string> topics;
  double voxel_m = 0.02, max_depth_m = 4.0;
  int every = 5, min_images = 4;
};

/// Fuses every n-th frame that has a true pose. @return the cloud
std::vector<eval::CloudPoint> true_cloud(const datasets::SensorStream& stream,
                                         const CloudArguments& arguments) {
  const datasets::SequenceInfo& info = stream.info();
  Trajectory frames;
  for (std::size_t i = 0; i < info.frame_times.size(); i += static_cast<std::size_t>(arguments.every))
    frames.poses.push_back({info.frame_times[i], {}});
  const Trajectory truth =
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  datasets::VoxelMap map(info.rig.camera, {.voxel_m = arguments.voxel_m,
                                           .max_depth_m = arguments.max_depth_m,
                                           .min_images = arguments.min_images});
  ProgressLine line("fusing", frames.poses.size(), "frames");
  std::size_t done = 0;
  for (const eval::MatchedPose& match : eval::strict_matches(truth, frames)) {
    if (interrupt_requested()) return {};
    const auto found = std::ranges::lower_bound(info.frame_times, match.t);
    const auto index = static_cast<std::size_t>(found - info.frame_times.begin());
    map.add(stream.load_frame(index), match.gt, {});
    line.update(++done);
  }
  return map.cloud();
}

int write_true_cloud(const CloudArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is required: the PLY file to write");
  install_interrupt_handlers();
  const OutputRules rules{.inputs = {arguments.sequence, arguments.rig}};
  require_safe_output(arguments.out, rules);
  const auto stream =
      find_sequence(resolve_sequence(arguments.sequence),
                    {.format = arguments.format, .rig_file = arguments.rig, .topics = arguments.topics},
                    {.stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::vector<eval::CloudPoint> cloud = true_cloud(*stream, arguments);
  if (interrupt_requested()) return kExitInterrupted;
  if (cloud.empty())
    throw InputError(arguments.sequence,
                     "gives no points: it lacks depth images, or true poses at the times of frames; check it "
                     "with `stillpoint data check`");
  write_output(arguments.out, eval::ply_bytes(cloud), rules);
  std::cout << fmt::format("{}: {}\n", counted(cloud.size(), "point"), arguments.out);
  return kExitOk;
}

}  // namespace

Command cloud_command() {
  const auto arguments = std::make_shared<CloudArguments>();
  CloudArguments& a = *arguments;
  return {.name = "cloud",
          .summary = "Fuse depth images by the ground truth into a colored point cloud (.ply)",
          .example = "data cloud walking_xyz_empty --voxel 0.01 --min-images 1 --out truth.ply",
          .options = {{"SEQ", "Sequence folder, bag or preset name", &a.sequence},
                      {"--out", "PLY file to write", &a.out},
                      {"--voxel", "Side of a voxel, one point each [0.02 m]", &a.voxel_m, {1e-3, 10.0}},
                      {"--max-depth", "Farther measurements are left out [4 m]", &a.max_depth_m, {0.1, 1e3}},
                      {"--min-images",
                       "Images in which a point must be measured; 1 for exact depth [4]",
                       &a.min_images,
                       {1, 1e6}},
                      {"--every", "Use the first frame and every N-th after it [5]", &a.every, {1, 1e6}},
                      {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]",
                       &a.format},
                      {"--topics", kTopicsHelp, &a.topics},
                      {"--rig", kRigHelp, &a.rig}},
          .action = [arguments] { return write_true_cloud(*arguments); }};
}

}  // namespace stillpoint::bench
