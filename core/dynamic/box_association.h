// SPDX-License-Identifier: BSD-3-Clause
/// Data association of detected boxes with tracked objects. Paper Sec. III-D does not specify it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/detection.h"

namespace stillpoint {

/// Predicted position of a tracked object in the current image [px].
struct PredictedBox {
  std::string class_name;
  Box box;   ///< last detected box, displaced by its velocity. Eq. (5)
  Box gate;  ///< `box`, grown by the allowed position error
};

/// Greedy one-to-one assignment of detections to objects of the same class. Stateless between calls; an
/// instance only recycles its buffers.
///
/// Stage 1 assigns by decreasing overlap (IoU) of the detection with the predicted box, down to `min_iou`.
/// Stage 2 assigns the remainder by increasing distance between the box centers, provided that the center of
/// the detection lies inside the gate of the object. Ties are resolved by the lower object index, then by the
/// lower detection index.
class BoxAssociation {
 public:
  /// @param objects    with positive area
  /// @param detections with positive area
  /// @param min_iou    in (0, 1]
  /// @return for each detection the index of its object, or nullopt; valid until the next call
  [[nodiscard]] const std::vector<std::optional<std::size_t>>& associate(
      std::span<const PredictedBox> objects, std::span<const Detection> detections, double min_iou);

 private:
  struct Candidate {
    double cost = 0.0;
    std::size_t object = 0;
    std::size_t detection = 0;
  };

  template <class Cost>
  void assign_greedily(std::span<const PredictedBox> objects, std::span<const Detection> detections,
                       const Cost& cost);

  std::vector<Candidate> candidates_;
  std::vector<bool> object_assigned_;  ///< by object index
  std::vector<std::optional<std::size_t>> object_of_;
};

}  // namespace stillpoint
