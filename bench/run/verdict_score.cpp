// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/verdict_score.h"

#include <algorithm>

namespace stillpoint {
namespace {

/// An object's outline lies within this distance of a pixel whose square holds several labels.
constexpr int kOutline_px = 3;

/// Slower movers rest [cm/s].
constexpr int kRests_cm_per_s = 5;

struct Place {
  int object = 0;
  int speed_cm_per_s = 0;
};

/// What lies under a feature; nothing on an outline.
std::optional<Place> place_of(const Eigen::Vector2d& pixel, const MotionLabels& labels) {
  const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
  const cv::Rect picture(0, 0, labels.object.cols, labels.object.rows);
  if (!picture.contains(at)) return std::nullopt;
  const int object = labels.object.at<std::uint8_t>(at);
  const int side = 2 * kOutline_px + 1;
  const cv::Mat around =
      labels.object(cv::Rect(at.x - kOutline_px, at.y - kOutline_px, side, side) & picture);
  const bool same = std::all_of(around.begin<std::uint8_t>(), around.end<std::uint8_t>(),
                                [object](std::uint8_t other) { return other == object; });
  if (!same) return std::nullopt;
  return Place{object, labels.speed_cm_per_s.at<std::uint8_t>(at)};
}

}  // namespace

std::optional<double> VerdictScore::precision() const {
  const std::int64_t right = people.flagged + unknown_movers.flagged;
  return Share{.all = right + background.flagged, .flagged = right}.share();
}

void VerdictScore::add(std::span<const TrackedFeature> features, std::span<const FeatureVerdict> verdicts,
                       const MotionLabels& labels, const SlidTracks& slid) {
  auto verdict = verdicts.begin();
  for (const TrackedFeature& feature : features) {
    while (verdict != verdicts.end() && verdict->id < feature.id) ++verdict;
    if (verdict == verdicts.end()) return;
    if (verdict->id != feature.id || feature.age < 2) continue;
    const std::optional<Place> place = place_of(feature.pixel, labels);
    if (!place) continue;
    const bool unknown = place->object >= kFirstUnknownMover;
    if (unknown && place->speed_cm_per_s < kRests_cm_per_s) continue;
    if (place->object == 0 && slid.contains(feature.id)) continue;
    Share& share = unknown ? unknown_movers : place->object > 0 ? people : background;
    ++share.all;
    share.flagged += verdict->verdict != Verdict::kStable;
  }
}

}  // namespace stillpoint
