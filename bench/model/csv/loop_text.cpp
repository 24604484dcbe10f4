// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/csv/loop_text.h"

#include <fmt/format.h>

#include "bench/model/csv/csv_rows.h"

namespace stillpoint::bench {
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

}  // namespace stillpoint::bench
