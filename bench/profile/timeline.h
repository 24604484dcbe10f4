// SPDX-License-Identifier: BSD-3-Clause
/// Export of a run's time spans to trace viewers: one track per thread of Paper Sec. II, one for decoding.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

/// In `sequential` mode the three threads of the paper run in turn, on separate tracks.
enum class Track { kTracking, kDetection, kOptimization, kDecoding };

[[nodiscard]] Track track_of(Module module);
[[nodiscard]] std::string_view track_name(Track track);

/// JSON for Perfetto and chrome://tracing: complete events in order, "ts" and "dur" in us from the first span
/// with three digits, so that no ns is lost; "args" contain the frame.
/// Source: Trace Event Format, Google 2016, "Complete Events", "Metadata Events".
///
/// @param process name of the run
[[nodiscard]] std::string chrome_trace(std::span<const FrameSpan> spans, const std::string& process);

/// Folded stacks, the input of flame graph tools: sorted lines "track;outer;inner ns" with the self time of
/// the innermost module. Source: Gregg, "The Flame Graph", CACM 2016.
[[nodiscard]] std::string folded_stacks(std::span<const FrameSpan> spans);

}  // namespace stillpoint::bench
