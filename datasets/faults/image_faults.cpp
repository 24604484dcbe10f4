// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/image_faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// Mean over a line of `length_px` through each pixel; its direction is drawn from the seed.
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

void cut_holes(cv::Mat depth, double fraction, RandomSequence random) {
  for (int v = 0; v < depth.rows; v += kHoleSize_px) {
    for (int u = 0; u < depth.cols; u += kHoleSize_px) {
      const cv::Rect block = cv::Rect(u, v, kHoleSize_px, kHoleSize_px) & cv::Rect({0, 0}, depth.size());
      if (random.chance(fraction)) depth(block).setTo(0);
    }
  }
}

}  // namespace

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
    case FaultKind::kDepthMissing:
      return with_depth(std::move(frame), [](cv::Mat& depth) { depth.setTo(0); });
    case FaultKind::kDepthScaled:
      return with_depth(std::move(frame), [&](cv::Mat& depth) { depth.convertTo(depth, -1, amount); });
    case FaultKind::kDepthHoles:
      return with_depth(std::move(frame),
                        [&](cv::Mat& depth) { cut_holes(depth, amount, fault.random(index + 1)); });
    default:
      STILLPOINT_CHECK(false);
  }
}

}  // namespace stillpoint::datasets
