// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/image_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/materials/surfaces.h"

namespace stillpoint::datasets {
namespace {

constexpr double kDistance_m = 0.45;
constexpr double kFramesPerSway = 60.0;
constexpr double kSwayWidths = 0.04;  // amplitude relative to the width of the image

cv::Mat clothes_of(const cv::Size& size, std::uint64_t seed) {
  synth::RandomSequence random(synth::random_key(seed, synth::RandomStream::kFaults));
  cv::Mat clothes;
  cv::resize(synth::paint_clothes(random), clothes, size, 0.0, 0.0, cv::INTER_LINEAR);
  return clothes;
}

/// Left column of a trunk.
int left_of(int trunk_width, int image_width, std::size_t frame) {
  const double sway = kSwayWidths * image_width *
                      std::sin(2.0 * std::numbers::pi * static_cast<double>(frame) / kFramesPerSway);
  const int free = image_width - trunk_width;
  return std::clamp(cvRound(0.5 * free + sway), 0, free);
}

}  // namespace

Occluder::Occluder(cv::Size image, double fraction, std::uint64_t seed)
    : trunk_(cvRound(fraction * image.width), image.height) {
  if (trunk_.width == 0) return;
  clothes_ = clothes_of(trunk_, seed);
  cv::cvtColor(clothes_, gray_clothes_, cv::COLOR_RGB2GRAY);
}

Frame Occluder::in_front_of(Frame frame, std::size_t index) const {
  if (trunk_.width == 0) return frame;
  const cv::Rect trunk({left_of(trunk_.width, frame.gray.cols, index), 0}, trunk_);
  frame.gray = frame.gray.clone();
  gray_clothes_.copyTo(frame.gray(trunk));
  if (!frame.color.empty()) {
    frame.color = frame.color.clone();
    clothes_.copyTo(frame.color(trunk));
  }
  if (!frame.depth.empty()) {
    frame.depth = frame.depth.clone();
    frame.depth(trunk).setTo(cvRound(kDistance_m * frame.depth_units_per_m));
  }
  return frame;
}

namespace {

using synth::RandomSequence;

constexpr int kHoleSize_px = 16;
constexpr int kSmearSpots = 12;
constexpr std::size_t kFramesPerStep = 20;
constexpr int kNoiseCell_px = 8;

/// Applies `change` to the gray and the color image.
template <class Change>
Frame with_images(Frame frame, const Change& change) {
  frame.gray = change(frame.gray);
  if (!frame.color.empty()) frame.color = change(frame.color);
  return frame;
}

cv::Mat blank(const cv::Mat& image, double level) {
  return {image.size(), image.type(), cv::Scalar::all(level)};
}

cv::Mat exposed(const cv::Mat& image, double factor) {
  cv::Mat result;
  image.convertTo(result, -1, factor);
  return result;
}

/// Mean over a line through each pixel.
/// @param length_px, angle of the line
cv::Mat motion_blurred(const cv::Mat& image, double length_px, double angle) {
  const int radius = static_cast<int>(std::ceil(length_px / 2.0));
  cv::Mat kernel = cv::Mat::zeros(2 * radius + 1, 2 * radius + 1, CV_32F);
  const cv::Point center(radius, radius);
  const cv::Point end(cvRound(0.5 * length_px * std::cos(angle)), cvRound(0.5 * length_px * std::sin(angle)));
  cv::line(kernel, center - end, center + end, cv::Scalar(1.0));
  kernel /= cv::sum(kernel)[0];
  cv::Mat result;
  cv::filter2D(image, result, -1, kernel, cv::Point(-1, -1), 0.0, cv::BORDER_REPLICATE);
  return result;
}

/// Gain of a frame, relative to the exposure of the calibration.
double step_gain(const SensorFault& fault, std::size_t index) {
  synth::RandomSequence random = fault.random(1 + index / kFramesPerStep);
  return std::exp2(fault.amount * random.uniform(-1.0, 1.0));
}

/// Multiplies light by 1 - loss (r / r_corner)^2; r: distance to the image center. Gamma 2.
cv::Mat vignetted(const cv::Mat& image, double loss) {
  const double x_center = 0.5 * (image.cols - 1), y_center = 0.5 * (image.rows - 1);
  const double corner = std::max(x_center * x_center + y_center * y_center, 1.0);
  cv::Mat result = image.clone();
  const int channels = image.channels();
  for (int v = 0; v < image.rows; ++v) {
    auto* row = result.ptr<std::uint8_t>(v);
    for (int u = 0; u < image.cols; ++u) {
      const double x = u - x_center, y = v - y_center;
      const double factor = std::sqrt(std::max(1.0 - loss * (x * x + y * y) / corner, 0.0));
      for (int c = 0; c < channels; ++c, ++row) *row = cv::saturate_cast<std::uint8_t>(factor * *row);
    }
  }
  return result;
}

using Block = Eigen::Matrix<float, 8, 8>;

/// Luminance quantization of ITU-T T.81, Table K.1, scaled by the quality as the Independent JPEG Group does.
Block quantization_steps(double quality) {
  Block table;
  table << 16, 11, 10, 16, 24, 40, 51, 61,  //
      12, 12, 14, 19, 26, 58, 60, 55,       //
      14, 13, 16, 24, 40, 57, 69, 56,       //
      14, 17, 22, 29, 51, 87, 80, 62,       //
      18, 22, 37, 56, 68, 109, 103, 77,     //
      24, 35, 55, 64, 81, 104, 113, 92,     //
      49, 64, 78, 87, 103, 121, 120, 101,   //
      72, 92, 95, 98, 112, 100, 103, 99;
  const double percent = quality < 50.0 ? 5000.0 / quality : 200.0 - 2.0 * quality;
  const auto scale = static_cast<float>(percent / 100.0);
  return (table * scale).array().round().max(1.0F).min(255.0F);
}

/// Orthonormal discrete cosine transform: C x C^T transforms a block.
Block cosine_transform() {
  Block transform;
  for (int k = 0; k < 8; ++k) {
    for (int n = 0; n < 8; ++n) {
      const double scale = k == 0 ? std::sqrt(1.0 / 8.0) : 0.5;
      transform(k, n) = static_cast<float>(scale * std::cos(std::numbers::pi * (2 * n + 1) * k / 16.0));
    }
  }
  return transform;
}

/// Quantizes the transform of each block of 8x8 pixels, in each channel. Pixels beyond the edge repeat it.
cv::Mat compressed(const cv::Mat& image, double quality) {
  const Block steps = quantization_steps(quality), transform = cosine_transform();
  constexpr float kMiddle = 128.0F;
  const int channels = image.channels();
  cv::Mat result(image.size(), image.type());
  const auto for_each_pixel = [&](int v, int u, const auto& visit) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x)
        visit(y, x, std::min(v + y, image.rows - 1), std::min(u + x, image.cols - 1));
    }
  };
  const auto compress_block = [&](int v, int u, int c) {
    Block block;
    for_each_pixel(v, u, [&](int y, int x, int row, int column) {
      block(y, x) = static_cast<float>(image.ptr<std::uint8_t>(row)[column * channels + c]) - kMiddle;
    });
    const Block frequencies = transform * block * transform.transpose();
    const Block kept = (frequencies.array() / steps.array()).round() * steps.array();
    const Block decoded = transform.transpose() * kept * transform;
    for_each_pixel(v, u, [&](int y, int x, int row, int column) {
      if (v + y == row && u + x == column)
        result.ptr<std::uint8_t>(row)[column * channels + c] =
            cv::saturate_cast<std::uint8_t>(decoded(y, x) + kMiddle);
    });
  };
  for (int v = 0; v < image.rows; v += 8) {
    for (int u = 0; u < image.cols; u += 8) {
      for (int c = 0; c < channels; ++c) compress_block(v, u, c);
    }
  }
  return result;
}

/// u' = u + shear v / (height - 1): row v is displaced in proportion to its time of readout.
cv::Mat sheared(const cv::Mat& image, double last_row_px) {
  const double slope = last_row_px / std::max(image.rows - 1, 1);
  const cv::Mat transform = (cv::Mat_<double>(2, 3) << 1.0, slope, 0.0, 0.0, 1.0, 0.0);
  cv::Mat result;
  cv::warpAffine(image, result, transform, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

/// Elliptical spots with random centers that cover about `fraction` of the image.
cv::Mat smear_mask(cv::Size size, double fraction, RandomSequence random) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  const double area = fraction * size.area() / kSmearSpots;
  for (int i = 0; i < kSmearSpots; ++i) {
    const int y = random.index(size.height), x = random.index(size.width);
    const double aspect = random.uniform(0.5, 2.0);
    const double radius = std::sqrt(area / std::numbers::pi * aspect);
    cv::ellipse(mask, {x, y}, cv::Size(cvRound(radius), cvRound(radius / aspect)), random.uniform(0.0, 180.0),
                0.0, 360.0, cv::Scalar(255), cv::FILLED);
  }
  return mask;
}

cv::Mat smeared(const cv::Mat& image, const cv::Mat& mask) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), image.cols / 30.0);
  cv::Mat result = image.clone();
  blurred.copyTo(result, mask);
  return result;
}

/// Copies `depth` and calls change(copy).
template <class Change>
Frame with_depth(Frame frame, const Change& change) {
  if (frame.depth.empty()) return frame;
  frame.depth = frame.depth.clone();
  change(frame.depth);
  return frame;
}

void cut_holes(cv::Mat& depth, double fraction, RandomSequence random) {
  for (int v = 0; v < depth.rows; v += kHoleSize_px) {
    for (int u = 0; u < depth.cols; u += kHoleSize_px) {
      const cv::Rect block = cv::Rect(u, v, kHoleSize_px, kHoleSize_px) & cv::Rect({0, 0}, depth.size());
      if (random.chance(fraction)) depth(block).setTo(0);
    }
  }
}

/// Applies change(z), with z in meters, to each measured depth.
template <class Change>
void change_depths(cv::Mat depth, double units_per_m, const Change& change) {
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      auto& raw = depth.at<std::uint16_t>(v, u);
      if (raw > 0) raw = cv::saturate_cast<std::uint16_t>(units_per_m * change(raw / units_per_m, v, u));
    }
  }
}

/// Displaces by the nearest number of pixels; what enters the image is not measured.
void displace(cv::Mat& depth, double distance_px, RandomSequence random) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const cv::Mat transform = (cv::Mat_<double>(2, 3) << 1.0, 0.0, distance_px * std::cos(angle), 0.0, 1.0,
                             distance_px * std::sin(angle));
  cv::Mat displaced;
  cv::warpAffine(depth, displaced, transform, depth.size(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0.0);
  depth = displaced;
}

/// Normal numbers at the corners of cells, interpolated between them: unit variance on average, correlated
/// over the size of a cell. The mean square of the weights of a bilinear interpolation is (2/3)^2.
cv::Mat correlated_noise(cv::Size size, RandomSequence random) {
  cv::Mat corners(size.height / kNoiseCell_px + 2, size.width / kNoiseCell_px + 2, CV_32F);
  for (int v = 0; v < corners.rows; ++v) {
    for (int u = 0; u < corners.cols; ++u)
      corners.at<float>(v, u) = static_cast<float>(1.5 * random.normal());
  }
  cv::Mat noise;
  cv::resize(corners, noise, cv::Size(), kNoiseCell_px, kNoiseCell_px, cv::INTER_LINEAR);
  return noise;
}

void add_noise(cv::Mat& depth, double units_per_m, double per_m, RandomSequence random) {
  const cv::Mat noise = correlated_noise(depth.size(), random);
  change_depths(depth, units_per_m,
                [&](double z, int v, int u) { return z + per_m * z * z * noise.at<float>(v, u); });
}

/// Faults of depth that need nothing but the frame.
Frame with_depth_fault(Frame frame, const SensorFault& fault, std::size_t index) {
  const double amount = fault.amount, units_per_m = frame.depth_units_per_m;
  return with_depth(std::move(frame), [&](cv::Mat& depth) {
    switch (fault.kind) {
      case FaultKind::kDepthMissing:
        return void(depth.setTo(0));
      case FaultKind::kDepthScaled:
        return depth.convertTo(depth, -1, amount);
      case FaultKind::kDepthHoles:
        return cut_holes(depth, amount, fault.random(index + 1));
      case FaultKind::kDepthBias:
        return change_depths(depth, units_per_m, [&](double z, int, int) { return z + amount * z * z; });
      case FaultKind::kDepthShift:
        return displace(depth, amount, fault.random());
      case FaultKind::kDepthNoise:
        return add_noise(depth, units_per_m, amount, fault.random(index + 1));
      default:
        STILLPOINT_CHECK(false);
    }
  });
}

}  // namespace

Frame blurred_along(Frame frame, const Eigen::Vector2d& line_px) {
  const double length_px = line_px.norm(), angle = std::atan2(line_px.y(), line_px.x());
  if (length_px < 1.0) return frame;
  return with_images(std::move(frame),
                     [&](const cv::Mat& image) { return motion_blurred(image, length_px, angle); });
}

Frame frame_with_fault(Frame frame, const SensorFault& fault, std::size_t index) {
  const double amount = fault.amount;
  switch (fault.kind) {
    case FaultKind::kBlank:
      return with_images(std::move(frame), [&](const cv::Mat& image) { return blank(image, amount); });
    case FaultKind::kExposure:
      return with_images(std::move(frame), [&](const cv::Mat& image) { return exposed(image, amount); });
    case FaultKind::kMotionBlur: {
      const double angle = fault.random().uniform(0.0, std::numbers::pi);
      return with_images(std::move(frame),
                         [&](const cv::Mat& image) { return motion_blurred(image, amount, angle); });
    }
    case FaultKind::kRollingShutter:
      return with_images(std::move(frame), [&](const cv::Mat& image) { return sheared(image, amount); });
    case FaultKind::kLensSmear: {
      const cv::Mat mask = smear_mask(frame.gray.size(), amount, fault.random());
      return with_images(std::move(frame), [&](const cv::Mat& image) { return smeared(image, mask); });
    }
    case FaultKind::kExposureSteps: {
      const double factor = std::sqrt(step_gain(fault, index));  // gamma 2
      return with_images(std::move(frame), [&](const cv::Mat& image) { return exposed(image, factor); });
    }
    case FaultKind::kVignetting:
      return with_images(std::move(frame), [&](const cv::Mat& image) { return vignetted(image, amount); });
    case FaultKind::kJpeg:
      return with_images(std::move(frame), [&](const cv::Mat& image) { return compressed(image, amount); });
    default:
      return with_depth_fault(std::move(frame), fault, index);
  }
}

}  // namespace stillpoint::datasets
