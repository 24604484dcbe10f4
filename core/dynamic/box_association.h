// SPDX-License-Identifier: BSD-3-Clause
/// Which detected box is which known object. Paper Sec. III-D is silent on it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/detection.h"

namespace stillpoint {

/// Where a known object should be in the present picture [px].
struct ExpectedBox {
  std::string class_name;
  Box predicted;  ///< moved on by its velocity
  Box reach;      ///< the same, grown by how far it may have strayed
};

/// Joins objects and detections of the same class one to one. Kept between pictures for its memory only.
///
/// First pairs by falling overlap (IoU) of the detection with the predicted box, down to `min_iou`; then what
/// is left by rising distance of the centres, where the detection's centre lies in the object's reach. Of
/// equals, the earlier object comes first, then the earlier detection.
class BoxAssociation {
 public:
  /// @param objects    with area
  /// @param detections with area
  /// @param min_iou    in (0, 1]
  /// @return for each detection the index of its object, or nothing; valid until the next call
  [[nodiscard]] const std::vector<std::optional<std::size_t>>& associate(
      std::span<const ExpectedBox> objects, std::span<const Detection> detections, double min_iou);

 private:
  struct Pair {
    double cost = 0.0;
    std::size_t object = 0;
    std::size_t detection = 0;
  };

  template <class Cost>
  void join(std::span<const ExpectedBox> objects, std::span<const Detection> detections, const Cost& cost);

  std::vector<Pair> pairs_;
  std::vector<bool> taken_;  ///< objects
  std::vector<std::optional<std::size_t>> object_of_;
};

}  // namespace stillpoint
