// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/depth_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace stillpoint {
namespace {

constexpr double kFarRatio = 1.1;        // least ratio of the depths of both sides
constexpr double kFarthest_m = 4.0;      // of the near side: beyond, a Kinect is coarser than 2 cm
constexpr int kMaxShadow_px = 20;        // missing pixels between the sides
constexpr int kStep_px = 12;             // between rows or columns
constexpr int kHalfLength_px = 4;        // of the line fitted to the edge
constexpr int kMaxShift_px = 6;          // of the edge between the middle and the ends of the line
constexpr std::size_t kMinPoints = 7;    // of 9
constexpr double kMaxResidual_px = 1.0;  // RMS of the line
constexpr double kSimilarRatio = 1.03;   // of depths on the near side
constexpr double kMinGradient = 6.0;     // of an edge of the image, per pixel
constexpr int kHalfWidth_px = 2;         // along the edge, over which the gradient is averaged
constexpr double kMinCosine = 0.866;     // of gradient and normal

/// A depth image, or its transpose, read along one direction.
class Lines {
 public:
  Lines(const cv::Mat& depth, bool transposed) : depth_(depth), transposed_(transposed) {}
  [[nodiscard]] int count() const { return transposed_ ? depth_.cols : depth_.rows; }
  [[nodiscard]] int length() const { return transposed_ ? depth_.rows : depth_.cols; }
  [[nodiscard]] double at(int line, int i) const {
    return transposed_ ? depth_.at<std::uint16_t>(i, line) : depth_.at<std::uint16_t>(line, i);
  }
  /// Whether a near side ends at i, in the direction +1 or -1.
  [[nodiscard]] bool ends(int line, int i, int direction) const {
    const double near = at(line, i);
    if (near == 0.0) return false;
    for (int k = 1; k <= kMaxShadow_px + 1; ++k) {
      const int next = i + k * direction;
      if (next < 0 || next >= length()) return false;
      const double far = at(line, next);
      if (far != 0.0) return far > kFarRatio * near;
    }
    return false;
  }

 private:
  const cv::Mat& depth_;
  bool transposed_;
};

/// Where a near side ends on a line.
struct EdgePoint {
  int i, direction;
  double near;  ///< depth
};

/// Where the same edge crosses another line, nearest to the point; nullopt beyond `kMaxShift_px`.
std::optional<int> same_edge(const Lines& lines, int line, const EdgePoint& edge) {
  for (int k = 0; k <= 2 * kMaxShift_px; ++k) {
    const int j = edge.i + (k % 2 == 0 ? k / 2 : -(k + 1) / 2);
    if (j < 0 || j >= lines.length()) continue;
    const double depth = lines.at(line, j);
    if (depth < edge.near / kSimilarRatio || depth > edge.near * kSimilarRatio) continue;
    if (lines.ends(line, j, edge.direction)) return j;
  }
  return std::nullopt;
}

struct FittedEdge {
  double position, slope;
};

/// A straight line through the edge on neighboring lines, less inclined than 45 degrees.
std::optional<FittedEdge> fitted(const Lines& lines, int line, int i, int direction) {
  std::array<double, 2 * kHalfLength_px + 1> offsets{}, positions{};
  std::size_t n = 0;
  const EdgePoint edge{i, direction, lines.at(line, i)};
  for (int k = -kHalfLength_px; k <= kHalfLength_px; ++k) {
    if (line + k < 0 || line + k >= lines.count()) continue;
    const std::optional<int> found = same_edge(lines, line + k, edge);
    if (!found) continue;
    offsets[n] = k;
    positions[n++] = *found + 0.5 * direction;
  }
  if (n < kMinPoints) return std::nullopt;
  const Eigen::Map<const Eigen::ArrayXd> x(offsets.data(), static_cast<Eigen::Index>(n));
  const Eigen::Map<const Eigen::ArrayXd> y(positions.data(), static_cast<Eigen::Index>(n));
  const Eigen::ArrayXd dx = x - x.mean(), dy = y - y.mean();
  const double slope = (dx * dy).sum() / dx.square().sum();
  const double rms = std::sqrt((dy - slope * dx).square().mean());
  if (std::abs(slope) > 1.0 || rms > kMaxResidual_px) return std::nullopt;
  return FittedEdge{y.mean() - slope * x.mean(), slope};
}

std::vector<DepthEdge> edges_across(const cv::Mat& depth, bool transposed, double units_per_m) {
  const Lines lines(depth, transposed);
  std::vector<DepthEdge> edges;
  for (int line = kStep_px; line < lines.count() - kStep_px; line += kStep_px) {
    for (int i = 1; i < lines.length() - 1; ++i) {
      const double near = lines.at(line, i);
      if (near == 0.0 || near > kFarthest_m * units_per_m) continue;
      for (const int direction : {-1, 1}) {
        if (!lines.ends(line, i, direction)) continue;
        const std::optional<FittedEdge> edge = fitted(lines, line, i, direction);
        if (!edge) continue;
        const Eigen::Vector2d normal = direction * Eigen::Vector2d(1.0, -edge->slope).normalized();
        const Eigen::Vector2d pixel(edge->position, line);
        edges.push_back({.pixel = transposed ? Eigen::Vector2d(pixel.reverse()) : pixel,
                         .normal = transposed ? Eigen::Vector2d(normal.reverse()) : normal,
                         .depth_m = near / units_per_m});
      }
    }
  }
  return edges;
}

/// Bilinear; the pixel is inside by one.
double value_at(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int column = static_cast<int>(pixel.x()), row = static_cast<int>(pixel.y());
  const double a = pixel.x() - column, b = pixel.y() - row;
  const std::uint8_t* const top = image.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* const bottom = image.ptr<std::uint8_t>(row + 1) + column;
  return (1.0 - b) * ((1.0 - a) * top[0] + a * top[1]) + b * ((1.0 - a) * bottom[0] + a * bottom[1]);
}

}  // namespace

std::vector<DepthEdge> depth_edges(const cv::Mat& depth, double units_per_m) {
  std::vector<DepthEdge> edges = edges_across(depth, false, units_per_m);
  const std::vector<DepthEdge> across_columns = edges_across(depth, true, units_per_m);
  edges.insert(edges.end(), across_columns.begin(), across_columns.end());
  return edges;
}

std::optional<double> image_edge(const cv::Mat& image, const Eigen::Vector2d& pixel,
                                 const Eigen::Vector2d& normal, double radius_px) {
  const double margin = radius_px + kHalfWidth_px + 4.0;
  if (!pixel.allFinite() || pixel.x() < margin || pixel.y() < margin || pixel.x() >= image.cols - margin ||
      pixel.y() >= image.rows - margin)
    return std::nullopt;
  const Eigen::Vector2d tangent(-normal.y(), normal.x());
  const auto slope = [&](double s, const Eigen::Vector2d& direction) {
    double sum = 0.0;
    for (int k = -kHalfWidth_px; k <= kHalfWidth_px; ++k) {
      const Eigen::Vector2d at = pixel + s * normal + k * tangent;
      sum += 0.5 * (value_at(image, at + direction) - value_at(image, at - direction));
    }
    return sum / (2 * kHalfWidth_px + 1);
  };
  const int last = static_cast<int>(std::ceil(radius_px)) + 1;
  std::vector<double> gradient;
  for (int s = -last; s <= last; ++s) gradient.push_back(std::abs(slope(s, normal)));
  std::optional<double> nearest;
  for (std::size_t k = 1; k + 1 < gradient.size(); ++k) {
    const double before = gradient[k - 1], here = gradient[k], next = gradient[k + 1];
    if (here < kMinGradient || here < before || here <= next) continue;
    const double s = static_cast<double>(k) - last + 0.5 * (before - next) / (before - 2.0 * here + next);
    if (std::abs(s) > radius_px || (nearest && std::abs(*nearest) < std::abs(s))) continue;
    if (here < kMinCosine * std::hypot(here, slope(s, tangent))) continue;
    nearest = s;
  }
  return nearest;
}

}  // namespace stillpoint
