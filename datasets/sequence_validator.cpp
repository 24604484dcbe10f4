// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_validator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "datasets/gyro_check.h"
#include "datasets/read_sequence.h"
#include "datasets/sequence_plausibility.h"

namespace stillpoint::datasets {
namespace {

constexpr double kGapIntervals = 2.5;       ///< an interval longer than this many median intervals is a gap
constexpr double kMaxDepthOffset_s = 0.01;  ///< of the median; beyond, color and depth disagree during motion
constexpr double kMinTruthCoverage = 0.95;  ///< fraction of the images that ground truth should cover
constexpr double kMaxTruthDistance_s = 0.1;   ///< an image further in time from any true pose is not covered
constexpr std::size_t kMaxFindingsShown = 5;  ///< per kind

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Splits a message, e.g. of an InputError, at its first ": " into location and text.
Finding parse_finding(const std::string& message, Severity severity) {
  const std::size_t colon = message.find(": ");
  if (colon == std::string::npos) return {.severity = severity, .location = {}, .text = message};
  return {.severity = severity, .location = message.substr(0, colon), .text = message.substr(colon + 2)};
}

Finding warning(const std::string& location, const std::string& text) {
  return {.severity = Severity::kWarning, .location = location, .text = text};
}

template <class Item>
void append(std::vector<Item>& all, const std::vector<Item>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// `report` with the results of one check, which are in `part`.
CheckReport joined(CheckReport report, const CheckReport& part) {
  append(report.streams, part.streams);
  append(report.notes, part.notes);
  append(report.findings, part.findings);
  if (part.depth_offset_s != 0.0) report.depth_offset_s = part.depth_offset_s;
  return report;
}

/// The summary of one stream, and a finding if it has gaps.
CheckReport summarize(const std::string& name, const std::vector<Timestamp>& times, Timestamp origin) {
  CheckReport report;
  if (times.empty()) return report;
  StreamSummary summary{.name = name,
                        .count = times.size(),
                        .first_s = seconds_between(origin, times.front()),
                        .last_s = seconds_between(origin, times.back())};
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(seconds_between(times[i - 1], times[i]));
  if (!intervals.empty()) {
    const double typical = median(intervals);
    const auto longest = std::max_element(intervals.begin(), intervals.end());
    const auto gaps = std::count_if(intervals.begin(), intervals.end(), [typical](double interval) {
      return interval > kGapIntervals * typical;
    });
    summary.rate_hz = 1.0 / typical;
    summary.longest_gap_s = *longest;
    if (gaps > 0) {
      const std::size_t index = static_cast<std::size_t>(longest - intervals.begin());
      report.findings.push_back(warning(
          name, fmt::format(
                    "{} gap(s) longer than {} median intervals; the longest ({:.3f} s) starts {:.3f} s after "
                    "the first image",
                    gaps, kGapIntervals, *longest, seconds_between(origin, times[index]))));
    }
  }
  report.streams.push_back(summary);
  return report;
}

template <class Sample>
std::vector<Timestamp> stamps(const std::vector<Sample>& samples) {
  std::vector<Timestamp> times;
  times.reserve(samples.size());
  for (const Sample& sample : samples) times.push_back(sample.t);
  return times;
}

/// A rate at which the motion between two samples is lost.
std::optional<std::string> rate_finding(const std::vector<ImuSample>& samples) {
  constexpr double kLeastRate_hz = 50.0;
  constexpr std::size_t kLeastSamples = 20;
  if (samples.size() < kLeastSamples) return std::nullopt;
  const double rate_hz =
      static_cast<double>(samples.size() - 1) / seconds_between(samples.front().t, samples.back().t);
  if (rate_hz >= kLeastRate_hz) return std::nullopt;
  return fmt::format(
      "sampled at {:.3g} Hz, too slowly for the motion between samples; record at 100 Hz or more, or run "
      "without the IMU (--variant vo)",
      rate_hz);
}

CheckReport check_imu(const SequenceInfo& info) {
  CheckReport report;
  if (info.imu.empty()) return report;
  const auto outside = std::count_if(info.frame_times.begin(), info.frame_times.end(), [&](Timestamp t) {
    return t < info.imu.front().t || t > info.imu.back().t;
  });
  if (outside > 0) {
    report.findings.push_back(
        warning("imu", fmt::format("does not cover {} of {} images", outside, info.frame_times.size())));
  }
  if (const auto finding = gravity_finding(info)) report.findings.push_back(warning("imu", *finding));
  if (const auto finding = rate_finding(info.imu)) report.findings.push_back(warning("imu", *finding));
  return report;
}

/// Number of images with an item, in order of time, at most `max_distance_s` away.
template <class Item>
std::size_t covered_images(const SequenceInfo& info, const std::vector<Item>& items, double max_distance_s) {
  const auto is_covered = [&](Timestamp t) {
    const auto next = std::lower_bound(items.begin(), items.end(), t,
                                       [](const Item& item, Timestamp time) { return item.t < time; });
    const bool by_next = next != items.end() && seconds_between(t, next->t) <= max_distance_s;
    return by_next || (next != items.begin() && seconds_between(std::prev(next)->t, t) <= max_distance_s);
  };
  return static_cast<std::size_t>(
      std::count_if(info.frame_times.begin(), info.frame_times.end(), is_covered));
}

CheckReport check_detections(const SequenceInfo& info) {
  CheckReport report;
  if (info.detections.empty()) {
    report.notes.emplace_back("no recorded boxes; record them with `stillpoint detect`");
    return report;
  }
  report.notes.push_back(fmt::format("recorded detections for {} timestamps", info.detections.size()));
  const std::size_t covered = covered_images(info, info.detections, kMaxDetectionOffset_s);
  if (covered < info.frame_times.size()) {
    report.findings.push_back(
        warning("detections", fmt::format("cover {} of {} images", covered, info.frame_times.size())));
  }
  return report;
}

CheckReport check_ground_truth(const SequenceInfo& info) {
  CheckReport report;
  const std::vector<StampedPose>& poses = info.ground_truth.trajectory.poses;
  if (poses.empty()) {
    report.notes.emplace_back("no ground truth");
    return report;
  }
  const std::size_t covered = covered_images(info, poses, kMaxTruthDistance_s);
  const double coverage = static_cast<double>(covered) / static_cast<double>(info.frame_times.size());
  report.notes.push_back(fmt::format("ground truth of \"{}\" covers {:.1f} % of the images",
                                     info.ground_truth.trajectory.frame, 100.0 * coverage));
  if (coverage < kMinTruthCoverage) {
    report.findings.push_back(
        warning("ground truth", fmt::format("covers {} of {} images", covered, info.frame_times.size())));
  }
  if (const auto finding = gyro_truth_finding(info))
    report.findings.push_back(warning("ground truth", *finding));
  return report;
}

CheckReport check_depth_offset(const SequenceContent& content) {
  CheckReport report;
  std::vector<double> offsets;
  for (const FrameFiles& files : content.frame_files) {
    if (!files.depth.empty()) offsets.push_back(files.depth_offset_s);
  }
  if (offsets.empty()) {
    report.notes.emplace_back("no depth");
    return report;
  }
  report.depth_offset_s = median(offsets);
  if (std::abs(report.depth_offset_s) > kMaxDepthOffset_s) {
    report.findings.push_back(warning(
        "depth", fmt::format("lags its color image by {:.1f} ms (median)", 1e3 * report.depth_offset_s)));
  }
  return report;
}

/// Decodes every image.
CheckReport check_images(const SequenceContent& content, const CheckOptions& options) {
  CheckReport report;
  ImagePlausibility plausibility(content.info);
  const std::size_t total = content.frame_files.size();
  for (std::size_t i = 0; i < total; ++i) {
    try {
      const Frame frame = decode_frame(content, i);
      plausibility.add(frame);
      const auto measured = [](std::uint16_t raw) { return raw != 0; };
      if (!frame.depth.empty() &&
          std::none_of(frame.depth.begin<std::uint16_t>(), frame.depth.end<std::uint16_t>(), measured)) {
        report.findings.push_back(warning(content.frame_files[i].depth.string(), "has no measured depth"));
      }
    } catch (const InputError& error) {
      report.findings.push_back(parse_finding(error.what(), Severity::kError));
    }
    if (options.progress) options.progress(i + 1, total);
  }
  if (const auto finding = plausibility.depth_unit_finding())
    report.findings.push_back(warning("depth", *finding));
  if (const auto finding = plausibility.depth_scale_finding())
    report.findings.push_back(warning("depth", *finding));
  if (const auto finding = plausibility.gyro_unit_finding())
    report.findings.push_back(warning("imu", *finding));
  if (const auto finding = plausibility.depth_motion_finding())
    report.findings.push_back(warning("depth", *finding));
  if (const auto finding = plausibility.clock_finding()) report.findings.push_back(warning("imu", *finding));
  return report;
}

/// Findings of one kind: those of the lines of a file, and those of files with the same text, e.g. images.
std::string kind_of(const Finding& finding) {
  const std::size_t colon = finding.location.find_last_of(':');
  return colon == std::string::npos ? finding.text : finding.location.substr(0, colon);
}

/// The content without its faulty rows. If they leave too little, the first of them is the error, because
/// what the reader throws in the end follows from it.
SequenceContent read_valid_rows(const std::filesystem::path& folder, const OpenOptions& options,
                                FaultLog& faults) {
  try {
    return read_sequence(folder, options, faults);
  } catch (const InputError&) {
    if (faults.messages().empty()) throw;
  }
  throw InputError(faults.messages().front());
}

}  // namespace

CheckReport check_sequence(const std::filesystem::path& folder, const CheckOptions& options) {
  FaultLog faults(FaultLog::Mode::kCollect);
  const SequenceContent content = read_valid_rows(folder, options.open, faults);
  const SequenceInfo& info = content.info;
  CheckReport report;
  report.name = info.name;
  report.format = info.format;
  report.notes = info.notes;
  for (const std::string& message : faults.messages())
    report.findings.push_back(parse_finding(message, Severity::kError));
  for (const std::string& message : info.warnings)
    report.findings.push_back(parse_finding(message, Severity::kWarning));

  const Timestamp origin = info.frame_times.front();
  std::vector<CheckReport> parts{
      summarize("images", info.frame_times, origin), summarize("imu", stamps(info.imu), origin),
      summarize("ground truth", stamps(info.ground_truth.trajectory.poses), origin)};
  append(parts, {check_detections(info), check_depth_offset(content), check_imu(info),
                 check_ground_truth(info), check_images(content, options)});
  for (const CheckReport& part : parts) report = joined(std::move(report), part);
  return report;
}

std::string report_text(const CheckReport& report) {
  std::string text = fmt::format("{} ({})\n", report.name, report.format);
  for (const StreamSummary& stream : report.streams) {
    text += fmt::format("  {:<13}{:>7} at {:>6.1f} Hz, {:>8.3f} to {:>8.3f} s, longest gap {:.3f} s\n",
                        stream.name, stream.count, stream.rate_hz, stream.first_s, stream.last_s,
                        stream.longest_gap_s);
  }
  if (report.depth_offset_s != 0.0) {
    text += fmt::format("  depth lags color by {:.1f} ms (median)\n", 1e3 * report.depth_offset_s);
  }
  for (const std::string& note : report.notes) text += "  note: " + note + "\n";
  std::map<std::string, std::size_t> shown;
  for (const Finding& finding : report.findings) {
    if (++shown[kind_of(finding)] > kMaxFindingsShown) continue;
    text += fmt::format("  {}: {}: {}\n", finding.severity == Severity::kError ? "error" : "warning",
                        finding.location, finding.text);
  }
  for (const auto& [kind, count] : shown) {
    const bool is_file = kind.find(' ') == std::string::npos;
    if (count > kMaxFindingsShown)
      text += fmt::format("  ... {} more {} {}\n", count - kMaxFindingsShown, is_file ? "in" : "like", kind);
  }
  return text +
         (report.findings.empty() ? "no findings\n" : fmt::format("{} finding(s)\n", report.findings.size()));
}

}  // namespace stillpoint::datasets
