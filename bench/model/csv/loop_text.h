// SPDX-License-Identifier: BSD-3-Clause
/// Texts of loops.csv: recognized places, and what became of them; and of keyframes.csv.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/loop_report.h"

namespace stillpoint::bench {

/// A row of loops.csv, without the pose.
struct StoredLoop {
  Timestamp query_t;
  Timestamp match_t;  ///< with `in_map` on the clock of another run
  std::int64_t inliers = 0;
  double residual_px = 0.0;  ///< RMS reprojection error of the inliers [px]
  bool accepted = false;
  std::string reason;   ///< why it was refused, see `outcome_name`
  bool in_map = false;  ///< the match is in the loaded map
};

[[nodiscard]] std::string loop_text(std::span<const LoopRecord> loops);

/// Optimized poses T_m_b of the keyframes, the time of the loop closure for each, and its memory afterwards.
[[nodiscard]] std::string keyframe_text(std::span<const MapKeyframe> keyframes);

/// @param place name of the text in error messages
/// @throws InputError for a malformed text
[[nodiscard]] std::vector<StoredLoop> parse_loops(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
