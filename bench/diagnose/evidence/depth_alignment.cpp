// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/evidence/depth_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr int kMaxDelay = 3;             // [frames]
constexpr int kMaxShift_px = 12;         // of each direction
constexpr std::size_t kMostImages = 60;  // spread over the recording
constexpr int kLeastImages = 10;
constexpr std::size_t kLeastEdges = 100;  // pixels of a depth image
constexpr std::size_t kMostEdges = 3000;  // of which every nth is used
constexpr float kMostGradient = 30.0F;    // strong texture must not outweigh many edges
constexpr double kDepthStep = 0.05;       // relative; noise of depth cameras is below 2 % up to 5 m
constexpr int kShifts = 2 * kMaxShift_px + 1;
constexpr std::size_t kDelays = 2 * kMaxDelay + 1;

/// Sum of the absolute differences of the neighbors in both directions, clamped.
cv::Mat gradient_of(const cv::Mat& gray) {
  cv::Mat gradient = cv::Mat::zeros(gray.size(), CV_32FC1);
  for (int y = 1; y + 1 < gray.rows; ++y) {
    const auto *above = gray.ptr<std::uint8_t>(y - 1), *row = gray.ptr<std::uint8_t>(y),
               *below = gray.ptr<std::uint8_t>(y + 1);
    auto* const out = gradient.ptr<float>(y);
    for (int x = 1; x + 1 < gray.cols; ++x) {
      const int sum = std::abs(row[x + 1] - row[x - 1]) + std::abs(below[x] - above[x]);
      out[x] = std::min(kMostGradient, static_cast<float>(sum));
    }
  }
  return gradient;
}

/// Pixels with a farther neighbor.
std::vector<cv::Point> depth_edges(const cv::Mat& depth) {
  std::vector<cv::Point> edges;
  for (int y = 0; y + 1 < depth.rows; ++y) {
    const auto *row = depth.ptr<std::uint16_t>(y), *below = depth.ptr<std::uint16_t>(y + 1);
    for (int x = 0; x + 1 < depth.cols; ++x) {
      const auto add = [&](int here, int there, const cv::Point& other) {
        if (here == 0 || there == 0 || std::abs(here - there) <= kDepthStep * std::min(here, there)) return;
        edges.push_back(here < there ? cv::Point(x, y) : other);
      };
      add(row[x], row[x + 1], {x + 1, y});
      add(row[x], below[x], {x, y + 1});
    }
  }
  const std::size_t step = edges.size() / kMostEdges + 1;
  std::vector<cv::Point> used;
  for (std::size_t i = 0; i < edges.size(); i += step) used.push_back(edges[i]);
  return used;
}

/// Mean gradient at the edges, moved; the mean of the image stands for edges that leave it.
double score(const cv::Mat& gradient, double mean, const std::vector<cv::Point>& edges,
             const cv::Point& shift) {
  const cv::Rect image(0, 0, gradient.cols, gradient.rows);
  double sum = 0.0;
  for (const cv::Point& edge : edges) {
    const cv::Point p = edge - shift;
    sum += image.contains(p) ? static_cast<double>(gradient.at<float>(p)) : mean;
  }
  return sum / static_cast<double>(edges.size()) / mean;
}

/// Scores of the images for one delay or shift.
using Scores = std::vector<double>;

double mean_of(const Scores& scores) {
  double sum = 0.0;
  for (const double value : scores) sum += value;
  return sum / static_cast<double>(scores.size());
}

/// Mean of the differences to the others, by its deviation.
double sigmas(const Scores& scores, const Scores& others) {
  const double difference = mean_of(scores) - mean_of(others), count = static_cast<double>(scores.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < scores.size(); ++i) squares += std::pow(scores[i] - others[i] - difference, 2);
  const double deviation = std::sqrt(squares / (count - 1.0) / count);
  return deviation > 0.0 ? difference / deviation : 0.0;
}

struct AlignmentScores {
  std::vector<Scores> delays = std::vector<Scores>(kDelays);
  std::vector<Scores> shifts = std::vector<Scores>(std::size_t{kShifts} * kShifts);

  /// @param edges per delay
  void add(const cv::Mat& gray, const std::vector<std::vector<cv::Point>>& edges) {
    if (std::ranges::any_of(edges, [](const auto& points) { return points.size() < kLeastEdges; })) return;
    const cv::Mat gradient = gradient_of(gray);
    const double mean = cv::mean(gradient)[0];
    if (mean <= 0.0) return;
    for (std::size_t k = 0; k < delays.size(); ++k)
      delays[k].push_back(score(gradient, mean, edges[k], {0, 0}));
    for (std::size_t k = 0; k < shifts.size(); ++k) {
      const int x = static_cast<int>(k) % kShifts - kMaxShift_px,
                y = static_cast<int>(k) / kShifts - kMaxShift_px;
      shifts[k].push_back(score(gradient, mean, edges[kMaxDelay], {x, y}));
    }
  }
};

std::size_t best_of(const std::vector<Scores>& scores) {
  return static_cast<std::size_t>(std::ranges::max_element(scores, {}, mean_of) - scores.begin());
}

/// Adds the image and the depth images around it.
void add_image(const datasets::SensorStream& stream, std::size_t index, AlignmentScores& scores) {
  std::vector<std::vector<cv::Point>> edges;
  cv::Mat gray;
  try {
    for (int delay = -kMaxDelay; delay <= kMaxDelay; ++delay) {
      const Frame frame = stream.load_frame(index + static_cast<std::size_t>(delay + kMaxDelay));
      if (delay == 0) gray = frame.gray;
      if (frame.depth.empty() || frame.depth.size() != frame.gray.size()) return;
      edges.push_back(depth_edges(frame.depth));
    }
  } catch (const InputError&) {
    return;  // the survey of the recording counts frames that cannot be read
  }
  scores.add(gray, edges);
}

}  // namespace

std::optional<DepthAlignment> align_depth(const datasets::SensorStream& stream,
                                          const std::function<bool()>& stop_requested) {
  const std::size_t frames = stream.info().frame_times.size();
  if (frames < kDelays) return std::nullopt;
  const std::size_t step = std::max<std::size_t>(1, (frames - kDelays + 1) / kMostImages);
  AlignmentScores scores;
  for (std::size_t i = 0; i + kDelays <= frames; i += step) {
    if (stop_requested && stop_requested()) return std::nullopt;
    add_image(stream, i, scores);
  }
  DepthAlignment result{.images = static_cast<int>(scores.delays[0].size())};
  if (result.images < kLeastImages) return std::nullopt;
  const Scores& stated = scores.delays[kMaxDelay];
  const std::size_t delay = best_of(scores.delays), shift = best_of(scores.shifts);
  result.delay = static_cast<int>(delay) - kMaxDelay;
  result.delay_sigmas = sigmas(scores.delays[delay], stated);
  result.delay_gain = mean_of(scores.delays[delay]) / mean_of(stated) - 1.0;
  result.shift_px = {static_cast<int>(shift) % kShifts - kMaxShift_px,
                     static_cast<int>(shift) / kShifts - kMaxShift_px};
  result.shift_sigmas = sigmas(scores.shifts[shift], stated);
  result.shift_gain = mean_of(scores.shifts[shift]) / mean_of(stated) - 1.0;
  return result;
}

}  // namespace stillpoint::bench
