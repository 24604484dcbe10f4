// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/faults/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

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

}  // namespace stillpoint::datasets
