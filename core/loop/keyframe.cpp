// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/keyframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <tuple>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/types/detection.h"

namespace stillpoint {
namespace {

constexpr int kLevels = 3;
constexpr float kScale = 1.4F;
constexpr std::array<double, kLevels> kLevelFractions = {0.6, 0.25, 0.15};
constexpr int kFastThreshold = 12;
constexpr int kPatch_px = 31;
constexpr int kBorder_px = 20;
constexpr int kCell_px = 48;  // corners are spread over cells of this size
constexpr double kMinDepth_m = 0.2;
constexpr double kMaxDepth_m = 8.0;         // beyond, stereo and structured light are off by decimeters
constexpr double kDynamicRadius_px = 20.0;  // around a dynamic feature, as the circles around tracked ones
constexpr double kMaxDepthSpread = 0.05;    // relative to the depth: larger at the edge of an object

/// Depth at a pixel [m]; 0 if it is not measured, or if its neighbors belong to another surface.
double consistent_depth(const DepartedKeyframe& keyframe, const cv::Point2f& pixel) {
  constexpr int kOffset_px = 2;
  constexpr std::array<std::array<int, 2>, 5> kOffsets = {
      {{0, 0}, {-kOffset_px, 0}, {kOffset_px, 0}, {0, -kOffset_px}, {0, kOffset_px}}};
  std::array<double, 5> depths{};
  std::size_t count = 0;
  for (const auto& [du, dv] : kOffsets) {
    const int column = cvRound(pixel.x) + du;
    const int row = cvRound(pixel.y) + dv;
    if (column < 0 || row < 0 || column >= keyframe.depth.cols || row >= keyframe.depth.rows) continue;
    const double depth = keyframe.depth.at<std::uint16_t>(row, column) / keyframe.depth_units_per_m;
    if (depth > 0.0) depths[count++] = depth;
  }
  if (count < 3) return 0.0;
  std::sort(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(count));
  const double median = depths[count / 2];
  return depths[count - 1] - depths[0] <= kMaxDepthSpread * median ? median : 0.0;
}

/// Angle of the intensity centroid [deg]; Rublee et al. 2011, Eqs. (1)-(3).
float centroid_angle(const cv::Mat& gray, const cv::Point2f& pixel) {
  constexpr int kRadius_px = kPatch_px / 2;
  double m_10 = 0.0;
  double m_01 = 0.0;
  for (int dv = -kRadius_px; dv <= kRadius_px; ++dv) {
    for (int du = -kRadius_px; du <= kRadius_px; ++du) {
      if (du * du + dv * dv > kRadius_px * kRadius_px) continue;
      const double intensity = gray.at<std::uint8_t>(cvRound(pixel.y) + dv, cvRound(pixel.x) + du);
      m_10 += du * intensity;
      m_01 += dv * intensity;
    }
  }
  return static_cast<float>(std::atan2(m_01, m_10) * 180.0 / std::numbers::pi);
}

/// The strongest corners of each cell, the strongest of all first.
std::vector<cv::KeyPoint> spread_corners(std::vector<cv::KeyPoint> corners, const cv::Size& size,
                                         std::size_t count) {
  const auto stronger = [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    return std::make_tuple(-a.response, a.pt.y, a.pt.x) < std::make_tuple(-b.response, b.pt.y, b.pt.x);
  };
  std::ranges::sort(corners, stronger);
  const int columns = size.width / kCell_px + 1;
  const int rows = size.height / kCell_px + 1;
  const std::size_t capacity = 1 + 2 * count / static_cast<std::size_t>(columns * rows);
  std::vector<std::size_t> used(static_cast<std::size_t>(columns * rows), 0);
  std::erase_if(corners, [&](const cv::KeyPoint& corner) {
    const int cell =
        static_cast<int>(corner.pt.y) / kCell_px * columns + static_cast<int>(corner.pt.x) / kCell_px;
    return ++used[static_cast<std::size_t>(cell)] > capacity;
  });
  if (corners.size() > count) corners.resize(count);
  return corners;
}

class FeatureBuilder {
 public:
  FeatureBuilder(const DepartedKeyframe& keyframe, const Camera& camera, const LoopConfig& config)
      : keyframe_(keyframe), camera_(camera), config_(config) {
    if (keyframe.gravity_b) g_c_ = keyframe.T_b_c.q.conjugate() * *keyframe.gravity_b;
  }

  void add_tracked_features() {
    for (const StaticFeature& feature : keyframe_.features) {
      cv::KeyPoint corner({feature.pixel.x(), feature.pixel.y()}, kPatch_px);
      add(corner, feature.depth_m, feature.track);
    }
  }

  void add_corners() {
    cv::Mat image = keyframe_.gray;
    float scale = 1.0F;
    for (int level = 0; level < kLevels; ++level) {
      if (level > 0) {
        scale *= kScale;
        cv::resize(keyframe_.gray, image, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
      }
      std::vector<cv::KeyPoint> corners;
      cv::FAST(image, corners, kFastThreshold);
      const auto count =
          static_cast<std::size_t>(kLevelFractions[static_cast<std::size_t>(level)] * config_.max_corners);
      for (cv::KeyPoint& corner : spread_corners(std::move(corners), image.size(), count)) {
        corner.pt *= scale;
        corner.size = kPatch_px * scale;
        corner.octave = level;
        add(corner, consistent_depth(keyframe_, corner.pt));
      }
    }
  }

  [[nodiscard]] std::vector<KeyframeFeature> describe() {
    const cv::Ptr<cv::ORB> orb = cv::ORB::create(config_.max_corners, kScale, kLevels, kBorder_px, 0, 2,
                                                 cv::ORB::HARRIS_SCORE, kPatch_px);
    cv::Mat descriptors;
    orb->compute(keyframe_.gray, corners_, descriptors);
    std::vector<KeyframeFeature> features(corners_.size());
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      std::memcpy(features[i].descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof(Descriptor));
      const auto added = static_cast<std::size_t>(corners_[i].class_id);
      features[i].p_c = points_[added];
      features[i].track = tracks_[added];
    }
    return features;
  }

 private:
  void add(cv::KeyPoint corner, double depth_m, std::int64_t track = -1) {
    if (depth_m < kMinDepth_m || depth_m > kMaxDepth_m) return;
    const Eigen::Vector2f pixel(corner.pt.x, corner.pt.y);
    if (!camera_.contains(pixel.cast<double>(), kBorder_px)) return;
    if (config_.exclude_dynamic && is_dynamic(keyframe_, pixel, depth_m, kDynamicRadius_px)) return;
    const Eigen::Vector2d bearing = camera_.unproject(pixel.cast<double>());
    corner.angle = angle_at(bearing, corner.pt);
    corner.class_id = static_cast<int>(points_.size());
    corners_.push_back(corner);
    tracks_.push_back(track);
    points_.emplace_back((depth_m * Eigen::Vector3d(bearing.x(), bearing.y(), 1.0)).cast<float>());
  }

  [[nodiscard]] float angle_at(const Eigen::Vector2d& bearing, const cv::Point2f& pixel) const {
    if (!g_c_) return centroid_angle(keyframe_.gray, pixel);
    const double angle = std::atan2(g_c_->y() - bearing.y() * g_c_->z(), g_c_->x() - bearing.x() * g_c_->z());
    return static_cast<float>(angle * 180.0 / std::numbers::pi);
  }

  const DepartedKeyframe& keyframe_;
  const Camera& camera_;
  const LoopConfig& config_;
  std::optional<Eigen::Vector3d> g_c_;  ///< unit vector
  std::vector<cv::KeyPoint> corners_;   ///< `class_id`: index into `points_` and `tracks_`
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::int64_t> tracks_;
};

}  // namespace

bool is_dynamic(const DepartedKeyframe& keyframe, const Eigen::Vector2f& pixel, double depth_m,
                double radius_px) {
  const bool masked = std::ranges::any_of(keyframe.regions, [&](const DynamicRegion& region) {
    return contains(region.box, pixel.cast<double>()) && depth_m >= region.near_m && depth_m < region.far_m;
  });
  return masked || std::ranges::any_of(keyframe.dynamic_pixels, [&](const Eigen::Vector2f& dynamic) {
           return (dynamic - pixel).norm() < radius_px;
         });
}

std::vector<KeyframeFeature> keyframe_features(const DepartedKeyframe& keyframe, const Camera& camera,
                                               const LoopConfig& config) {
  FeatureBuilder builder(keyframe, camera, config);
  builder.add_corners();
  builder.add_tracked_features();
  return builder.describe();
}

}  // namespace stillpoint
