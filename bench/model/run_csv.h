// SPDX-License-Identifier: BSD-3-Clause
/// The CSV files of a run in a store, written and parsed: a header, then one row per frame, module of a
/// frame, recognized place, or keyframe. Error messages of the parsers contain file and line.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/stored_run.h"
#include "core/geometry/pose.h"
#include "core/types/loop_report.h"

namespace stillpoint::bench {

/// Cuts the part before `separator` off the front of `text`.
inline std::string_view cut_front(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

/// Text of counters.csv: the work of the odometry for each frame.
[[nodiscard]] std::string counter_text(std::span<const FrameCounters> frames);

/// @param place name of the text in messages
/// @throws InputError with the line of the first error
[[nodiscard]] std::vector<FrameCounters> parse_counters(std::string_view text, const std::string& place);

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

/// Text of loops.csv: recognized places, and what became of them.
[[nodiscard]] std::string loop_text(std::span<const LoopRecord> loops);

/// Text of keyframes.csv: optimized poses T_m_b of the keyframes, the time of the loop closure for each, and
/// its memory afterwards.
[[nodiscard]] std::string keyframe_text(std::span<const MapKeyframe> keyframes);

/// @param place name of the text in error messages
/// @throws InputError for a malformed text
[[nodiscard]] std::vector<StoredLoop> parse_loops(std::string_view text, const std::string& place);

/// A row of landmarks.csv: a feature with measured depth, in the world of the odometry [m].
struct LandmarkSample {
  Eigen::Vector3d p_w = Eigen::Vector3d::Zero();
  bool dynamic = false;
};

/// Text of landmarks.csv.
[[nodiscard]] std::string landmark_text(std::span<const LandmarkSample> landmarks);

/// @param place name of the text in error messages
/// @throws InputError for a malformed text
[[nodiscard]] std::vector<LandmarkSample> parse_landmarks(std::string_view text, const std::string& place);

/// A row of status.csv.
struct FrameClaim {
  std::int64_t frame = 0;
  std::int64_t t_ns = 0;  ///< timestamp of the image
  std::string status;
  int segment = 0;         ///< number of the world frame
  Pose T_w_c;              ///< also of frames that the trajectory does not contain
  double sigma_m = 0.0;    ///< of the position along its least certain direction; 0 = not reported
  double sigma_rad = 0.0;  ///< same for the rotation
};

/// Text of status.csv: what the odometry claims about each frame.
[[nodiscard]] std::string claim_text(std::span<const FrameClaim> claims);

/// Without the poses.
/// @param place name of the text in error messages
/// @throws InputError for a malformed text
[[nodiscard]] std::vector<FrameClaim> parse_claims(std::string_view text, const std::string& place);

/// Timing samples with the columns `frame,module,ns,calls`.
[[nodiscard]] std::string timing_text(std::span<const TimingSample> samples);

/// @param place name of the text in messages
/// @throws InputError with the line of the first error
[[nodiscard]] std::vector<TimingSample> parse_timings(std::string_view text, const std::string& place);

}  // namespace stillpoint::bench
