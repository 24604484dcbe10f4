// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_result.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "bench/run/run_scores.h"
#include "datasets/faults/faulty_stream.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::bench {
namespace {

/// Ground-truth trajectory of the camera over the given frames; uncropped if they are all of the sequence.
Trajectory camera_truth(const datasets::SequenceInfo& info, const std::vector<Timestamp>& frames) {
  Trajectory truth =
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  if (frames.size() == info.frame_times.size() || frames.empty()) return truth;
  // A frame may be associated with a slightly later or earlier ground-truth pose.
  const double margin_s = eval::ScoreOptions{}.max_difference_s;
  std::erase_if(truth.poses, [&](const StampedPose& pose) {
    return pose.t < after(frames.front(), -margin_s) || pose.t > after(frames.back(), margin_s);
  });
  return truth;
}

Outcome outcome_of(const OdometryRun& run) {
  if (run.summary.interrupted) return Outcome::kInterrupted;
  return run.trajectory.poses.size() < 2 ? Outcome::kLost : Outcome::kOk;
}

std::string failure_of(const OdometryRun& run) {
  switch (outcome_of(run)) {
    case Outcome::kInterrupted:
      return "interrupted after " + std::to_string(run.summary.frames) + " of " +
             std::to_string(run.frames_planned) + " frames";
    case Outcome::kLost:
      return run.trajectory.poses.empty() ? "no frame has a pose: the estimator never initialized"
                                          : "only one frame has a pose, which tells no error";
    default:
      return "";
  }
}

std::vector<std::string> calibration_warnings(const EstimatedCalibration& calibration) {
  std::vector<std::string> warnings;
  const auto warn = [&](int frames, const std::string& value, std::string_view key) {
    if (frames == 0) return;
    warnings.push_back(
        fmt::format("calibration: the {} was at its bound ({}) in {} frame(s); its estimate is unreliable",
                    value, key, frames));
  };
  warn(calibration.time_offset_at_bound,
       fmt::format("time offset, {:.4f} s at the end,", calibration.time_offset_s),
       "backend.time_offset_bound_s");
  warn(calibration.extrinsics_at_bound, "camera pose on the body",
       "backend.extrinsics_bound_m, extrinsics_bound_rad");
  warn(calibration.depth_scale_at_bound,
       fmt::format("depth scale, {:.3f} at the end,", calibration.depth_scale), "backend.depth.scale_bound");
  if (calibration.depth_scale_agrees == false) {
    warnings.push_back(fmt::format(
        "calibration: the data contradicts the depth scale of the rig; it is {:.4f} +- {:.4f} (standard "
        "deviation), the poses before it was estimated are less accurate",
        calibration.depth_scale, calibration.depth_scale_sigma.value_or(0.0)));
  }
  if (calibration.lens_agrees == false) {
    warnings.push_back(fmt::format(
        "calibration: the data contradicts the lens of the rig; focal length {:+.2f} %, k1 "
        "{:+.4f}, center ({:+.4f}, {:+.4f}) focal lengths, the poses before it was estimated are "
        "less accurate",
        -100.0 * calibration.lens[0], -calibration.lens[1], -calibration.lens[2], -calibration.lens[3]));
  }
  if (calibration.extrinsics_agree == false) {
    warnings.push_back(
        "calibration: the data contradicts the camera pose on the body of the rig; the estimate is in "
        "result.json, the poses before it was estimated are less accurate");
  }
  return warnings;
}

/// Irregularities that the reader repaired, and those that the run encountered.
std::vector<std::string> warnings_of(const datasets::SequenceInfo& info, const OdometryRun& run) {
  const RunSummary& summary = run.summary;
  std::vector<std::string> warnings = info.warnings;
  if (summary.detector_counters.unrecorded.value_or(0) > 0) {
    warnings.push_back(fmt::format("detections: {} of {} frames have no recorded boxes and were not masked",
                                   *summary.detector_counters.unrecorded, summary.frames));
  }
  if (run.depth_finding) warnings.push_back("depth: " + *run.depth_finding);
  if (summary.imu_health.gaps > 0) {
    warnings.push_back(
        fmt::format("imu: {} gap(s) between samples are longer than {} s, over which the motion is not "
                    "integrated; record without gaps at 100 Hz or more, or run without the IMU "
                    "(--variant vo)",
                    summary.imu_health.gaps, ImuConfig{}.max_gap_s));
  }
  if (summary.imu_health.rejected_samples > 0) {
    warnings.push_back(fmt::format("imu: {} sample(s) rejected: not finite, or not later than the one before",
                                   summary.imu_health.rejected_samples));
  }
  if (run.device && run.device->throttled.value_or(0.0) > 0.0) {
    warnings.emplace_back(
        "machine: the processor was throttled during the run; its times are not comparable with others");
  }
  if (run.loops && run.loops->report.bundle_adjustment && !run.loops->report.bundle_adjustment->usable)
    warnings.emplace_back(
        "global bundle adjustment: failed; the optimized poses are those of the pose graph");
  for (std::string& warning : calibration_warnings(run.calibration)) warnings.push_back(std::move(warning));
  return warnings;
}

/// The times at which any fault is active, by their begin. Imperfections that last for the whole sequence
/// belong to it where there are other faults.
std::vector<eval::TimeSpan> fault_spans(std::span<const datasets::SensorFault> faults,
                                        std::span<const Timestamp> frame_times) {
  std::vector<eval::TimeSpan> spans;
  if (frame_times.empty()) return spans;
  const bool all_permanent = std::ranges::all_of(faults, &datasets::SensorFault::is_permanent);
  for (const datasets::SensorFault& fault : faults) {
    if (fault.is_permanent() && !all_permanent) continue;
    for (const datasets::FaultInterval& interval :
         datasets::fault_intervals(fault, frame_times.front(), frame_times.back())) {
      spans.push_back({interval.begin, interval.end});
    }
  }
  std::ranges::sort(spans, {}, &eval::TimeSpan::begin);
  return spans;
}

/// Whether a fault of images, depth or boxes has a frame to change, and another one begins before the last
/// frame.
bool is_in_frames(const datasets::SensorFault& fault, std::span<const Timestamp> frame_times) {
  using enum datasets::FaultTarget;
  const datasets::FaultTarget target = datasets::descriptor_of(fault.kind).target;
  const std::vector<datasets::FaultInterval> intervals =
      datasets::fault_intervals(fault, frame_times.front(), frame_times.back());
  const bool is_of_frames = target == kImages || target == kDepth || target == kDetections;
  if (!is_of_frames || fault.kind == datasets::FaultKind::kDropped) return !intervals.empty();
  return std::ranges::any_of(intervals, [&](const datasets::FaultInterval& interval) {
    const auto next = std::ranges::lower_bound(frame_times, interval.begin);
    return next != frame_times.end() && *next < interval.end;
  });
}

std::vector<std::string> fault_warnings(std::span<const datasets::SensorFault> faults,
                                        std::span<const Timestamp> frame_times) {
  std::vector<std::string> warnings;
  for (const datasets::SensorFault& fault : faults) {
    if (frame_times.empty() || is_in_frames(fault, frame_times)) continue;
    warnings.push_back(fmt::format(
        "fault: {} is active at none of the frames, which are in {:.3g} s: the run is undisturbed",
        datasets::fault_text(fault), seconds_between(frame_times.front(), frame_times.back())));
  }
  return warnings;
}

/// Over the frames that have one.
std::optional<double> mean_nis(std::span<const Innovations> frames,
                               std::optional<double> Innovations::*part) {
  double sum = 0.0;
  int count = 0;
  for (const Innovations& frame : frames) {
    sum += (frame.*part).value_or(0.0);
    count += (frame.*part).has_value() ? 1 : 0;
  }
  return count > 0 ? std::optional<double>(sum / count) : std::nullopt;
}

std::size_t count_segments(std::span<const eval::ClaimedPose> claims) {
  std::set<int> segments;
  for (const eval::ClaimedPose& claim : claims) {
    if (claim.claim == eval::PoseClaim::kLocated) segments.insert(claim.segment);
  }
  return segments.size();
}

}  // namespace

Measurements measurements_of(const RunResult& result) {
  const OdometryRun& run = result.run;
  const std::optional<eval::MeanNees> nees = eval::mean_nees(result.gt, run.claims);
  return {.scored = ScoredTrajectory{.gt = result.gt, .est = run.trajectory, .score = result.score},
          .counts = RunCounts{.frames = run.summary.frames,
                              .poses = run.trajectory.poses.size(),
                              .resets = run.summary.resets,
                              .segments = count_segments(run.claims),
                              .frames_without_boxes = run.summary.detector_counters.unrecorded,
                              .wall_s = run.wall_s,
                              .claimed_three_sigma_m = eval::claimed_three_sigma_m(run.claims),
                              .nees = nees,
                              .nis_reprojection = mean_nis(run.innovations, &Innovations::reprojection),
                              .nis_inertial = mean_nis(run.innovations, &Innovations::inertial)},
          .imu_rate = result.imu_rate,
          .honesty = result.honesty,
          .loops = result.loops,
          .device = run.device};
}

namespace {

/// Stamps that match have one unit, and faults look like violations of most conventions.
std::vector<eval::ConventionFinding> conventions_of(const RunResult& result, bool has_faults) {
  using enum eval::Convention;
  const std::size_t pairs = result.score.ate ? result.score.ate->pairs : 0;
  std::vector<eval::ConventionFinding> findings =
      eval::find_convention_violations(result.gt, result.run.trajectory);
  std::erase_if(findings, [&](const eval::ConventionFinding& finding) {
    return (has_faults && finding.convention != kScale) || finding.convention == kSwappedArguments ||
           (finding.convention == kStampUnit && pairs > 0);
  });
  return findings;
}

/// The trajectory of this odometry follows all conventions, so apart from the scale it is the ground truth
/// that does not.
std::vector<std::string> truth_warnings(const RunResult& result) {
  std::vector<std::string> warnings;
  for (const eval::ConventionFinding& finding : result.conventions) {
    if (finding.convention == eval::Convention::kScale) {
      warnings.push_back("trajectory: " + finding.message);
    } else if (finding.convention != eval::Convention::kRepeatedPoses) {
      warnings.push_back("ground truth: compared with it, " + finding.message +
                         "; `stillpoint diagnose` tests the ground truth");
    }
  }
  if (std::string doubt = eval::sparse_truth_doubt(result.gt, result.score);
      warnings.empty() && !doubt.empty())
    warnings.push_back(std::move(doubt));
  return warnings;
}

}  // namespace

std::string error_doubt(std::span<const std::string> warnings) {
  std::string doubt;
  for (const std::string& text : warnings) {
    if (text.starts_with("trajectory: ") || text.starts_with("ground truth: ") || text.starts_with("fault: "))
      doubt += (doubt.empty() ? "" : "; ") + text;
  }
  return doubt;
}

RunResult score_run(const datasets::SequenceInfo& info, OdometryRun run,
                    std::span<const datasets::SensorFault> faults) {
  const std::size_t frames = std::min(run.summary.frames, info.frame_times.size());
  eval::ScoreOptions options;
  options.expected_times.assign(info.frame_times.begin(),
                                info.frame_times.begin() + static_cast<std::ptrdiff_t>(frames));
  RunResult result;
  result.sequence = info.name;
  result.outcome = outcome_of(run);
  result.failure = failure_of(run);
  result.notes = info.notes;
  result.warnings = warnings_of(info, run);
  result.gt = camera_truth(info, options.expected_times);
  result.score = eval::score(result.gt, run.trajectory, options);
  if (run.imu_rate) result.imu_rate = score_imu_rate(result.gt, *run.imu_rate, run.trajectory);
  if (run.loops) result.loops = score_loops(result.gt, run.trajectory, *run.loops);
  if (result.outcome != Outcome::kInterrupted) {
    for (std::string& warning : fault_warnings(faults, options.expected_times))
      result.warnings.push_back(std::move(warning));
  }
  if (!faults.empty())
    result.honesty = eval::honesty(result.gt, run.claims, fault_spans(faults, options.expected_times));
  result.run = std::move(run);
  result.conventions = conventions_of(result, !faults.empty());
  for (std::string& warning : truth_warnings(result)) result.warnings.push_back(std::move(warning));
  return result;
}

}  // namespace stillpoint::bench
