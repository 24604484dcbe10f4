// SPDX-License-Identifier: BSD-3-Clause
/// The spans of a run as files for viewers: one track for each thread of Paper Sec. II, one for decoding.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bench/run/odometry_run.h"

namespace stillpoint {

/// In `sequential` mode the three threads of the paper take turns; they keep their tracks.
enum class Track { kTracking, kDetection, kOptimization, kDecoding };

[[nodiscard]] Track track_of(Module module);
[[nodiscard]] std::string_view track_name(Track track);

/// JSON for Perfetto and chrome://tracing: complete events in order, "ts" and "dur" in us from the first span
/// with three digits, so that no ns is lost; "args" tell the picture.
/// Source: Trace Event Format, Google 2016, "Complete Events", "Metadata Events".
///
/// @param process what to call the run
[[nodiscard]] std::string chrome_trace(std::span<const FrameSpan> spans, const std::string& process);

/// A line "track;outer;inner ns" for each stack with the time spent in its innermost module alone, sorted;
/// the input of flame graph tools. Source: Gregg, "The Flame Graph", CACM 2016.
[[nodiscard]] std::string folded_stacks(std::span<const FrameSpan> spans);

}  // namespace stillpoint
