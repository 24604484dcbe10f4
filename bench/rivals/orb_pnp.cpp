// SPDX-License-Identifier: BSD-3-Clause
/// The simplest RGB-D odometry that works: ORB features (Rublee et al., ICCV 2011) of a frame are matched
/// with those of a keyframe, whose depth gives points, and PnP with RANSAC gives the pose. No inertial data,
/// no window, no detector. Arguments: NUMBER_OF_FEATURES MIN_INLIERS.
#include <algorithm>
#include <cmath>
#include <memory>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "bench/rivals/rival_program.h"

namespace stillpoint::rivals {
namespace {

constexpr float kMaxRatio = 0.8F;   // of the two best distances (Lowe 2004)
constexpr double kInlier_px = 3.0;  // reprojection error
constexpr int kRansacSamples = 200;
constexpr double kMinDepth_m = 0.2;
constexpr double kMaxDepth_m = 8.0;
constexpr double kKeyframe_m = 0.2;  // distance, angle and matches after which a keyframe follows
constexpr double kKeyframe_rad = 0.17;
constexpr double kKeyframeRatio = 0.4;

struct Keyframe {
  Pose T_w_k;
  cv::Mat descriptors;                ///< of `points_k`
  std::vector<cv::Point3f> points_k;  ///< in the camera of the keyframe [m]
};

struct Features {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

class OrbTracker {
 public:
  OrbTracker(const Rig& rig, int features, int min_inliers)
      : camera_(rig.camera), orb_(cv::ORB::create(features)), min_inliers_(min_inliers) {}

  std::optional<Pose> track(const Frame& frame) {
    Features features;
    orb_->detectAndCompute(frame.gray, {}, features.keypoints, features.descriptors);
    if (keyframe_.points_k.empty()) {
      set_keyframe(frame, features, Pose{});
      return has_keyframe() ? std::optional<Pose>(Pose{}) : std::nullopt;
    }
    int inliers = 0;
    const std::optional<Pose> T_c_k = located(features, inliers);
    if (!T_c_k) return std::nullopt;
    const Pose T_w_c = keyframe_.T_w_k * T_c_k->inverse();
    const double angle = 2.0 * std::acos(std::min(1.0, std::abs(T_c_k->q.w())));
    const bool is_far = T_c_k->p.norm() > kKeyframe_m || angle > kKeyframe_rad ||
                        inliers < kKeyframeRatio * static_cast<double>(keyframe_.points_k.size());
    if (is_far) set_keyframe(frame, features, T_w_c);
    return T_w_c;
  }

 private:
  [[nodiscard]] bool has_keyframe() const {
    return keyframe_.points_k.size() >= static_cast<std::size_t>(min_inliers_);
  }

  /// The frame replaces the keyframe if it has enough points.
  void set_keyframe(const Frame& frame, const Features& features, const Pose& T_w_k) {
    Keyframe next{.T_w_k = T_w_k, .descriptors = {}, .points_k = {}};
    for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
      const cv::Point2f pixel = features.keypoints[i].pt;
      const double depth_m =
          frame.depth.empty() ? 0.0 : depth_at(frame.depth, frame.depth_units_per_m, pixel.x, pixel.y);
      if (depth_m < kMinDepth_m || depth_m > kMaxDepth_m) continue;
      const Eigen::Vector2d bearing = camera_.unproject({pixel.x, pixel.y});
      next.points_k.emplace_back(static_cast<float>(bearing.x() * depth_m),
                                 static_cast<float>(bearing.y() * depth_m), static_cast<float>(depth_m));
      next.descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
    }
    if (next.points_k.size() >= static_cast<std::size_t>(min_inliers_)) keyframe_ = std::move(next);
  }

  /// T_c_k by PnP in normalized coordinates, which covers all camera models.
  [[nodiscard]] std::optional<Pose> located(const Features& features, int& inlier_count) const {
    if (features.descriptors.rows < min_inliers_) return std::nullopt;
    std::vector<std::vector<cv::DMatch>> matches;
    matcher_.knnMatch(features.descriptors, keyframe_.descriptors, matches, 2);
    std::vector<cv::Point3f> points;
    std::vector<cv::Point2f> bearings;
    for (const std::vector<cv::DMatch>& best : matches) {
      if (best.size() < 2 || best[0].distance > kMaxRatio * best[1].distance) continue;
      const cv::Point2f pixel = features.keypoints[static_cast<std::size_t>(best[0].queryIdx)].pt;
      const Eigen::Vector2d bearing = camera_.unproject({pixel.x, pixel.y});
      points.push_back(keyframe_.points_k[static_cast<std::size_t>(best[0].trainIdx)]);
      bearings.emplace_back(static_cast<float>(bearing.x()), static_cast<float>(bearing.y()));
    }
    if (points.size() < static_cast<std::size_t>(min_inliers_)) return std::nullopt;
    cv::Mat rotation_vector, translation;
    std::vector<int> inliers;
    const bool is_found = cv::solvePnPRansac(
        points, bearings, cv::Mat::eye(3, 3, CV_64F), {}, rotation_vector, translation, false, kRansacSamples,
        static_cast<float>(kInlier_px / camera_.focal_px()), 0.999, inliers, cv::SOLVEPNP_EPNP);
    inlier_count = static_cast<int>(inliers.size());
    if (!is_found || inlier_count < min_inliers_) return std::nullopt;
    const Eigen::Vector3d axis(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                               rotation_vector.at<double>(2));
    Pose T_c_k;
    T_c_k.p = {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)};
    if (axis.norm() > 0.0) T_c_k.q = Eigen::AngleAxisd(axis.norm(), axis.normalized());
    return T_c_k;
  }

  Camera camera_;
  cv::Ptr<cv::ORB> orb_;
  cv::BFMatcher matcher_{cv::NORM_HAMMING};
  int min_inliers_;
  Keyframe keyframe_;
};

Tracker make_tracker(const Rig& rig, const std::vector<std::string>& arguments) {
  const auto number = [&](std::size_t i, int otherwise) {
    return arguments.size() > i ? std::stoi(arguments[i]) : otherwise;
  };
  const auto tracker = std::make_shared<OrbTracker>(rig, number(0, 1000), number(1, 20));
  return [tracker](const Frame& frame) { return tracker->track(frame); };
}

}  // namespace
}  // namespace stillpoint::rivals

int main(int argc, char** argv) {
  return stillpoint::rivals::run_rival(argc, argv, stillpoint::rivals::make_tracker);
}
