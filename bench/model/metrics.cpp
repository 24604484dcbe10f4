// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/metrics.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/base/module_timings.h"

namespace stillpoint::bench {
namespace {

/// What a timed module does, in the order of `Module`.
constexpr std::array<std::string_view, kModuleCount> kModuleDescriptions = {
    "prediction and KLT tracking of features, per frame",
    "selection of grid cells and detection of new features, per frame that detects",
    "everything that the tracking thread does with one frame",
    "semantic mask, missed detection compensation and moving consistency check",
    "PnP, triangulation, nonlinear solve and marginalization",
    "everything that the optimization thread does with one frame",
    "one call of the object detector",
    "epipolar RANSAC of the tracker",
    "circular masks of detected features",
    "the nonlinear solve of the sliding window alone",
    "marginalization alone",
    "reading and decoding the images of one frame; part of no thread in the paper"};

}  // namespace

std::vector<const MetricDescriptor*> metrics_of(MetricSource source) {
  std::vector<const MetricDescriptor*> found;
  for (const MetricDescriptor& metric : all_metrics()) {
    if (metric.source == source) found.push_back(&metric);
  }
  return found;
}

const MetricDescriptor& headline_metric() { return all_metrics().front(); }

const MetricDescriptor* find_metric(std::string_view id) {
  const auto metrics = all_metrics();
  const auto found =
      std::ranges::find_if(metrics, [&](const MetricDescriptor& metric) { return metric.id == id; });
  return found == metrics.end() ? nullptr : &*found;
}

const MetricDescriptor* gated_metric(std::string_view id) {
  const MetricDescriptor* metric = find_metric(id);
  return metric != nullptr && metric->gate ? metric : nullptr;
}

std::string_view impossibility(const Metric& metric) {
  constexpr double kMaxFraction = 1.0 + 1e-9;  // a quotient of two sums of times may be rounded up
  const MetricDescriptor* descriptor = gated_metric(without_protocol(metric.name));
  if (descriptor == nullptr) return "";
  if (metric.value < 0.0) return "negative";
  return descriptor->gate->is_fraction && metric.value > kMaxFraction ? "above 1" : "";
}

std::string_view without_protocol(std::string_view name) {
  return name.substr(name.rfind('/') + 1);  // npos + 1 = 0
}

std::vector<Metric> measured_metrics(const Measurements& measurements) {
  std::vector<Metric> measured;
  for (const MetricDescriptor& metric : all_metrics()) {
    const std::optional<double> value = metric.value != nullptr ? metric.value(measurements) : std::nullopt;
    if (!value) continue;
    measured.push_back({.name = std::string(metric.id),
                        .protocol = std::string(metric.protocol.text),
                        .unit = std::string(metric.unit),
                        .value = *value});
  }
  return measured;
}

std::string value_text(const MetricDescriptor& metric, double value) {
  return fmt::format("{} {:.{}f}{}{}", metric.label, value, metric.decimals, metric.unit.empty() ? "" : " ",
                     metric.unit);
}

std::string tooltip(const MetricDescriptor& metric) {
  std::string text(metric.description);
  if (!metric.unit.empty()) text += fmt::format(" [{}]", metric.unit);
  if (metric.direction == MetricDirection::kSmallerIsBetter) text += "; smaller is better";
  if (metric.direction == MetricDirection::kLargerIsBetter) text += "; larger is better";
  return text;
}

std::string tooltip_of(std::string_view name) {
  if (const MetricDescriptor* metric = find_metric(without_protocol(name))) return tooltip(*metric);
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    if (module_name(static_cast<Module>(i)) != name) continue;
    return fmt::format("Mean time of {}: {} [ms]", name, kModuleDescriptions[i]);
  }
  return "";
}

}  // namespace stillpoint::bench
