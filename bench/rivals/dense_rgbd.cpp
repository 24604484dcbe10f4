// SPDX-License-Identifier: BSD-3-Clause
/// The dense odometries of OpenCV's module rgbd, frame to frame or to keyframe: photometric (Steinbruecker et
/// al. 2011), point to plane (ICP), and both. Arguments: METHOD REFERENCE, METHOD one of RgbdOdometry,
/// ICPOdometry, RgbdICPOdometry and FastICPOdometry, REFERENCE frame or keyframe.
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>

#include "bench/rivals/rival_program.h"
#include "core/base/error.h"

namespace stillpoint::rivals {
namespace {

constexpr double kKeyframe_m = 0.1;  // distance and angle after which a keyframe follows
constexpr double kKeyframe_rad = 0.1;

class DenseTracker {
 public:
  DenseTracker(const Rig& rig, const std::string& method, bool uses_keyframes)
      : odometry_(cv::rgbd::Odometry::create(method)), uses_keyframes_(uses_keyframes) {
    const Camera& camera = rig.camera;
    if (odometry_.empty()) throw InputError(method, "is no odometry of OpenCV; e.g. RgbdICPOdometry");
    if (camera.model != CameraModel::kRadialTangential && camera.has_distortion())
      throw InputError("camera", "fisheye lenses are not supported by OpenCV's rgbd module");
    K_ = (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    if (camera.has_distortion()) {
      const std::vector<double> coefficients(camera.distortion.begin(), camera.distortion.end());
      cv::initUndistortRectifyMap(K_, coefficients, {}, K_, {camera.width, camera.height}, CV_32FC1, map_u_,
                                  map_v_);
    }
    odometry_->setCameraMatrix(K_);
  }

  std::optional<Pose> track(const Frame& frame) {
    cv::Ptr<cv::rgbd::OdometryFrame> current = prepared(frame);
    if (!reference_) {
      reference_ = current;
      return T_w_r_;
    }
    cv::Mat Rt;
    const bool is_found = odometry_->compute(reference_, current, Rt, last_Rt_);
    if (!is_found || Rt.empty()) return lost(current);
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) matrix(row, column) = Rt.at<double>(row, column);
    }
    const Pose T_c_r = Pose::from_matrix(matrix);
    const Pose T_w_c = T_w_r_ * T_c_r.inverse();
    const double angle = 2.0 * std::acos(std::min(1.0, std::abs(T_c_r.q.w())));
    last_Rt_ = Rt;
    T_w_last_ = T_w_c;
    if (!uses_keyframes_ || T_c_r.p.norm() > kKeyframe_m || angle > kKeyframe_rad)
      set_reference(current, T_w_c);
    return T_w_c;
  }

 private:
  /// Gray image and depth in meters, NaN where it is not measured, without distortion.
  [[nodiscard]] cv::Ptr<cv::rgbd::OdometryFrame> prepared(const Frame& frame) const {
    cv::Mat depth_m;
    frame.depth.convertTo(depth_m, CV_32F, 1.0 / frame.depth_units_per_m);
    depth_m.setTo(std::numeric_limits<float>::quiet_NaN(), frame.depth == 0);
    cv::Mat gray = frame.gray.clone();
    if (!map_u_.empty()) {
      cv::remap(frame.gray, gray, map_u_, map_v_, cv::INTER_LINEAR);
      cv::Mat raw = depth_m;
      cv::remap(raw, depth_m, map_u_, map_v_, cv::INTER_NEAREST, cv::BORDER_CONSTANT,
                std::numeric_limits<float>::quiet_NaN());
    }
    return cv::makePtr<cv::rgbd::OdometryFrame>(gray, depth_m);
  }

  /// Without a result the motion since the last frame is unknown; the next one is relative to this frame.
  std::optional<Pose> lost(const cv::Ptr<cv::rgbd::OdometryFrame>& current) {
    set_reference(current, T_w_last_);
    return std::nullopt;
  }

  void set_reference(const cv::Ptr<cv::rgbd::OdometryFrame>& frame, const Pose& T_w_c) {
    reference_ = frame;
    T_w_r_ = T_w_c;
    last_Rt_ = cv::Mat();
  }

  cv::Ptr<cv::rgbd::Odometry> odometry_;
  bool uses_keyframes_;
  cv::Mat K_, map_u_, map_v_;
  cv::Ptr<cv::rgbd::OdometryFrame> reference_;
  Pose T_w_r_;     ///< of the reference
  Pose T_w_last_;  ///< of the last frame with a pose
  cv::Mat last_Rt_;
};

Tracker make_tracker(const Rig& rig, const std::vector<std::string>& arguments) {
  const std::string method = arguments.empty() ? "RgbdICPOdometry" : arguments[0];
  const bool uses_keyframes = arguments.size() > 1 && arguments[1] == "keyframe";
  const auto tracker = std::make_shared<DenseTracker>(rig, method, uses_keyframes);
  return [tracker](const Frame& frame) { return tracker->track(frame); };
}

}  // namespace
}  // namespace stillpoint::rivals

int main(int argc, char** argv) {
  return stillpoint::rivals::run_rival(argc, argv, stillpoint::rivals::make_tracker);
}
