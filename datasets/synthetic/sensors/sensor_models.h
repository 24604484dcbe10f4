// SPDX-License-Identifier: BSD-3-Clause
/// Models of the sensors: a color camera (vignetting, exposure, shot and read noise, response curve), an
/// active-stereo depth camera that is registered to it, and a person detector, with the true bounding boxes
/// of the moving objects in a rendered frame.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "core/types/detection.h"
#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/render/frame_renderer.h"

namespace stillpoint::synth {

/// Photon-transfer model of a camera (EMVA Standard 1288, 2016). Per pixel and channel
///
///   s = min(gain * v(theta) * L, 1),   v(theta) = 1 - vignetting * (1 - cos^4 theta)
///   I = round(255 * sqrt(clamp(s + sigma * n, 0, 1))),   sigma^2 = read_noise^2 + shot_noise * s
///
/// L: radiance; s: signal relative to saturation; theta: angle to the optical axis; n ~ N(0, 1). The defaults
/// describe a 1/4-inch webcam sensor with a well depth of 6000 electrons.
struct ColorSensor {
  double exposure_s = 0.008;   ///< exposure time; determines motion blur
  double read_noise = 0.004;   ///< standard deviation relative to saturation
  double shot_noise = 1.7e-4;  ///< 1 / well depth
  double vignetting = 0.5;  ///< fraction of the natural cos^4 fall-off (Kingslake) not corrected by the lens
  double exposure_swing =
      0.0;  ///< amplitude of slow brightness changes not compensated by auto-exposure [stops]
  double exposure_period_s = 7.0;  ///< period of these changes
};

/// Gain of the frame taken `t_s` seconds after the start.
[[nodiscard]] double exposure_gain(const ColorSensor& sensor, double t_s);

/// What differs from frame to frame.
struct FrameExposure {
  double gain = 1.0;  ///< scene gain times `exposure_gain`
  std::uint64_t noise_key = 0;
};

/// Applies the sensor model.
/// @return CV_8UC3 (R, G, B); gamma 2
[[nodiscard]] cv::Mat simulate_color(const RenderedFrame& frame, const Camera& camera,
                                     const ColorSensor& sensor, const FrameExposure& exposure);

/// RealSense D435 (Keselman et al. 2017; Ahn et al. 2019). Noise acts on the disparity, so that depth noise
/// grows quadratically, sigma_z = noise_per_m * z^2:
///
///   d = fb / z + n * noise_per_m * fb,   d' = step * round(d / step),   z' = fb / d'
///
/// z: true depth; fb = focal_baseline_px_m; step = disparity_step_px; n: unit-variance noise, partly
/// correlated between neighbors. Pixels visible to only one imager are holes.
struct DepthSensor {
  double noise_per_m = 0.0016;  ///< [1/m]; a disparity error of 0.05 px at focal_baseline 30
  double correlated_fraction =
      0.8;                 ///< of the noise's standard deviation; correlation comes from the matching window
  int correlation_px = 6;  ///< size of that window
  double focal_baseline_px_m = 30.5;   ///< 610 px times 0.05 m
  double disparity_step_px = 0.03125;  ///< 1/32 px; 0 = not quantized
  double min_m = 0.3;                  ///< holes below
  double max_m = 8.0;                  ///< holes above
  double edge_dropout =
      0.5;  ///< probability of a hole at a depth discontinuity; 0 also disables stereo shadows
  double units_per_m = 1000.0;
};

struct TrueDepth {
  std::span<const float> depth_m;  ///< row-major; 0 = no surface
  int width = 0;
  int height = 0;
};

/// Applies the sensor model.
/// @return CV_16UC1 in units of 1 / units_per_m; 0 = no measurement
[[nodiscard]] cv::Mat simulate_depth(const TrueDepth& depth, const DepthSensor& sensor,
                                     std::uint64_t noise_key);

/// Detector errors. Misses occur in bursts: a two-state Markov chain per object (Gilbert 1960).
struct DetectorModel {
  double miss_rate = 0.15;            ///< fraction of missed frames among those in which an object is visible
  double burst_frames = 4.0;          ///< mean length of a run of misses [frames]
  double jitter_ratio = 0.02;         ///< standard deviation of each edge / box size
  double false_positive_rate = 0.02;  ///< fraction of frames with a false positive
  int min_height_px = 24;             ///< smaller objects are not detected
};

/// The visible part of one object.
struct VisibleObject {
  int object = 0;
  int pixels = 0;
  Box box;  ///< outer pixel edges: pixel i covers [i - 0.5, i + 0.5]
};

/// All objects with at least one pixel, ordered by instance number.
[[nodiscard]] std::vector<VisibleObject> visible_objects(const RenderedFrame& frame);

/// Class name of each moving object by its instance number.
using ObjectClasses = std::map<int, std::string>;

/// True boxes as detections of score 1.
[[nodiscard]] std::vector<Detection> true_detections(std::span<const VisibleObject> visible,
                                                     const ObjectClasses& classes);

/// Output of a person detector with the errors of a model, frame by frame.
class SimulatedPersonDetector {
 public:
  SimulatedPersonDetector(const DetectorModel& model, const cv::Size& image, std::uint64_t seed);

  /// @param visible objects of the next frame
  [[nodiscard]] std::vector<Detection> detect(std::span<const VisibleObject> visible);

 private:
  [[nodiscard]] bool misses(int object);

  DetectorModel model_;
  cv::Size image_;
  RandomSequence random_;
  std::map<int, bool> missing_;  ///< state of each object in the Markov chain
};

}  // namespace stillpoint::synth
