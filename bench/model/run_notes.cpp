// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/run_notes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "eval/metrics/rpe.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

/// Factor between two protocols from which on a value is not shown without the other one.
constexpr double kMaxProtocolFactor = 2.0;
constexpr std::string_view kStrictPrefix = "strict:";

/// Values of the same runs under the protocol of the table and under a strict one.
struct ProtocolValues {
  std::vector<double> shown;
  std::vector<double> strict;
  std::size_t different = 0;  ///< runs whose values differ by the factor
};

/// "compat:tum" of "compat:tum, 0.02 s, one-to-one, rigid alignment".
std::string protocol_name(const std::string& protocol) {
  return protocol.empty() ? "the default protocol" : protocol.substr(0, protocol.find(','));
}

bool is_different(double a, double b, const MetricDescriptor& metric) {
  const double low = std::min(a, b);
  const double high = std::max(a, b);
  const double floor = metric.gate ? metric.gate->floor : 0.0;
  return high - low > floor && high >= kMaxProtocolFactor * low;
}

/// Name of the protocol of "strict:se3/ate_rmse_m" if it is strict and of that metric; else empty.
std::string strict_protocol(const std::string& name, std::string_view metric) {
  if (!name.starts_with(kStrictPrefix) || without_protocol(name) != metric) return "";
  return name.substr(0, name.find('/'));
}

}  // namespace

std::string joined_notes(std::initializer_list<std::string> notes) {
  std::string joined;
  for (const std::string& note : notes) {
    if (!note.empty()) joined += (joined.empty() ? "" : "; ") + note;
  }
  return joined;
}

std::string missing_boxes_note(const std::vector<const StoredRun*>& runs) {
  const StoredRun* worst = nullptr;
  double most = 0.0;
  for (const StoredRun* run : runs) {
    const double missing = metric_value(*run, metric_id::kFramesWithoutBoxes).value_or(0.0);
    if (run->outcome != Outcome::kOk || missing <= most) continue;
    worst = run;
    most = missing;
  }
  if (worst == nullptr) return "";
  const std::optional<double> frames = metric_value(*worst, metric_id::kFrames);
  return fmt::format("no recorded boxes in {}{:.0f}{} frames", runs.size() > 1 ? "up to " : "", most,
                     frames ? fmt::format(" of {:.0f}", *frames) : "");
}

std::string protocol_difference_note(std::span<const StoredRun* const> runs, std::string_view metric) {
  const MetricDescriptor* descriptor = find_metric(metric);
  if (descriptor == nullptr) return "";
  std::map<std::string, ProtocolValues> protocols;
  std::string shown_protocol;
  for (const StoredRun* run : runs) {
    const auto shown = std::find_if(run->metrics.begin(), run->metrics.end(),
                                    [&](const Metric& candidate) { return candidate.name == metric; });
    if (run->outcome != Outcome::kOk || shown == run->metrics.end()) continue;
    shown_protocol = protocol_name(shown->protocol);
    for (const Metric& candidate : run->metrics) {
      const std::string name = strict_protocol(candidate.name, metric);
      if (name.empty()) continue;
      ProtocolValues& values = protocols[name];
      values.shown.push_back(shown->value);
      values.strict.push_back(candidate.value);
      values.different += is_different(shown->value, candidate.value, *descriptor) ? 1 : 0;
    }
  }
  std::string note;
  for (const auto& [name, values] : protocols) {
    if (values.different == 0) continue;
    note += fmt::format("{}{} by {}, {} by {}", note.empty() ? "" : "; ",
                        value_text(*descriptor, *eval::percentile(values.shown, 0.5)), shown_protocol,
                        value_text(*descriptor, *eval::percentile(values.strict, 0.5)), name);
    if (values.shown.size() > 1)
      note += fmt::format(" (medians of {} runs; differ by a factor of {:g} or more in {})",
                          values.shown.size(), kMaxProtocolFactor, values.different);
  }
  return note;
}

std::string few_rpe_pairs_note(std::span<const StoredRun* const> runs, std::string_view metric) {
  const std::string_view id = without_protocol(metric);
  if (id != metric_id::kRpeTranslation && id != metric_id::kRpeRotation &&
      id != metric_id::kRpeTranslationPerDelta && id != metric_id::kRpeRotationPerDelta)
    return "";
  const std::string counter =
      std::string(metric.substr(0, metric.size() - id.size())) + std::string(metric_id::kRpePairs);
  std::optional<double> fewest;
  for (const StoredRun* run : runs) {
    const std::optional<double> pairs = metric_value(*run, counter);
    if (run->outcome != Outcome::kOk || !metric_value(*run, metric) || !pairs) continue;
    fewest = std::min(fewest.value_or(*pairs), *pairs);
  }
  if (!fewest || *fewest >= static_cast<double>(eval::kFewRpePairs)) return "";
  return fmt::format("RPE of only {:.0f} pairs of poses: not ranked", *fewest);
}

std::string scatter_note(std::span<const StoredRun* const> runs, std::string_view metric) {
  constexpr double kMinFactor = 2.0;
  const MetricDescriptor* descriptor = gated_metric(metric);
  if (descriptor == nullptr || descriptor->gate->family != MetricFamily::kAccuracy ||
      descriptor->direction != MetricDirection::kSmallerIsBetter)
    return "";
  std::map<std::string, std::pair<double, double>> ranges;  // by data
  for (const StoredRun* run : runs) {
    const std::optional<double> value = metric_value(*run, metric);
    if (run->outcome != Outcome::kOk || !value || !std::isfinite(*value)) continue;
    const auto [range, is_new] = ranges.insert({run->identity.sequence_id, {*value, *value}});
    range->second = {std::min(range->second.first, *value), std::max(range->second.second, *value)};
  }
  std::pair<double, double> widest;
  double factor = 0.0;
  for (const auto& [data, range] : ranges) {
    const auto& [low, high] = range;
    if (data.empty() || low <= 0.0 || high - low <= descriptor->gate->floor || high < kMinFactor * low)
      continue;
    if (high / low <= factor) continue;
    widest = range;
    factor = high / low;
  }
  if (factor == 0.0) return "";
  return fmt::format("{} to {} on the same data, a factor of {:.1f}: one run is no result",
                     value_text(*descriptor, widest.first), value_text(*descriptor, widest.second), factor);
}

std::vector<std::string> innovation_doubts(std::optional<double> nis_reprojection,
                                           std::optional<double> nis_inertial) {
  constexpr double kMostReprojection = 4.0;
  constexpr double kMostInertial = 3.0;
  std::vector<std::string> doubts;
  if (nis_inertial.value_or(0.0) > kMostInertial)
    doubts.push_back(fmt::format("NIS inertial {:.1f}: the IMU is noisier than stated", *nis_inertial));
  if (nis_reprojection.value_or(0.0) > kMostReprojection)
    doubts.push_back(
        fmt::format("NIS reprojection {:.1f}: images contradict the prediction", *nis_reprojection));
  return doubts;
}

std::string innovation_note(std::span<const StoredRun* const> runs) {
  std::vector<std::string> most;
  for (const StoredRun* run : runs) {
    if (run->outcome != Outcome::kOk) continue;
    std::vector<std::string> doubts =
        innovation_doubts(metric_value(*run, "nis_reprojection"), metric_value(*run, "nis_inertial"));
    if (doubts.size() > most.size()) most = std::move(doubts);
  }
  return most.empty() ? "" : fmt::format("{}; see `stillpoint diagnose`", fmt::join(most, "; "));
}

std::string doubtful_error_note(std::span<const StoredRun* const> runs, std::string_view metric) {
  const std::string_view name = without_protocol(metric);
  if (!name.starts_with("ate_") && !name.starts_with("rpe_")) return "";
  const auto doubtful = std::ranges::find_if(runs, [&](const StoredRun* run) {
    return run->outcome == Outcome::kOk && !run->detail.empty() &&
           std::ranges::any_of(run->metrics, [&](const Metric& own) { return own.name == metric; });
  });
  return doubtful == runs.end() ? "" : (*doubtful)->detail;
}

TimeSource time_source(const StoredRun& run) {
  if (run.identity.kind != "timing") return TimeSource::kShared;
  return metric_value(run, metric_id::kQuiet) == 0.0 ? TimeSource::kBusy : TimeSource::kUndisturbed;
}

std::string time_source_note(TimeSource source) {
  switch (source) {
    case TimeSource::kUndisturbed:
      return "";
    case TimeSource::kBusy:
      return "times of timing runs while other processes used at least 5 % of the CPU: indicative only; "
             "repeat the runs on an idle machine";
    case TimeSource::kShared:
      return "times of runs that are no timing runs and may have shared the machine: indicative only; "
             "execute a plan with kind = \"timing\"";
  }
  return "";
}

}  // namespace stillpoint::bench
