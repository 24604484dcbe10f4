// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/csv/counter_text.h"

#include <fmt/format.h>

#include "bench/model/csv/csv_rows.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kCounterHeader =
    "frame,t_ns,status,tracked_features,window_landmarks,depth_landmarks,dynamic_features,solver_iterations,"
    "keyframe,reset";

FrameCounters frame_of(const CsvRows& rows, std::string_view text) {
  FrameCounters frame;
  frame.frame = rows.number(cut_front(text, ','));
  frame.t_ns = rows.number(cut_front(text, ','));
  frame.status = std::string(cut_front(text, ','));
  for (std::int64_t* value : {&frame.tracked_features, &frame.window_landmarks, &frame.depth_landmarks,
                              &frame.dynamic_features, &frame.solver_iterations}) {
    *value = rows.number(cut_front(text, ','));
  }
  frame.keyframe = rows.number(cut_front(text, ',')) != 0;
  frame.reset = rows.number(text) != 0;
  return frame;
}

}  // namespace

std::string counter_text(std::span<const FrameCounters> frames) {
  std::string text = std::string(kCounterHeader) + "\n";
  for (const FrameCounters& frame : frames) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{:d},{:d}\n", frame.frame, frame.t_ns, frame.status,
                    frame.tracked_features, frame.window_landmarks, frame.depth_landmarks,
                    frame.dynamic_features, frame.solver_iterations, int{frame.keyframe}, int{frame.reset});
  }
  return text;
}

std::vector<FrameCounters> parse_counters(std::string_view text, const std::string& place) {
  std::vector<FrameCounters> frames;
  CsvRows rows{.place = place, .header = kCounterHeader};
  rows.for_each_row(text, [&](std::string_view row) { frames.push_back(frame_of(rows, row)); });
  return frames;
}

}  // namespace stillpoint::bench
