// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/run_csv.h"

#include <charconv>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// Columns x, y, z, qx, qy, qz, qw.
constexpr int kPoseColumns = 7;

/// Parser state: the position for error messages.
struct CsvRows {
  const std::string& place;
  std::string_view header;  ///< expected first line
  long line = 1;

  /// @throws InputError unless `text` is an integer
  [[nodiscard]] std::int64_t number(std::string_view text) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return value;
    const std::string problem = "\"" + std::string(text) + "\" is not an integer";
    throw InputError(place, line, problem + "; expected columns: " + std::string(header));
  }

  /// @throws InputError unless `text` is a number
  [[nodiscard]] double real(std::string_view text) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return value;
    throw InputError(place, line, "'" + std::string(text) + "' is not a number");
  }

  /// Calls `take` with every row after the header line.
  /// @throws InputError if the first line is not the header
  template <class Take>
  void for_each_row(std::string_view text, Take&& take) {
    if (cut_front(text, '\n') != header)
      throw InputError(place, line, "does not begin with " + std::string(header));
    while (!text.empty()) {
      const std::string_view row = cut_front(text, '\n');
      ++line;
      if (!row.empty()) take(row);
    }
  }
};

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

namespace {

constexpr std::string_view kLoopHeader =
    "query_frame,query_t_ns,match_frame,match_t_ns,votes,matches,inliers,residual_px,tx,ty,tz,qx,qy,qz,qw,"
    "accepted,reason,in_map";

StoredLoop loop_of(const CsvRows& rows, std::string_view text) {
  StoredLoop loop;
  static_cast<void>(rows.number(cut_front(text, ',')));  // frames and times are equivalent
  loop.query_t = Timestamp{rows.number(cut_front(text, ','))};
  static_cast<void>(rows.number(cut_front(text, ',')));
  loop.match_t = Timestamp{rows.number(cut_front(text, ','))};
  cut_front(text, ',');  // votes
  cut_front(text, ',');  // matches
  loop.inliers = rows.number(cut_front(text, ','));
  loop.residual_px = rows.real(cut_front(text, ','));
  for (int i = 0; i < kPoseColumns; ++i) cut_front(text, ',');
  loop.accepted = rows.number(cut_front(text, ',')) != 0;
  loop.reason = std::string(cut_front(text, ','));
  loop.in_map = rows.number(text) != 0;
  return loop;
}

}  // namespace

std::string loop_text(std::span<const LoopRecord> loops) {
  std::string text = std::string(kLoopHeader) + "\n";
  for (const LoopRecord& loop : loops) {
    const Pose& T = loop.T_match_query;
    const bool accepted = loop.outcome == LoopOutcome::kAccepted;
    text += fmt::format(
        "{},{},{},{},{},{},{},{:.4g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{},{}\n",
        loop.query_frame, loop.query_t.ns, loop.match_frame, loop.match_t.ns, loop.votes, loop.matches,
        loop.inliers, loop.residual_px, T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w(),
        accepted ? 1 : 0, accepted ? "" : outcome_name(loop.outcome), loop.in_map ? 1 : 0);
  }
  return text;
}

std::string keyframe_text(std::span<const MapKeyframe> keyframes) {
  std::string text = "frame,t_ns,segment,located,tx,ty,tz,qx,qy,qz,qw,processing_ms,memory_bytes\n";
  for (const MapKeyframe& keyframe : keyframes) {
    const Pose& T = keyframe.T_m_b;
    text += fmt::format("{},{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.4g},{}\n",
                        keyframe.frame, keyframe.t.ns, keyframe.segment, keyframe.is_located ? 1 : 0, T.p.x(),
                        T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w(), keyframe.cost.processing_ms,
                        keyframe.cost.memory_bytes);
  }
  return text;
}

std::vector<StoredLoop> parse_loops(std::string_view text, const std::string& place) {
  std::vector<StoredLoop> loops;
  CsvRows rows{.place = place, .header = kLoopHeader};
  rows.for_each_row(text, [&](std::string_view row) { loops.push_back(loop_of(rows, row)); });
  return loops;
}

namespace {

constexpr std::string_view kLandmarkHeader = "x,y,z,dynamic";

}  // namespace

std::string landmark_text(std::span<const LandmarkSample> landmarks) {
  std::string text = std::string(kLandmarkHeader) + "\n";
  for (const LandmarkSample& landmark : landmarks)
    text += fmt::format("{:.3f},{:.3f},{:.3f},{}\n", landmark.p_w.x(), landmark.p_w.y(), landmark.p_w.z(),
                        landmark.dynamic ? 1 : 0);
  return text;
}

std::vector<LandmarkSample> parse_landmarks(std::string_view text, const std::string& place) {
  std::vector<LandmarkSample> landmarks;
  CsvRows rows{.place = place, .header = kLandmarkHeader};
  rows.for_each_row(text, [&](std::string_view row) {
    LandmarkSample& landmark = landmarks.emplace_back();
    for (double& value : landmark.p_w) value = rows.real(cut_front(row, ','));
    landmark.dynamic = rows.number(row) != 0;
  });
  return landmarks;
}

namespace {

constexpr std::string_view kStatusHeader = "frame,t_ns,status,segment,x,y,z,qx,qy,qz,qw,sigma_m,sigma_rad";

FrameClaim claim_of(const CsvRows& rows, std::string_view text) {
  FrameClaim claim;
  claim.frame = rows.number(cut_front(text, ','));
  claim.t_ns = rows.number(cut_front(text, ','));
  claim.status = std::string(cut_front(text, ','));
  claim.segment = static_cast<int>(rows.number(cut_front(text, ',')));
  for (int i = 0; i < kPoseColumns; ++i) cut_front(text, ',');
  claim.sigma_m = rows.real(cut_front(text, ','));
  claim.sigma_rad = rows.real(text);
  return claim;
}

}  // namespace

std::string claim_text(std::span<const FrameClaim> claims) {
  std::string text = std::string(kStatusHeader) + "\n";
  for (const FrameClaim& claim : claims) {
    const Pose& T = claim.T_w_c;
    text += fmt::format("{},{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.6g},{:.6g}\n",
                        claim.frame, claim.t_ns, claim.status, claim.segment, T.p.x(), T.p.y(), T.p.z(),
                        T.q.x(), T.q.y(), T.q.z(), T.q.w(), claim.sigma_m, claim.sigma_rad);
  }
  return text;
}

std::vector<FrameClaim> parse_claims(std::string_view text, const std::string& place) {
  std::vector<FrameClaim> claims;
  CsvRows rows{.place = place, .header = kStatusHeader};
  rows.for_each_row(text, [&](std::string_view row) { claims.push_back(claim_of(rows, row)); });
  return claims;
}

namespace {

constexpr std::string_view kTimingHeader = "frame,module,ns,calls";

TimingSample sample_of(const CsvRows& rows, std::string_view text) {
  TimingSample sample;
  sample.frame = rows.number(cut_front(text, ','));
  sample.module = std::string(cut_front(text, ','));
  sample.ns = rows.number(cut_front(text, ','));
  sample.calls = rows.number(text);
  return sample;
}

}  // namespace

std::string timing_text(std::span<const TimingSample> samples) {
  std::string text = std::string(kTimingHeader) + "\n";
  for (const TimingSample& sample : samples) {
    text += fmt::format("{},{},{},{}\n", sample.frame, sample.module, sample.ns, sample.calls);
  }
  return text;
}

std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place) {
  std::vector<TimingSample> samples;
  CsvRows rows{.place = place, .header = kTimingHeader};
  rows.for_each_row(text, [&](std::string_view row) { samples.push_back(sample_of(rows, row)); });
  return samples;
}

}  // namespace stillpoint::bench
