// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_scores.h"

#include <algorithm>

#include "eval/metrics/loop_metrics.h"
#include "eval/metrics/rpe.h"
#include "eval/metrics/statistics.h"
#include "eval/score.h"

namespace stillpoint::bench {
namespace {

constexpr double kMaxDrift_px = 4.0;

std::optional<Pose> true_T_w_c(const datasets::GroundTruth& truth, Timestamp t) {
  const std::vector<StampedPose>& poses = truth.trajectory.poses;
  const auto later = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (later == poses.end()) return std::nullopt;
  const Pose T_f_c = truth.T_c_f.inverse();
  if (later->t == t) return later->T_w_f * T_f_c;
  if (later == poses.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(later);
  const double ratio = seconds_between(before.t, t) / seconds_between(before.t, later->t);
  return interpolate(before.T_w_f, later->T_w_f, ratio) * T_f_c;
}

}  // namespace

bool DriftedTracks::exceeds_drift(const Eigen::Vector3d& p_w, const Observation& observation) const {
  const Eigen::Vector3d p_c = observation.T_w_c.inverse() * p_w;
  return p_c.z() > 0.0 && (info_.rig.camera.project(p_c) - observation.pixel).norm() > kMaxDrift_px;
}

void DriftedTracks::add(const TrackedFrame& frame) {
  std::map<std::int64_t, Track> updated;
  const std::optional<Pose> T_w_c = true_T_w_c(info_.ground_truth, frame.t);
  for (const TrackedFeature& feature : frame.features) {
    if (!T_w_c) break;
    const Observation now{.T_w_c = *T_w_c, .pixel = feature.pixel};
    const auto known = tracks_.find(feature.id);
    Track track = known != tracks_.end() ? known->second : Track{.first = now};
    if (!track.p_w && feature.depth > 0.0) {
      track.p_w = *T_w_c * Eigen::Vector3d(feature.depth * feature.bearing.homogeneous());
    }
    track.drifted = track.p_w && (exceeds_drift(*track.p_w, now) || exceeds_drift(*track.p_w, track.first));
    updated.emplace(feature.id, track);
  }
  tracks_ = std::move(updated);
}

bool DriftedTracks::contains(std::int64_t id) const {
  const auto track = tracks_.find(id);
  return track != tracks_.end() && track->second.drifted;
}

namespace {

/// A pixel is on an outline if the square of this half side around it contains several objects.
constexpr int kOutlineMargin_px = 3;

/// Slower objects are at rest.
constexpr int kMinMovingSpeed_cm_per_s = 5;

struct LabelAtPixel {
  int object = 0;
  int speed_cm_per_s = 0;
};

/// Ground-truth label at a feature; nothing on an outline.
std::optional<LabelAtPixel> label_at(const Eigen::Vector2d& pixel, const datasets::MotionLabels& labels) {
  const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
  const cv::Rect image(0, 0, labels.object.cols, labels.object.rows);
  if (!image.contains(at)) return std::nullopt;
  const int object = labels.object.at<std::uint8_t>(at);
  const int side = 2 * kOutlineMargin_px + 1;
  const cv::Mat around =
      labels.object(cv::Rect(at.x - kOutlineMargin_px, at.y - kOutlineMargin_px, side, side) & image);
  const bool same = std::all_of(around.begin<std::uint8_t>(), around.end<std::uint8_t>(),
                                [object](std::uint8_t other) { return other == object; });
  if (!same) return std::nullopt;
  return LabelAtPixel{object, labels.speed_cm_per_s.at<std::uint8_t>(at)};
}

}  // namespace

std::optional<double> LabelScore::precision() const {
  const std::int64_t correct = people.flagged + undetectable_objects.flagged;
  return Group{.all = correct + background.flagged, .flagged = correct}.flagged_ratio();
}

void LabelScore::add(std::span<const TrackedFeature> features, std::span<const DynamicLabel> labels,
                     const datasets::MotionLabels& truth, const DriftedTracks& drifted) {
  auto label = labels.begin();
  for (const TrackedFeature& feature : features) {
    while (label != labels.end() && label->id < feature.id) ++label;
    if (label == labels.end()) return;
    if (label->id != feature.id || feature.age < 2) continue;
    const std::optional<LabelAtPixel> actual = label_at(feature.pixel, truth);
    if (!actual) continue;
    const bool undetectable = actual->object >= datasets::kFirstUndetectableObject;
    if (undetectable && actual->speed_cm_per_s < kMinMovingSpeed_cm_per_s) continue;
    if (actual->object == 0 && drifted.contains(feature.id)) continue;
    Group& group = undetectable ? undetectable_objects : actual->object > 0 ? people : background;
    ++group.all;
    group.flagged += label->label != LabelClass::kStable;
  }
}

namespace {

/// Correction of the output at a time.
struct Correction {
  Timestamp t;
  Pose T_m_w;
};

/// Of the located keyframes of a segment. The output at the time of a keyframe was not yet that of its final
/// pose by the odometry, which the window refined afterwards: the difference is corrected, too.
std::vector<Correction> corrections_of(const Trajectory& odometry, const LoopReport& report, int segment) {
  std::vector<Correction> corrections;
  for (const MapKeyframe& keyframe : report.keyframes) {
    if (keyframe.segment != segment || (segment > 0 && !keyframe.is_located)) continue;
    corrections.push_back({keyframe.t, keyframe.T_m_b * keyframe.T_w_b.inverse()});
    const auto output = std::ranges::lower_bound(odometry.poses, keyframe.t, {}, &StampedPose::t);
    const bool has_output = output != odometry.poses.end() && output->t == keyframe.t;
    if (has_output) corrections.back().T_m_w = keyframe.T_m_b * keyframe.T_b_c * output->T_w_f.inverse();
  }
  return corrections;
}

Pose corrected(const StampedPose& pose, std::span<const Correction> corrections) {
  const auto next = std::ranges::upper_bound(corrections, pose.t, {}, &Correction::t);
  const auto before = next == corrections.begin() ? next : next - 1;
  Pose by_before = before->T_m_w * pose.T_w_f;
  if (next == corrections.end() || next == before) return by_before;
  const double s = seconds_between(before->t, pose.t) / seconds_between(before->t, next->t);
  return interpolate(by_before, next->T_m_w * pose.T_w_f, s);
}

eval::RevisitScore revisits_of(const Trajectory& gt, const LoopReport& report) {
  std::vector<Timestamp> keyframes;
  for (const MapKeyframe& keyframe : report.keyframes) keyframes.push_back(keyframe.t);
  std::vector<eval::ReportedLoop> loops;
  for (const LoopRecord& loop : report.loops) {
    if (loop.in_map) continue;  // its true pose is that of another run
    loops.push_back({loop.query_t, loop.match_t, loop.T_match_query, loop.outcome == LoopOutcome::kAccepted});
  }
  return eval::score_revisits(gt, keyframes, loops);
}

/// ATE of the poses from `begin` on [m].
std::optional<double> ate_m(const Trajectory& gt, Trajectory trajectory,
                            Timestamp begin = Timestamp{INT64_MIN}) {
  std::erase_if(trajectory.poses, [&](const StampedPose& pose) { return pose.t < begin; });
  if (gt.poses.empty() || trajectory.poses.empty()) return std::nullopt;
  const eval::Score score = eval::score(gt, trajectory, {});
  return score.ate ? std::optional<double>(score.ate->translation_m.rmse) : std::nullopt;
}

/// Nothing without an accepted loop, or with a loaded map, whose world differs from that of the odometry.
std::optional<eval::ErrorAfterLoop> error_after_first_loop(const Trajectory& gt, const Trajectory& odometry,
                                                           const LoopRun& run) {
  if (run.has_map) return std::nullopt;
  const auto first =
      std::ranges::find(run.report.loops, LoopOutcome::kAccepted, &LoopRecord::outcome);  // by query
  if (first == run.report.loops.end()) return std::nullopt;
  return eval::error_after_loop(gt, odometry, run.causal, first->query_t);
}

}  // namespace

Trajectory optimized_trajectory(std::span<const Trajectory> odometry, const LoopReport& report) {
  Trajectory result;
  for (std::size_t segment = 0; segment < odometry.size(); ++segment) {
    const Trajectory& part = odometry[segment];
    result.frame = part.frame;
    const std::vector<Correction> corrections = corrections_of(part, report, static_cast<int>(segment));
    if (corrections.empty() && segment > 0) continue;
    for (const StampedPose& pose : part.poses)
      result.poses.push_back({pose.t, corrections.empty() ? pose.T_w_f : corrected(pose, corrections)});
  }
  return result;
}

LoopScore score_loops(const Trajectory& gt, const Trajectory& odometry, const LoopRun& run) {
  LoopScore score;
  score.optimized_ate_m = ate_m(gt, run.optimized);
  score.causal_ate_m = ate_m(gt, run.causal);
  score.after_first = error_after_first_loop(gt, odometry, run);
  if (run.has_map && !run.causal.poses.empty()) {
    score.relocalization_s = seconds_between(run.optimized.poses.front().t, run.causal.poses.front().t);
  }
  score.keyframes = run.report.keyframes.size();
  score.candidates = run.report.loops.size();
  score.loops = static_cast<std::size_t>(
      std::ranges::count(run.report.loops, LoopOutcome::kAccepted, &LoopRecord::outcome));
  std::vector<double> times_ms;
  for (const MapKeyframe& keyframe : run.report.keyframes) times_ms.push_back(keyframe.cost.processing_ms);
  score.median_ms = eval::percentile(times_ms, 0.5);
  if (!gt.poses.empty()) score.revisits = revisits_of(gt, run.report);
  return score;
}

namespace {

constexpr double kShort_s = 0.1;

std::optional<eval::StrictRpe> rpe_over(const Trajectory& gt, const Trajectory& est, double delta_s) {
  return eval::strict_rpe(eval::strict_matches(gt, est), delta_s).errors;
}

std::vector<double> collect(const std::vector<PoseCorrection>& corrections, double PoseCorrection::*member) {
  std::vector<double> values;
  values.reserve(corrections.size());
  for (const PoseCorrection& correction : corrections) values.push_back(correction.*member);
  return values;
}

}  // namespace

ImuRateScore score_imu_rate(const Trajectory& gt, const ImuRateOutput& output, const Trajectory& frame_rate) {
  constexpr double kHigh = 0.95;
  const std::vector<double> steps_m = collect(output.corrections, &PoseCorrection::translation_m);
  ImuRateScore score;
  if (const std::optional<eval::AteResult> ate = eval::ate(gt, output.trajectory))
    score.ate_m = ate->translation_m.rmse;
  if (const auto rpe = rpe_over(gt, output.trajectory, kShort_s)) {
    score.rpe_100ms_m = rpe->translation_m.rmse;
    score.rpe_100ms_deg = rpe->rotation_deg.rmse;
  }
  if (const auto rpe = rpe_over(gt, output.trajectory, 1.0)) {
    score.rpe_m_per_s = rpe->translation_m.rmse;
    score.rpe_deg_per_s = rpe->rotation_deg.rmse;
  }
  if (const auto rpe = rpe_over(gt, frame_rate, kShort_s)) {
    score.frame_rate_rpe_100ms_m = rpe->translation_m.rmse;
    score.frame_rate_rpe_100ms_deg = rpe->rotation_deg.rmse;
  }
  score.step_p95_m = eval::percentile(steps_m, kHigh);
  score.step_max_m = eval::percentile(steps_m, 1.0);
  score.step_p95_deg = eval::percentile(collect(output.corrections, &PoseCorrection::rotation_deg), kHigh);
  score.age_p95_ms = eval::percentile(output.ages_ms, kHigh);
  return score;
}

}  // namespace stillpoint::bench
