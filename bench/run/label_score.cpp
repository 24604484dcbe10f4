// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/label_score.h"

#include <algorithm>

namespace stillpoint::bench {
namespace {

/// A pixel is on an outline if the square of this half side around it contains several objects.
constexpr int kOutlineMargin_px = 3;

/// Slower objects are at rest.
constexpr int kMinMovingSpeed_cm_per_s = 5;

struct LabelAtPixel {
  int object = 0;
  int speed_cm_per_s = 0;
};

/// Ground-truth label at a feature; nothing on an outline.
std::optional<LabelAtPixel> label_at(const Eigen::Vector2d& pixel, const datasets::MotionLabels& labels) {
  const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
  const cv::Rect image(0, 0, labels.object.cols, labels.object.rows);
  if (!image.contains(at)) return std::nullopt;
  const int object = labels.object.at<std::uint8_t>(at);
  const int side = 2 * kOutlineMargin_px + 1;
  const cv::Mat around =
      labels.object(cv::Rect(at.x - kOutlineMargin_px, at.y - kOutlineMargin_px, side, side) & image);
  const bool same = std::all_of(around.begin<std::uint8_t>(), around.end<std::uint8_t>(),
                                [object](std::uint8_t other) { return other == object; });
  if (!same) return std::nullopt;
  return LabelAtPixel{object, labels.speed_cm_per_s.at<std::uint8_t>(at)};
}

}  // namespace

std::optional<double> LabelScore::precision() const {
  const std::int64_t correct = people.flagged + undetectable_objects.flagged;
  return Group{.all = correct + background.flagged, .flagged = correct}.flagged_ratio();
}

void LabelScore::add(std::span<const TrackedFeature> features, std::span<const DynamicLabel> labels,
                     const datasets::MotionLabels& truth, const DriftedTracks& drifted) {
  auto label = labels.begin();
  for (const TrackedFeature& feature : features) {
    while (label != labels.end() && label->id < feature.id) ++label;
    if (label == labels.end()) return;
    if (label->id != feature.id || feature.age < 2) continue;
    const std::optional<LabelAtPixel> actual = label_at(feature.pixel, truth);
    if (!actual) continue;
    const bool undetectable = actual->object >= datasets::kFirstUndetectableObject;
    if (undetectable && actual->speed_cm_per_s < kMinMovingSpeed_cm_per_s) continue;
    if (actual->object == 0 && drifted.contains(feature.id)) continue;
    Group& group = undetectable ? undetectable_objects : actual->object > 0 ? people : background;
    ++group.all;
    group.flagged += label->label != LabelClass::kStable;
  }
}

}  // namespace stillpoint::bench
