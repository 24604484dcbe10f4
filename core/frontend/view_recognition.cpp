// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/view_recognition.h"

#include <algorithm>
#include <utility>

#include <opencv2/features2d.hpp>

namespace stillpoint {
namespace {

constexpr int kMinView = 20;       ///< features of a view that is worth to be recognized
constexpr int kMinContinued = 10;  ///< fewer continued tracks: the view was lost
constexpr int kMinMatches = 12;
constexpr int kMaxAttempts = 60;       ///< frames; then the camera sees another view
constexpr float kMaxDistance = 64.0F;  // of 256 bits
constexpr float kMaxRatio = 0.8F;      // Lowe 2004, Sec. 7.1
constexpr float kPatch_px = 31.0F;

struct Described {
  cv::Mat descriptors;
  std::vector<std::size_t> features;  ///< index of each row; features near the border have none
};

Described describe(const cv::Mat& gray, const std::vector<cv::Point2f>& pixels) {
  std::vector<cv::KeyPoint> points;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    points.emplace_back(pixels[i], kPatch_px, 0.0F, 0.0F, 0, static_cast<int>(i));
  }
  Described described;
  cv::ORB::create(static_cast<int>(points.size()), 1.2F, 1)->compute(gray, points, described.descriptors);
  for (const cv::KeyPoint& point : points) {
    described.features.push_back(static_cast<std::size_t>(point.class_id));
  }
  return described;
}

/// Pairs of indices of features in both views.
std::vector<std::pair<std::size_t, std::size_t>> match(const Described& from, const Described& to) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (from.features.size() < 2 || to.features.size() < 2) return pairs;
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> forward;
  std::vector<cv::DMatch> backward;
  matcher.knnMatch(from.descriptors, to.descriptors, forward, 2);
  matcher.match(to.descriptors, from.descriptors, backward);
  for (const std::vector<cv::DMatch>& nearest : forward) {
    const cv::DMatch& best = nearest.front();
    if (best.distance > kMaxDistance || best.distance > kMaxRatio * nearest.back().distance) continue;
    if (backward[static_cast<std::size_t>(best.trainIdx)].trainIdx != best.queryIdx) continue;
    pairs.emplace_back(from.features[static_cast<std::size_t>(best.queryIdx)],
                       to.features[static_cast<std::size_t>(best.trainIdx)]);
  }
  return pairs;
}

bool by_id(const TrackedFeature& a, const TrackedFeature& b) { return a.id < b.id; }

}  // namespace

void ViewRecognition::recognize(const View& view) {
  if (++attempts_ > kMaxAttempts) {
    lost_.reset();
    return;
  }
  const auto pairs = match(describe(view.gray, view.pixels), describe(lost_->gray, lost_->pixels));
  if (pairs.size() < kMinMatches) return;
  for (const auto& [now, before] : pairs) aliases_.push_back({view.ids[now], lost_->ids[before]});
  std::ranges::sort(aliases_, {}, &Alias::tracker_id);
  lost_.reset();
}

TrackedFrame ViewRecognition::process(const cv::Mat& gray, TrackedFrame frame) {
  const auto continued = std::ranges::count_if(frame.features, [](const auto& f) { return f.age > 1; });
  const bool is_lost = continued < kMinContinued && last_.ids.size() >= kMinView;
  if (is_lost && !lost_) {
    lost_ = std::move(last_);
    attempts_ = 0;
  }
  last_.gray = gray;
  last_.ids.clear();
  last_.pixels.clear();
  for (const TrackedFeature& feature : frame.features) {
    last_.ids.push_back(feature.id);
    last_.pixels.emplace_back(static_cast<float>(feature.pixel.x()), static_cast<float>(feature.pixel.y()));
  }
  if (lost_ && last_.ids.size() >= kMinMatches) recognize(last_);
  if (aliases_.empty()) return frame;
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    std::int64_t& id = frame.features[i].id;
    const auto alias = std::ranges::lower_bound(aliases_, id, {}, &Alias::tracker_id);
    if (alias != aliases_.end() && alias->tracker_id == id) id = alias->id;
    last_.ids[i] = id;
  }
  std::ranges::sort(frame.features, by_id);
  return frame;
}

std::vector<std::int64_t> ViewRecognition::tracker_ids(std::span<const std::int64_t> ids,
                                                       std::vector<std::int64_t> recycled) const {
  std::vector<std::int64_t> known = std::move(recycled);
  known.assign(ids.begin(), ids.end());
  if (aliases_.empty()) return known;
  for (const Alias& alias : aliases_) {
    const auto found = std::ranges::find(ids, alias.id);
    if (found != ids.end()) known[static_cast<std::size_t>(found - ids.begin())] = alias.tracker_id;
  }
  std::ranges::sort(known);
  return known;
}

}  // namespace stillpoint
