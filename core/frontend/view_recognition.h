// SPDX-License-Identifier: BSD-3-Clause
/// Recognizes features that were lost with the view, e.g. in blank images, and gives them their ids back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/types/tracked_frame.h"

namespace stillpoint {

/// When nearly all tracks end at once, the last image and its features are kept. Until the view returns, the
/// new features of each frame are compared with them by upright ORB descriptors: nearest neighbors in both
/// directions, at most 64 of 256 bits apart, and at most 0.8 times the distance of the second nearest.
class ViewRecognition {
 public:
  /// Replaces the ids of recognized features, from then on in each frame; keeps the order by id.
  /// @param gray image of the frame
  [[nodiscard]] TrackedFrame process(const cv::Mat& gray, TrackedFrame frame);

  /// The ids that the tracker knows the features by, sorted.
  /// @param recycled a result that is no longer needed; its memory is reused
  [[nodiscard]] std::vector<std::int64_t> tracker_ids(std::span<const std::int64_t> ids,
                                                      std::vector<std::int64_t> recycled) const;

 private:
  struct View {
    cv::Mat gray;
    std::vector<std::int64_t> ids;
    std::vector<cv::Point2f> pixels;
  };
  struct Alias {
    std::int64_t tracker_id = 0;
    std::int64_t id = 0;
  };
  void recognize(const View& view);

  View last_;                 ///< the last frame
  std::optional<View> lost_;  ///< the last frame before the loss
  int attempts_ = 0;          ///< to recognize the lost view
  std::vector<Alias> aliases_;
};

}  // namespace stillpoint
