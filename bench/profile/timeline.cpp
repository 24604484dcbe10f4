// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/timeline.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

constexpr int kProcess = 1;

std::chrono::steady_clock::time_point end_of(const ModuleSpan& span) { return span.start + span.elapsed; }

/// Sorted by track, start, and descending duration, so that outer spans precede inner ones. Of two equal
/// spans the one that ended last is the outer one.
std::vector<FrameSpan> in_order(std::span<const FrameSpan> spans) {
  std::vector<FrameSpan> sorted(spans.rbegin(), spans.rend());
  const auto key = [](const FrameSpan& one) {
    return std::tuple(track_of(one.span.module), one.span.start, -one.span.elapsed);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const FrameSpan& a, const FrameSpan& b) { return key(a) < key(b); });
  return sorted;
}

std::string microseconds(std::chrono::nanoseconds time) {
  return fmt::format("{}.{:03}", time.count() / 1000, time.count() % 1000);
}

int track_number(Track track) { return static_cast<int>(track) + 1; }

std::string name_event(const char* what, int track, const std::string& name) {
  return nlohmann::ordered_json{
      {"ph", "M"}, {"name", what}, {"pid", kProcess}, {"tid", track}, {"args", {{"name", name}}}}
      .dump();
}

std::string complete_event(const FrameSpan& one, int track, std::chrono::steady_clock::time_point zero) {
  return fmt::format(
      R"({{"ph":"X","name":"{}","cat":"module","pid":{},"tid":{},"ts":{},"dur":{},"args":{{"frame":{}}}}})",
      module_name(one.span.module), kProcess, track, microseconds(one.span.start - zero),
      microseconds(one.span.elapsed), one.frame);
}

/// Several threads decode images: each gets a track, numbered from that of Track::kDecoding on.
class DecodingTracks {
 public:
  /// @param span not earlier than those before
  int number_of(const ModuleSpan& span) {
    const auto free = std::ranges::find_if(ends_, [&](const auto& end) { return end <= span.start; });
    const auto index = free - ends_.begin();
    if (free == ends_.end()) ends_.emplace_back();
    ends_[static_cast<std::size_t>(index)] = end_of(span);
    return track_number(Track::kDecoding) + static_cast<int>(index);
  }
  [[nodiscard]] int count() const { return static_cast<int>(ends_.size()); }

 private:
  std::vector<std::chrono::steady_clock::time_point> ends_;  ///< of the last span of each track
};

/// An open span and its self time.
struct OpenSpan {
  ModuleSpan span;
  std::chrono::nanoseconds self{};
};

bool lies_within(const ModuleSpan& inner, const ModuleSpan& outer) {
  return inner.module != Module::kImageDecoding && track_of(inner.module) == track_of(outer.module) &&
         end_of(inner) <= end_of(outer);
}

/// Sums self times by stack over spans in their order.
class StackSums {
 public:
  using StackTimes = std::map<std::string, std::chrono::nanoseconds>;

  void add(const ModuleSpan& span) {
    while (!stack_.empty() && !lies_within(span, stack_.back().span)) close_innermost();
    if (!stack_.empty()) stack_.back().self -= span.elapsed;
    stack_.push_back({.span = span, .self = span.elapsed});
  }

  [[nodiscard]] StackTimes finish() {
    while (!stack_.empty()) close_innermost();
    return std::move(times_);
  }

 private:
  /// Adds the self time of the innermost span.
  void close_innermost() {
    std::string key(track_name(track_of(stack_.back().span.module)));
    for (const OpenSpan& open : stack_) key.append(";").append(module_name(open.span.module));
    times_[key] += stack_.back().self;
    stack_.pop_back();
  }

  std::vector<OpenSpan> stack_;
  StackTimes times_;
};

}  // namespace

Track track_of(Module module) {
  switch (module) {
    case Module::kFeatureTracking:
    case Module::kFeatureDetection:
    case Module::kTrackingThread:
    case Module::kOutlierRejection:
    case Module::kFeatureMask:
      return Track::kTracking;
    case Module::kObjectDetection:
      return Track::kDetection;
    case Module::kImageDecoding:
      return Track::kDecoding;
    case Module::kDynamicRecognition:
    case Module::kStateOptimization:
    case Module::kOptimizationThread:
    case Module::kWindowSolve:
    case Module::kMarginalization:
      break;
  }
  return Track::kOptimization;
}

std::string_view track_name(Track track) {
  static constexpr std::array<std::string_view, 4> kNames = {"tracking", "object detection", "optimization",
                                                             "image decoding"};
  return kNames[static_cast<std::size_t>(track)];
}

std::string chrome_trace(std::span<const FrameSpan> spans, const std::string& process) {
  std::vector<std::string> events = {name_event("process_name", 0, process)};
  for (const Track track : {Track::kTracking, Track::kDetection, Track::kOptimization}) {
    events.push_back(name_event("thread_name", track_number(track), std::string(track_name(track))));
  }
  std::chrono::steady_clock::time_point zero = std::chrono::steady_clock::time_point::max();
  for (const FrameSpan& one : spans) zero = std::min(zero, one.span.start);
  DecodingTracks decoding;
  std::vector<std::string> complete;
  for (const FrameSpan& one : in_order(spans)) {
    const Track track = track_of(one.span.module);
    const int number = track == Track::kDecoding ? decoding.number_of(one.span) : track_number(track);
    complete.push_back(complete_event(one, number, zero));
  }
  for (int i = 0; i < decoding.count(); ++i) {
    const std::string name = fmt::format("{} {}", track_name(Track::kDecoding), i + 1);
    events.push_back(name_event("thread_name", track_number(Track::kDecoding) + i, name));
  }
  events.insert(events.end(), complete.begin(), complete.end());
  return fmt::format("{{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n{}\n]}}\n", fmt::join(events, ",\n"));
}

std::string folded_stacks(std::span<const FrameSpan> spans) {
  StackSums sums;
  for (const FrameSpan& one : in_order(spans)) sums.add(one.span);
  std::string text;
  for (const auto& [key, self] : sums.finish()) text += fmt::format("{} {}\n", key, self.count());
  return text;
}

}  // namespace stillpoint::bench
