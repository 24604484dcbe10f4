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

/// Columns of the image that the trunk covers.
cv::Rect trunk_of(const cv::Size& size, double fraction, std::size_t frame) {
  const int width = cvRound(fraction * size.width);
  const double sway = kSwayWidths * size.width *
                      std::sin(2.0 * std::numbers::pi * static_cast<double>(frame) / kFramesPerSway);
  const int free = size.width - width;
  const int left = std::clamp(cvRound(0.5 * free + sway), 0, free);
  return {left, 0, width, size.height};
}

}  // namespace

Frame with_occluder(Frame frame, double fraction, const OccluderPhase& phase) {
  const cv::Rect trunk = trunk_of(frame.gray.size(), fraction, phase.frame);
  if (trunk.width == 0) return frame;
  const cv::Mat clothes = clothes_of(trunk.size(), phase.seed);
  frame.gray = frame.gray.clone();
  cv::cvtColor(clothes, frame.gray(trunk), cv::COLOR_RGB2GRAY);
  if (!frame.color.empty()) {
    frame.color = frame.color.clone();
    clothes.copyTo(frame.color(trunk));
  }
  if (!frame.depth.empty()) {
    frame.depth = frame.depth.clone();
    frame.depth(trunk).setTo(cvRound(kDistance_m * frame.depth_units_per_m));
  }
  return frame;
}

}  // namespace stillpoint::datasets
