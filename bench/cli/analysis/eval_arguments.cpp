// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/eval_arguments.h"

#include "bench/cli/enum_option.h"
#include "eval/io/any_trajectory.h"

namespace stillpoint::bench {

eval::ProtocolOptions protocol_options(const EvalArguments& arguments) {
  eval::ProtocolOptions options;
  if (!arguments.alignment.empty())
    options.alignment = enum_of<eval::Alignment>("--align", arguments.alignment);
  options.align_first_n = static_cast<std::size_t>(arguments.align_first);
  if (arguments.max_difference_s > 0.0) options.max_difference_s = arguments.max_difference_s;
  options.rpe_delta = arguments.rpe_delta;
  options.rpe_unit = enum_of<eval::RpeUnit>("--rpe-unit", arguments.rpe_unit);
  options.offset_s = arguments.offset_s;
  return options;
}

std::vector<Option> options_of(EvalArguments& a) {
  return {
      {"GT",
       "Ground-truth trajectory: a file, or BAG:/TOPIC of a bag (poses; /tf:PARENT.CHILD for a chain of "
       "transforms)",
       &a.ground_truth},
      {"EST", "Estimated trajectories of the same body frame", &a.estimates},
      {"--protocol",
       "Evaluation protocol: compat:tum, compat:evo, compat:rpg, compat:openloris, strict:se3 ...; may be "
       "repeated",
       &a.protocols,
       {},
       "--recipe"},
      {"--align", "Override the alignment of the protocol: " + enum_list<eval::Alignment>(), &a.alignment},
      {"--align-first", "Align with the first N matches only", &a.align_first, {1, 1e9}},
      {"--level", "File with leveling_rotation_xyzw, for alignment yaw [result.json beside EST]", &a.level},
      {"--rpe-delta", "RPE interval, in units of --rpe-unit", &a.rpe_delta, {1e-6, 1e6}},
      {"--rpe-unit", "Unit of the RPE interval: s, f (frames) or m", &a.rpe_unit},
      {"--offset", "Offset to add to the time stamps of the estimate [s]", &a.offset_s, {-1e9, 1e9}},
      {"--find-offset", "Estimate the time offset and print it, without applying it", &a.find_offset},
      {"--max-difference",
       "Override the maximum time difference of matched poses of the protocol [s]",
       &a.max_difference_s,
       {1e-9, 1e6}},
      {"--format", "Trajectory format: " + enum_list<eval::TrajectoryFormat>() + " [detected]", &a.format},
      {"--times", "File of time stamps of a KITTI trajectory", &a.times},
      {"--seq", "Sequence number in an OpenLORIS file", &a.sequence, {0, 1e9}},
      {"--explain", "Print a description of each protocol", &a.explain},
      {"--json", "Print JSON with full precision", &a.json},
      {"--csv", "Print CSV", &a.csv},
      {"--markdown", "Print Markdown", &a.markdown},
      {"--map", "Write a plan with scale and north arrow; GT may be NMEA sentences of a GNSS receiver",
       &a.map},
      {"--plot", "Write a plot of trajectories and errors (.svg, .pdf or .png)", &a.plot},
      {"--per-pose", "Write the errors of all poses as CSV", &a.per_pose},
      {"--force", "Replace existing files of --plot and --per-pose", &a.force}};
}

}  // namespace stillpoint::bench
