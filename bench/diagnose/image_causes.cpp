// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/image_causes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>

#include <fmt/format.h>

#include "datasets/sequence_plausibility.h"

namespace stillpoint::bench {
namespace {

constexpr double kUniformGray = 3.0;    ///< deviation of an image without content
constexpr double kUniformRatio = 0.1;   ///< same, to the mean: dark images keep their contrast
constexpr double kDarkened = 0.5;       ///< mean brightness, relative to the median of the frames
constexpr double kMostClipped = 0.3;    ///< fraction of black or white pixels
constexpr double kExposureStep = 0.12;  ///< change of the logarithm of the brightness between two frames
constexpr double kBlurred = 0.6;        ///< sharpness, relative to the median of the frames
constexpr double kLeastDepth = 0.05;    ///< fraction of pixels of a frame with depth
constexpr double kLostDepth = 0.6;      ///< fraction with depth, relative to the median of the frames
constexpr double kFewDepth = 0.35;      ///< median fraction of pixels with depth
constexpr double kGapIntervals = 1.5;   ///< a longer interval lacks a frame
constexpr double kMissingRatio = 0.01;  ///< of all frames
constexpr std::size_t kLeastConcerned = 3;
constexpr double kAlignmentSigmas = 4.0;  ///< significance of depth of another frame or place
constexpr int kLeastShift_px = 2;         ///< edges of depth are not sharper

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_of(const RecordingSurvey& survey, double FrameStatistics::*value) {
  std::vector<double> values;
  values.reserve(survey.frames.size());
  for (const FrameStatistics& frame : survey.frames) values.push_back(frame.*value);
  return median(std::move(values));
}

/// Collects causes that concern single frames.
class FrameCauses {
 public:
  explicit FrameCauses(const RecordingSurvey& survey) : survey_(survey) {}

  /// Adds the cause with the times of the frames concerned, if they are enough.
  /// @param cause its evidence continues "N of M frames"
  void add(Cause cause, const std::function<bool(std::size_t)>& concerned) {
    for (std::size_t i = 0; i < survey_.frames.size(); ++i) {
      if (concerned(i)) cause.times.push_back(survey_.frames[i].t);
    }
    if (cause.times.size() < kLeastConcerned) return;
    const auto count = static_cast<double>(cause.times.size());
    cause.basis = CauseBasis::kShown;
    cause.strength = 10.0 * count / static_cast<double>(survey_.frames.size());
    cause.evidence = fmt::format("{} of {} frames {}", count, survey_.frames.size(), cause.evidence);
    causes_.push_back(std::move(cause));
  }
  [[nodiscard]] std::vector<Cause> take() { return std::move(causes_); }

 private:
  const RecordingSurvey& survey_;
  std::vector<Cause> causes_;
};

std::vector<Cause> content_causes(const RecordingSurvey& survey) {
  const auto& frames = survey.frames;
  const double gray = median_of(survey, &FrameStatistics::mean_gray);
  const auto is_uniform = [&](std::size_t i) {
    return frames[i].deviation_gray < kUniformGray &&
           frames[i].deviation_gray <= kUniformRatio * frames[i].mean_gray;
  };
  const auto is_clipped_or_dark = [&](std::size_t i) {
    const FrameStatistics& frame = frames[i];
    return !is_uniform(i) && (frame.mean_gray < kDarkened * gray || frame.dark_ratio > kMostClipped ||
                              frame.bright_ratio > kMostClipped);
  };
  std::vector<double> exposed;  // a dark image is coarser in gray, and looks sharper relative to its contrast
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_uniform(i) && !is_clipped_or_dark(i)) exposed.push_back(frames[i].sharpness);
  }
  const double sharpness = median(std::move(exposed));
  FrameCauses causes(survey);
  causes.add({.id = "blank",
              .name = "blank images",
              .evidence = "are of one gray level",
              .remedy = "check camera and exposure control; leave the frames out"},
             is_uniform);
  causes.add({.id = "frozen",
              .name = "repeated images",
              .evidence = "equal the one before",
              .remedy = "leave the repeated frames out"},
             [&](std::size_t i) { return frames[i].same_image && !is_uniform(i); });
  causes.add({.id = "exposure",
              .name = "images too dark or too bright",
              .evidence = "are clipped or have half of the usual brightness",
              .remedy = "fix exposure and gain of the camera, or light the scene"},
             is_clipped_or_dark);
  causes.add({.id = "exposure_steps",
              .name = "exposure changes",
              .evidence = "differ in brightness by more than 12 % from the one before",
              .remedy = "fix exposure and gain of the camera"},
             [&](std::size_t i) {
               return i > 0 && !is_uniform(i) && !is_uniform(i - 1) &&
                      std::abs(std::log(frames[i].mean_gray / frames[i - 1].mean_gray)) > kExposureStep;
             });
  causes.add({.id = "blur",
              .name = "blurred images",
              .evidence = "are blurred",
              .remedy = "shorten the exposure, add light, or move more slowly"},
             [&](std::size_t i) {
               return !is_uniform(i) && !is_clipped_or_dark(i) && frames[i].sharpness < kBlurred * sharpness;
             });
  std::vector<Cause> found = causes.take();
  // Frames of a wrong exposure between its steps are the consequence of these.
  const auto steps = std::ranges::find(found, "exposure_steps", &Cause::id);
  const auto wrong = std::ranges::find(found, "exposure", &Cause::id);
  if (steps != found.end() && wrong != found.end())
    wrong->strength = std::min(wrong->strength, 0.5 * steps->strength);
  return found;
}

std::vector<Cause> depth_causes(const RecordingSurvey& survey) {
  const auto& frames = survey.frames;
  const double ratio = median_of(survey, &FrameStatistics::depth_ratio);
  if (ratio == 0.0) return {};
  const double least = std::max(kFewDepth, kLostDepth * ratio);
  FrameCauses causes(survey);
  const auto is_missing = [&](std::size_t i) { return frames[i].depth_ratio < kLeastDepth; };
  causes.add({.id = "depth_missing",
              .name = "depth missing",
              .evidence = "have no depth",
              .remedy = "check range and exposure of the depth camera"},
             is_missing);
  causes.add({.id = "depth_holes",
              .name = "holes in depth",
              .evidence = fmt::format("have depth in less than {:.0f} % of the pixels", 100.0 * least),
              .remedy = "check range, exposure and emitter of the depth camera"},
             [&](std::size_t i) { return !is_missing(i) && frames[i].depth_ratio < least; });
  causes.add({.id = "depth_frozen",
              .name = "repeated depth",
              .evidence = "have the depth of the one before",
              .remedy = "record depth at the rate of the color images"},
             [&](std::size_t i) { return frames[i].same_depth && !frames[i].same_image && !is_missing(i); });
  return causes.take();
}

/// Measured depth that no RGB-D camera has: see ImagePlausibility::depth_unit_finding.
std::vector<Cause> depth_range_causes(const RecordingSurvey& survey, double units_per_m) {
  constexpr double kUnits = 5.0;
  std::vector<double> depths_m;
  for (const FrameStatistics& frame : survey.frames) {
    for (const std::uint16_t raw : frame.depth) {
      if (raw != 0) depths_m.push_back(raw / units_per_m);
    }
  }
  if (depths_m.empty()) return {};
  std::ranges::sort(depths_m);
  const double near_m = depths_m[depths_m.size() / 20], far_m = depths_m[depths_m.size() * 19 / 20];
  if (near_m >= datasets::kLeastDepth_m && far_m <= datasets::kLargestDepth_m) return {};
  const double factor = far_m > datasets::kLargestDepth_m ? 1.0 / kUnits : kUnits;
  return {{.id = "depth_unit",
           .name = "unit of depth",
           .evidence = fmt::format("90 % of the measurements are from {:.2f} to {:.2f} m", near_m, far_m),
           .remedy = fmt::format("[depth] scale = {:g} in rig.toml", units_per_m / factor),
           .strength = kFundamental,
           .correction = Correction{.depth_factor = factor}}};
}

/// By images that the true motion moves over each other.
std::vector<Cause> depth_unit_by_truth(const RecordingSurvey& survey, double units_per_m) {
  if (!survey.depth_scale) return {};
  const auto [factor, pairs, all_pairs] = *survey.depth_scale;
  return {{.id = "depth_unit",
           .name = "unit of depth",
           .evidence = fmt::format(
               "images follow the motion of the ground truth with {:g} times the depth ({} of {} pairs)",
               factor, pairs, all_pairs),
           .remedy = fmt::format("[depth] scale = {:g} in rig.toml", units_per_m / factor),
           .strength = kFundamental,
           .correction = Correction{.depth_factor = factor}}};
}

std::vector<double> intervals_of(const std::vector<Timestamp>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(seconds_between(times[i - 1], times[i]));
  return intervals;
}

std::vector<Cause> dropped_frames(const std::vector<Timestamp>& times) {
  const std::vector<double> intervals = intervals_of(times);
  const double typical = median(intervals);
  Cause cause{
      .id = "dropped", .name = "frames missing", .remedy = "record to a faster disk, or at a lower rate"};
  double missing = 0.0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i] < kGapIntervals * typical) continue;
    missing += std::round(intervals[i] / typical) - 1.0;
    cause.times.push_back(times[i + 1]);
  }
  const double ratio = missing / (missing + static_cast<double>(times.size()));
  if (ratio < kMissingRatio) return {};
  cause.evidence =
      fmt::format("{:.0f} of {:.0f} frames, the longest gap is {:.2f} s", missing,
                  missing + static_cast<double>(times.size()), *std::ranges::max_element(intervals));
  cause.basis = CauseBasis::kShown;
  cause.strength = 10.0 * ratio;
  return {cause};
}

/// Stamps that are multiples of 5 ms or more, at a rate that these do not divide: they get those of a
/// constant rate.
std::vector<Cause> rounded_stamps(const std::vector<Timestamp>& times) {
  constexpr std::int64_t kUnits_ns[] = {1'000'000'000, 100'000'000, 50'000'000,
                                        20'000'000,    10'000'000,  5'000'000};
  const std::vector<double> intervals = intervals_of(times);
  const auto [shortest, longest] = std::ranges::minmax(intervals);
  for (const std::int64_t unit_ns : kUnits_ns) {
    const bool rounded =
        std::ranges::all_of(times, [&](Timestamp t) { return (t.ns - times.front().ns) % unit_ns == 0; });
    if (!rounded || longest - shortest < 0.5e-9 * static_cast<double>(unit_ns)) continue;
    const double interval_s =
        seconds_between(times.front(), times.back()) / static_cast<double>(times.size() - 1);
    return {{.id = "stamps_rounded",
             .name = "stamps of images rounded",
             .evidence = fmt::format("all are multiples of {} ms, the mean interval is {:.2f} ms",
                                     unit_ns / 1'000'000, 1e3 * interval_s),
             .remedy = "write stamps with at least four decimals",
             .strength = 100.0,
             .correction = Correction{.change =
                                          [interval_s](auto& changed) {
                                            const Timestamp first = changed.frame_times.front();
                                            for (std::size_t i = 0; i < changed.frame_times.size(); ++i)
                                              changed.frame_times[i] =
                                                  after(first, static_cast<double>(i) * interval_s);
                                          }},
             .basis = CauseBasis::kShown}};
  }
  return {};
}

}  // namespace

std::vector<Cause> image_causes(const datasets::SequenceInfo& info, const RecordingSurvey& survey) {
  std::vector<Cause> causes;
  if (survey.frames.size() < 10) return causes;
  for (const auto& more :
       {content_causes(survey), depth_causes(survey), depth_range_causes(survey, info.rig.depth_units_per_m),
        depth_unit_by_truth(survey, info.rig.depth_units_per_m), dropped_frames(info.frame_times),
        rounded_stamps(info.frame_times)})
    causes.insert(causes.end(), more.begin(), more.end());
  return causes;
}

std::vector<Cause> alignment_causes(const DepthAlignment& alignment) {
  const auto evidence = [&](double gain, double sigmas) {
    return fmt::format(
        "edges of gray images and depth coincide {:.0f} % better with it ({:.0f} sigma, {} images)",
        100.0 * gain, sigmas, alignment.images);
  };
  std::vector<Cause> causes;
  if (alignment.delay != 0 && alignment.delay_sigmas > kAlignmentSigmas)
    causes.push_back(
        {.id = "depth_late",
         .name = fmt::format("depth {} frame(s) {}", std::abs(alignment.delay),
                             alignment.delay > 0 ? "late" : "early"),
         .evidence = evidence(alignment.delay_gain, alignment.delay_sigmas),
         .remedy = fmt::format("associate each image with the depth {} frame(s) {}",
                               std::abs(alignment.delay), alignment.delay > 0 ? "later" : "earlier"),
         .strength = alignment.delay_sigmas,
         .correction = Correction{.depth_delay = alignment.delay}});
  if (alignment.shift_px.cwiseAbs().maxCoeff() >= kLeastShift_px && alignment.shift_sigmas > kAlignmentSigmas)
    causes.push_back(
        {.id = "depth_unregistered",
         .name = "depth not registered to the images",
         .evidence = fmt::format("moved by ({}, {}) px, ", -alignment.shift_px.x(), -alignment.shift_px.y()) +
                     evidence(alignment.shift_gain, alignment.shift_sigmas),
         .remedy = "register depth with the calibration of both cameras: [depth] with T_c_d in "
                   "rig.toml, from `stillpoint calibrate SEQ --depth-camera`",
         .strength = alignment.shift_sigmas,
         .correction = Correction{.depth_shift_px = alignment.shift_px}});
  return causes;
}

}  // namespace stillpoint::bench
