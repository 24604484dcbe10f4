// SPDX-License-Identifier: BSD-3-Clause
/// What the recognition of dynamic features says about one feature of one picture. Paper Sec. III-C, III-E.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace stillpoint {

enum class Verdict : std::uint8_t {
  kStable,
  kDynamicObject,  ///< lies, or lay, on a detected object
  kDynamicMotion,  ///< moves against the background, on whatever object
};

/// Why a feature got its present verdict.
enum class VerdictReason : std::uint8_t {
  kNothingSuspect,
  kInsideMask,          ///< nearer than the threshold of a box around it
  kHistory,             ///< flagged in an earlier picture and not cleared since
  kResidual,            ///< Eq. (6) over the threshold, with optimised poses
  kPredictionResidual,  ///< over the threshold with the predicted pose of the newest picture
  kRecycled,            ///< was flagged, and enough observations agree that it stands still
  kRested,              ///< was flagged, and stands still since; older observations are of something else
  kFloor,               ///< suspect, but too few others were left
};

/// Stable names for files that people and programs read, in snake_case.
[[nodiscard]] constexpr std::string_view verdict_name(Verdict verdict) {
  constexpr std::string_view kNames[] = {"stable", "dynamic_object", "dynamic_motion"};
  return kNames[static_cast<std::size_t>(verdict)];
}
[[nodiscard]] constexpr std::string_view reason_name(VerdictReason reason) {
  constexpr std::string_view kNames[] = {"nothing_suspect",     "inside_mask", "history", "residual",
                                         "prediction_residual", "recycled",    "rested",  "floor"};
  return kNames[static_cast<std::size_t>(reason)];
}

struct FeatureVerdict {
  std::int64_t id = 0;
  Verdict verdict = Verdict::kStable;
  VerdictReason reason = VerdictReason::kNothingSuspect;
  std::optional<double> residual_px = std::nullopt;  ///< r_k of Eq. (6), px of the camera's focal length;
                                                     ///< nothing where it was not evaluated
};

}  // namespace stillpoint
