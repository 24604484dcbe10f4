// SPDX-License-Identifier: BSD-3-Clause
/// Images of a textured plane from known poses: the optical flow between two of them is known exactly.
#pragma once

#include <opencv2/imgproc.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/frame.h"

namespace stillpoint {

inline Camera test_camera() {
  return Camera{.width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 319.5, .cy = 239.5};
}

/// Noise at five scales, 2 to 32 px; the same for the same seed.
inline cv::Mat random_texture(const cv::Size& size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(size, CV_32FC1);
  for (int grain_px = 2; grain_px <= 32; grain_px *= 2) {
    cv::Mat coarse(size.height / grain_px, size.width / grain_px, CV_32FC1);
    random.fill(coarse, cv::RNG::UNIFORM, -1.0, 1.0);
    cv::Mat fine;
    cv::resize(coarse, fine, size, 0.0, 0.0, cv::INTER_CUBIC);
    sum += fine;
  }
  cv::Mat gray;
  sum.convertTo(gray, CV_8UC1, 30.0, 128.0);
  return gray;
}

/// A textured plane z = distance in the frame of a first camera, rendered from other camera poses.
class TexturedPlane {
 public:
  TexturedPlane(const Camera& camera, double distance_m, std::uint64_t seed)
      : camera_(camera), distance_m_(distance_m) {
    texture_ = random_texture(cv::Size(2 * camera.width, 2 * camera.height), seed);
  }

  /// Pixel in the camera at `T_c_first` of the point that the first camera observes at `pixel_first`.
  [[nodiscard]] Eigen::Vector2d pixel_in(const Pose& T_c_first, const Eigen::Vector2d& pixel_first) const {
    return (homography(T_c_first) * pixel_first.homogeneous()).hnormalized();
  }

  [[nodiscard]] cv::Mat gray_at(const Pose& T_c_first) const {
    Eigen::Matrix3d texture_from_first = Eigen::Matrix3d::Identity();
    texture_from_first.topRightCorner<2, 1>() << 0.5 * camera_.width, 0.5 * camera_.height;
    const Eigen::Matrix3d c_from_texture = homography(T_c_first) * texture_from_first.inverse();
    const cv::Matx33d map(c_from_texture(0, 0), c_from_texture(0, 1), c_from_texture(0, 2),
                          c_from_texture(1, 0), c_from_texture(1, 1), c_from_texture(1, 2),
                          c_from_texture(2, 0), c_from_texture(2, 1), c_from_texture(2, 2));
    cv::Mat gray;
    cv::warpPerspective(texture_, gray, map, cv::Size(camera_.width, camera_.height), cv::INTER_CUBIC,
                        cv::BORDER_REFLECT_101);
    return gray;
  }

  /// With constant depth `distance_m`: exact only for translations parallel to the plane.
  [[nodiscard]] Frame frame_at(const Pose& T_c_first, std::int64_t id) const {
    Frame frame;
    frame.id = id;
    frame.t = Timestamp{id * 100'000'000};  // 10 Hz
    frame.gray = gray_at(T_c_first);
    frame.depth = cv::Mat(frame.gray.size(), CV_16UC1, cv::Scalar(distance_m_ * 1000.0));
    return frame;
  }

 private:
  /// K (R + t n^T / d) K^-1 with n = (0, 0, 1): Hartley and Zisserman 2004, Eq. (13.2).
  [[nodiscard]] Eigen::Matrix3d homography(const Pose& T_c_first) const {
    Eigen::Matrix3d K;
    K << camera_.fx, 0.0, camera_.cx, 0.0, camera_.fy, camera_.cy, 0.0, 0.0, 1.0;
    Eigen::Matrix3d motion = T_c_first.R();
    motion.col(2) += T_c_first.p / distance_m_;
    return K * motion * K.inverse();
  }

  Camera camera_;
  double distance_m_;
  cv::Mat texture_;
};

}  // namespace stillpoint
