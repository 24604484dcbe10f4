// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/recorded_boxes.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

[[noreturn]] void throw_missing(const std::filesystem::path& folder, const std::string& problem) {
  const std::string file = datasets::companion_file(folder, "detections.txt").string();
  throw InputError(
      file, problem +
                ", but the config uses recorded boxes (detector.kind = \"recorded\"); record them with "
                "`stillpoint detect " +
                folder.string() + " --out " + file +
                "`, or run without boxes: --set detector.kind=none (in a plan: the variant "
                "NAME+wo_object_detection)");
}

/// Whether a set is at most `tolerance_s` from time `t`.
bool has_set_at(const std::vector<DetectionSet>& sets, Timestamp t, double tolerance_s) {
  const Timestamp earliest = after(t, -tolerance_s);
  const auto found = std::lower_bound(sets.begin(), sets.end(), earliest,
                                      [](const DetectionSet& set, Timestamp time) { return set.t < time; });
  return found != sets.end() && found->t <= after(t, tolerance_s);
}

}  // namespace

void require_recorded_boxes(const OdometryConfig& config, const datasets::SequenceInfo& info) {
  if (used_detector(config) != DetectorKind::kRecorded) return;
  require_recorded_boxes(config, info.folder);
  const double tolerance_s = config.detector.max_time_difference_s;
  const bool any = std::any_of(info.frame_times.begin(), info.frame_times.end(),
                               [&](Timestamp t) { return has_set_at(info.detections, t, tolerance_s); });
  if (!any) {
    throw_missing(info.folder, fmt::format("none of its {} time stamps is within {} s of a frame",
                                           info.detections.size(), tolerance_s));
  }
}

void require_recorded_boxes(const OdometryConfig& config, const std::filesystem::path& folder) {
  if (used_detector(config) != DetectorKind::kRecorded) return;
  if (!std::filesystem::exists(datasets::companion_file(folder, "detections.txt")))
    throw_missing(folder, "does not exist");
}

}  // namespace stillpoint::bench
