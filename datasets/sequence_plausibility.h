// SPDX-License-Identifier: BSD-3-Clause
/// Checks of the sensor data of a sequence against each other: units, axes and clocks.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/frame.h"
#include "datasets/image_motion.h"
#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

inline constexpr double kLeastDepth_m = 0.3;     ///< RealSense and Kinect measure from 0.3 m on
inline constexpr double kLargestDepth_m = 12.0;  ///< and at most to about 10 m

/// Whether the ratio of two rates of rotation is that of deg/s to rad/s: 57.3, or less with noise.
[[nodiscard]] constexpr bool is_degrees_ratio(double ratio) { return ratio > 25.0 && ratio < 130.0; }

/// Units of the inertial samples, where they can be told: a mean acceleration that is not about gravity, and
/// angular rates that are 180 / pi times those of the ground truth (by the rotation between poses 0.1 s
/// apart), or of which half exceed 5 rad/s.
[[nodiscard]] std::vector<std::string> imu_unit_findings(const SequenceInfo& info);

/// Depth images of floats are in meters. Measurements of which 95 % are beyond 12 m, or below 0.3 m, are in
/// another unit, such as millimeters.
/// @param measurements positive and finite
/// @return the finding; nullopt if there is none, or no measurement
[[nodiscard]] std::optional<std::string> float_depth_finding(const std::vector<float>& measurements);

/// Compares gravity with the images: the mean specific force of a camera that is held upright points up, that
/// is, along -y of the camera. Another direction (by more than 60 degrees) indicates swapped axes, an
/// inverted sign, or a wrong T_b_c.
/// @return the finding; nullopt if there is none, or no IMU
[[nodiscard]] std::optional<std::string> gravity_finding(const SequenceInfo& info);

/// By how much the depth of a recording must be larger for its images to follow the true motion.
struct DepthScaleByTruth {
  double factor = 1.0;  ///< 1/5 or 5
  int pairs = 0;        ///< of frames that tell it
  int all_pairs = 0;    ///< that tell a factor
};

/// Collects what the images of a sequence tell about the other sensors, one frame after the other.
class ImagePlausibility {
 public:
  explicit ImagePlausibility(const SequenceInfo& info) : info_(info), image_motion_(info.rig.camera) {}

  /// @param frame the next one; a frame that cannot be decoded is left out
  void add(const Frame& frame);
  /// What `add` collects for `depth_unit_finding` alone.
  void add_depth(const Frame& frame);
  /// What `add` collects for `depth_scale_by_truth` alone.
  void compare_depth(const Frame& frame);

  /// Depth whose smallest values (5 %) are below 0.3 m, or whose largest (5 %) are beyond 12 m, is not that
  /// of an RGB-D camera: millimeters that are read as 1/5000 m, or the other way round.
  [[nodiscard]] std::optional<std::string> depth_unit_finding() const;

  /// Compares the scale of depth with the motion of the ground truth: the pixels of a frame are moved into a
  /// later one by their depth, times 1/5, 1 and 5, and the true motion. The factor 1 should give the smallest
  /// difference of gray values, by the frames of which most tell it.
  /// @return nullopt if the factor is 1, without ground truth, and without motion
  [[nodiscard]] std::optional<DepthScaleByTruth> depth_scale_by_truth() const;
  /// @return the finding of `depth_scale_by_truth`
  [[nodiscard]] std::optional<std::string> depth_scale_finding() const;

  /// Compares the rates of the gyroscope with the rotation between images (`ImageMotion`), without ground
  /// truth: sum |w| |w_image| / sum |w_image|^2 is 180 / pi in deg/s.
  /// @return the finding; nullopt if there is none, or no rotation that both sensors see
  [[nodiscard]] std::optional<std::string> gyro_unit_finding() const;

  /// Compares the scale of depth with the accelerometer, without ground truth. The motion between images has
  /// the scale s of the true depth to the stated one. With the position P and rotation R of the camera by
  /// images, the specific force f and gravity g, over times t_i < t_j < t_k of 0.2 s each,
  ///   s [(P_k - P_j) / (t_k - t_j) - (P_j - P_i) / (t_j - t_i)] = integral w(t) (R f + g) dt,
  /// where w rises from 0 at t_i to 1 at t_j and falls to 0 at t_k. g is solved for in blocks of 1.5 s, in
  /// which the rotation drifts little; blocks whose sides have a correlation below 0.7 are left out.
  /// @return the finding if s is beyond 1/3 and 3; nullopt if the accelerations do not follow the images
  [[nodiscard]] std::optional<std::string> depth_motion_finding() const;

  /// Compares the clocks of camera and IMU. The horizontal shift d [px] between the column means of two
  /// images is d = -fx w_y dt for a rotation with the rate w_y about the y axis of the camera. The offset of
  /// the clocks maximizes the correlation of -d / (fx dt) with the mean of w_y over the interval, shifted by
  /// the offset. Sequences with fewer than 60 pairs of images, that turn too little, whose images do not
  /// follow the rotation, or whose halves disagree about the offset, have no result.
  /// @return the finding if the offset exceeds 30 ms
  [[nodiscard]] std::optional<std::string> clock_finding() const;

 private:
  /// Rate of turn between two frames, from their images.
  struct Turn {
    Timestamp from;
    Timestamp to;
    double rate = 0.0;  ///< about the y axis of the camera [rad/s]
  };

  /// Correlation of the images with the gyroscope.
  struct ClockOffset {
    double offset_s = 0.0;     ///< beyond the known one, with the largest correlation
    double correlation = 0.0;  ///< with it
    double without = 0.0;      ///< with the known offset
  };

  [[nodiscard]] double correlation_at(double offset_s, std::span<const Turn> turns,
                                      const std::vector<double>& angle) const;
  [[nodiscard]] ClockOffset best_offset(std::span<const Turn> turns, const std::vector<double>& angle) const;

  /// A frame that later ones are compared with.
  struct DepthFrame {
    Pose T_w_c;
    std::vector<Eigen::Vector3d> points_c;  ///< sampled pixels with depth
    std::vector<double> gray;               ///< of these pixels
    double median_m = 0.0;                  ///< of the depths
  };

  /// The motion between two frames, by their images.
  struct Motion {
    Timestamp from;
    Timestamp to;
    Pose T_to_from;  ///< coordinates of the camera
  };

  void add_motion(const Frame& frame);
  /// Sums of s for a block of consecutive motions: of products of both sides, without their common gravity.
  struct ScaleSums {
    double images = 0.0;    ///< squares of the left side
    double both = 0.0;      ///< products
    double inertial = 0.0;  ///< squares of the right side
  };
  [[nodiscard]] ScaleSums scale_sums(std::span<const Motion> block) const;

  const SequenceInfo& info_;
  std::optional<DepthFrame> reference_;
  std::array<int, 3> best_scale_{};   ///< number of pairs of frames for which 1/5, 1 and 5 fit best
  std::vector<double> last_profile_;  ///< column means of the last frame
  Timestamp last_t_;
  std::vector<Turn> turns_;
  std::vector<float> depths_m_;  ///< samples of all frames
  ImageMotion image_motion_;
  Timestamp last_motion_t_;
  std::vector<Motion> motions_;  ///< of the first 600 frames of a sequence with an IMU
};

}  // namespace stillpoint::datasets
