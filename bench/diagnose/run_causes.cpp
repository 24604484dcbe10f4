// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/run_causes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/run/rig_report.h"

namespace stillpoint::bench {
namespace {

constexpr double kNoisier = 3.0;       ///< ratio of the noise of the IMU to the stated densities
constexpr double kFewFeatures = 50.0;  ///< mean number of tracked features
constexpr double kManyDynamic = 0.1;   ///< fraction of the features, without boxes
constexpr double kSamePlace = 0.3;     ///< intersection over union of boxes of a person in successive frames
constexpr double kFlickering = 0.3;    ///< fraction of boxes that successive frames do not have
constexpr double kBoxedRatio = 0.02;   ///< mean fraction of the image in boxes, below which they do nothing

std::string difference_text(const RigFinding& finding) {
  return fmt::format("the run differs from the stated value by {:+.3g} ({:.0f} sigma)", finding.difference,
                     std::abs(finding.difference) / finding.sigma);
}

/// Less than that of comparisons without the estimator, which other faults mislead.
double rig_strength(const RigFinding& finding) {
  return std::min(100.0, std::abs(finding.difference) / finding.sigma);
}

/// What a finding of the rig report changes.
struct RigChange {
  std::string prefix;  ///< of the parameter's name
  std::string id, name;
  std::function<void(Rig&)> apply;
  std::string entry;  ///< of rig.toml
};

std::vector<RigChange> rig_changes(const EstimatedCalibration& c) {
  Rig corrected = c.rig;
  const double focal = 1.0 - c.lens[0];
  const auto lens = [c, focal](Rig& rig) {
    rig.camera.cx -= rig.camera.fx * c.lens[2];
    rig.camera.cy -= rig.camera.fy * c.lens[3];
    rig.camera.fx *= focal;
    rig.camera.fy *= focal;
    rig.camera.distortion[0] -= c.lens[1];
  };
  lens(corrected);
  const Camera& camera = corrected.camera;
  const std::string lens_entry = fmt::format(
      "[camera] fx = {:.2f}, fy = {:.2f}, cx = {:.2f}, cy = {:.2f}, distortion = [{:.4g}] in rig.toml, or "
      "`stillpoint calibrate`",
      camera.fx, camera.fy, camera.cx, camera.cy, fmt::join(camera.coefficients(), ", "));
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = c.T_b_c.matrix();
  return {
      {"depth scale", "depth_scale", "scale of depth", {}, ""},
      {"focal", "focal", "focal length", lens, lens_entry},
      {"k1", "distortion", "distortion", lens, lens_entry},
      {"center x", "center", "principal point", lens, lens_entry},
      {"center y", "center", "principal point", lens, lens_entry},
      {"time offset", "time_offset", "clocks of camera and IMU offset",
       [c](Rig& rig) { rig.time_offset_s = c.time_offset_s; },
       fmt::format("[imu] time_offset_s = {:.4f} in rig.toml", c.time_offset_s)},
      {"camera rotation", "extrinsics_rotation", "camera rotation on the body",
       [c](Rig& rig) { rig.T_b_c = c.T_b_c; },
       fmt::format("[imu] T_b_c = [{:.5g}] in rig.toml", fmt::join(rows.data(), rows.data() + 16, ", "))}};
}

/// The entry about depth needs the factor of the depth, which is no entry of the rig alone.
Cause depth_scale_cause(const EstimatedCalibration& c, const RigFinding& finding) {
  return {
      .id = "depth_scale",
      .name = "scale of depth",
      .evidence = difference_text(finding) + " %",
      .remedy = fmt::format("[depth] scale = {:.1f} in rig.toml", c.rig.depth_units_per_m * c.depth_scale),
      .strength = rig_strength(finding),
      .correction = Correction{.depth_factor = 1.0 / c.depth_scale},
      .basis = CauseBasis::kInferred};
}

/// The most significant finding of each id.
std::vector<Cause> rig_causes(const EstimatedCalibration& calibration) {
  std::vector<Cause> causes;
  const std::vector<RigChange> changes = rig_changes(calibration);
  for (const RigFinding& finding : rig_report(calibration)) {
    if (finding.result != RigResult::kDiffers) continue;
    const auto change = std::ranges::find_if(
        changes, [&](const RigChange& entry) { return finding.parameter.starts_with(entry.prefix); });
    if (change == changes.end()) continue;
    Cause cause;
    if (change->id == "depth_scale") {
      cause = depth_scale_cause(calibration, finding);
    } else {
      cause = {.id = change->id,
               .name = change->name,
               .evidence = finding.parameter + ": " + difference_text(finding),
               .remedy = change->entry,
               .strength = rig_strength(finding),
               .correction = Correction{.change = [apply = change->apply](auto& info) { apply(info.rig); }},
               .basis = CauseBasis::kInferred};
    }
    const auto known = std::ranges::find(causes, cause.id, &Cause::id);
    if (known == causes.end()) {
      causes.push_back(cause);
    } else if (known->strength < cause.strength) {
      *known = cause;
    }
  }
  return causes;
}

/// By how much the errors of the inertial prediction exceed the noise that it was used with: the root of the
/// median of its normalized innovation squared, at least 1.
double excess_of_innovations(const OdometryRun& run) {
  std::vector<double> squares;
  for (const Innovations& frame : run.innovations) {
    if (frame.inertial) squares.push_back(*frame.inertial);
  }
  if (squares.empty()) return 1.0;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::ranges::nth_element(squares, middle);
  return std::max(1.0, std::sqrt(*middle));
}

std::vector<Cause> noise_causes(const OdometryRun& run, const datasets::SequenceInfo& info) {
  const double excess = excess_of_innovations(run);
  const ImuNoiseFactors factors{.gyro = excess * run.imu_noise.gyro, .accel = excess * run.imu_noise.accel};
  const double largest = std::max(factors.gyro, factors.accel);
  if (info.imu.empty() || largest < kNoisier) return {};
  ImuNoise noise = info.rig.imu_noise;
  noise.gyro_noise *= factors.gyro;
  noise.accel_noise *= factors.accel;
  return {{.id = "imu_noise",
           .name = "IMU noisier than stated",
           .evidence =
               fmt::format("its errors are {:.1f} (gyroscope) and {:.1f} (accelerometer) times the stated "
                           "densities: noise, vibration, scale, axes",
                           factors.gyro, factors.accel),
           .remedy = fmt::format("[imu] gyro_noise = {:.2g}, accel_noise = {:.2g} in rig.toml",
                                 noise.gyro_noise, noise.accel_noise),
           .strength = 1.0,  // any fault looks like noise, so it is measured late
           .correction = Correction{.change = [noise](auto& changed) { changed.rig.imu_noise = noise; }},
           .basis = CauseBasis::kInferred}};
}

constexpr double kBoxesHarm = 0.5;  ///< which features small boxes hide changes small errors by chance

/// The set of a frame, or null.
const DetectionSet* set_at(const datasets::SequenceInfo& info, Timestamp t) {
  const Timestamp earliest = after(t, -kMaxDetectionOffset_s);
  const auto found = std::ranges::lower_bound(info.detections, earliest, {}, &DetectionSet::t);
  return found != info.detections.end() && found->t <= after(t, kMaxDetectionOffset_s) ? &*found : nullptr;
}

double boxed_ratio(const datasets::SequenceInfo& info, const DetectionSet& set) {
  const double width = info.rig.camera.width, height = info.rig.camera.height;
  double area = 0.0;
  for (const Detection& detection : set.detections) {
    const Box& box = detection.box;
    area += std::max(0.0, std::min(box.x_max, width) - std::max(box.x_min, 0.0)) *
            std::max(0.0, std::min(box.y_max, height) - std::max(box.y_min, 0.0));
  }
  return std::min(1.0, area / (width * height));
}

/// Number of boxes of a frame that neither frame beside it has: people do not appear for one frame.
std::ptrdiff_t single_boxes(const datasets::SequenceInfo& info, std::size_t i, const DetectionSet& set) {
  std::vector<Box> beside;
  for (const std::size_t k : {i - 1, i + 1}) {
    const DetectionSet* const other =
        k < info.frame_times.size() ? set_at(info, info.frame_times[k]) : nullptr;
    if (other == nullptr) continue;
    for (const Detection& detection : other->detections) beside.push_back(detection.box);
  }
  return std::ranges::count_if(set.detections, [&](const Detection& detection) {
    return std::ranges::none_of(
        beside, [&](const Box& box) { return intersection_over_union(detection.box, box) > kSamePlace; });
  });
}

std::vector<Cause> box_causes(const datasets::SequenceInfo& info) {
  if (info.detections.empty()) return {};
  std::vector<Cause> causes;
  Cause missing{.id = "boxes_missing",
                .name = "boxes missing",
                .remedy = "`stillpoint detect SEQ --out SEQ/detections.txt`, with all frames",
                .basis = CauseBasis::kShown};
  double boxed = 0.0, boxes = 0.0, single = 0.0;
  for (std::size_t i = 0; i < info.frame_times.size(); ++i) {
    const Timestamp t = info.frame_times[i];
    const DetectionSet* const set = set_at(info, t);
    if (set == nullptr || set->state != DetectionState::kPresent) {
      missing.times.push_back(t);
      continue;
    }
    boxed += boxed_ratio(info, *set);
    boxes += static_cast<double>(set->detections.size());
    single += static_cast<double>(single_boxes(info, i, *set));
  }
  const bool flickers = single > kFlickering * boxes;
  const double frames = static_cast<double>(info.frame_times.size());
  if (static_cast<double>(missing.times.size()) > 0.03 * frames) {
    missing.evidence = fmt::format("{} of {:.0f} frames have none", missing.times.size(), frames);
    missing.strength = 10.0 * static_cast<double>(missing.times.size()) / frames;
    causes.push_back(missing);
  }
  if (boxed > kBoxedRatio * frames) {
    causes.push_back({.id = "boxes",
                      .name = "recorded boxes",
                      .evidence = fmt::format("{:.1f} boxes per frame on {:.0f} % of the image, {:.0f} % of "
                                              "them with none at their place in the frames beside it",
                                              boxes / frames, 100.0 * boxed / frames, 100.0 * single / boxes),
                      .remedy = "--set detector.kind=none, or another network for `stillpoint detect`",
                      .strength = boxed / frames,
                      .correction = Correction{.settings = {"detector.kind=none"}},
                      .basis = flickers ? CauseBasis::kShown : CauseBasis::kInferred,
                      .needs_effect = !flickers,
                      .largest_ratio = kBoxesHarm});
  }
  return causes;
}

std::vector<Cause> feature_causes(const OdometryRun& run, const datasets::SequenceInfo& info) {
  std::vector<Cause> causes;
  if (run.frame_counters.empty()) return causes;
  double tracked = 0.0, dynamic = 0.0;
  for (const FrameCounters& frame : run.frame_counters) {
    tracked += static_cast<double>(frame.tracked_features);
    dynamic += static_cast<double>(frame.dynamic_features);
  }
  const double frames = static_cast<double>(run.frame_counters.size());
  if (tracked / frames < kFewFeatures)
    causes.push_back({.id = "texture",
                      .name = "few features",
                      .evidence = fmt::format("{:.0f} per frame in the mean", tracked / frames),
                      .remedy = "aim at textured, lit surfaces; check focus and exposure",
                      .strength = kFewFeatures * frames / std::max(1.0, tracked),
                      .basis = CauseBasis::kShown});
  if (info.detections.empty() && dynamic > kManyDynamic * tracked)
    causes.push_back({.id = "boxes_missing",
                      .name = "boxes missing",
                      .evidence = fmt::format("{:.0f} % of the features move, and there are no boxes",
                                              100.0 * dynamic / tracked),
                      .remedy = "`stillpoint detect SEQ --out SEQ/detections.txt`",
                      .strength = dynamic / tracked,
                      .basis = CauseBasis::kInferred});
  return causes;
}

}  // namespace

bool observes_center(const EstimatedCalibration& calibration) {
  return std::ranges::any_of(rig_report(calibration), [](const RigFinding& finding) {
    return finding.parameter.starts_with("center") && finding.result != RigResult::kNotObserved;
  });
}

std::vector<Cause> run_causes(const OdometryRun& run, const datasets::SequenceInfo& info) {
  std::vector<Cause> causes;
  for (const auto& more :
       {rig_causes(run.calibration), noise_causes(run, info), box_causes(info), feature_causes(run, info)})
    causes.insert(causes.end(), more.begin(), more.end());
  return causes;
}

}  // namespace stillpoint::bench
