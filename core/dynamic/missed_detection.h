// SPDX-License-Identifier: BSD-3-Clause
/// Missed detection compensation: propagates boxes through frames without a detection. Paper Sec. III-D.
///
/// With u_c^{c_j} the center [px] of the box of the K-th object in the current frame j, and j-1 the previous
/// frame with a detection of it:
///
///   Eq. (3)  v^{c_j}         = u_c^{c_j} - u_c^{c_{j-1}}      pixel velocity [px/frame]
///   Eq. (4)  v_hat^{c_{j+1}} = 1/2 (v^{c_j} + v_hat^{c_j})    weighted velocity; initially v_hat = 0
///   Eq. (5)  Box^{c_{j+1}}   = Box^{c_j} + v_hat^{c_{j+1}}    if the object is not detected in frame j+1
///
/// Box denotes the corners u_tl, u_tr, u_bl, u_br of the bounding box; Eq. (5) displaces all of them. The
/// paper assumes adjacent frames; over a gap of n frames Eq. (3) is divided by n. Eq. (5) is applied once per
/// frame until the object is detected again or abandoned.
///
/// The paper does not specify how detections are assigned to objects, see BoxAssociation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/config/dynamic_config.h"
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

/// Tracks the boxes of dynamic objects; one call of `update` per frame. Detections are assigned to objects by
/// BoxAssociation, with the predicted and grown box as the gate of an object.
class MissedDetectionCompensation {
 public:
  explicit MissedDetectionCompensation(DynamicConfig config) : config_(std::move(config)) {}

  /// Processes the detections of the next frame.
  ///
  /// If the set is present, each object without a detection is counted as missed; if it is late or the frame
  /// was not processed by the detector, each object is predicted and the frame counted as skipped. Detections
  /// of other classes than configured and boxes without area are ignored.
  /// @return boxes to mask: detected boxes in the order of the set, then predicted ones by age. Without
  ///         `missed_detection` detected boxes only. Valid until the next call.
  [[nodiscard]] const std::vector<TrackedBox>& update(const DetectionSet& set);

  /// Removes all objects; ids are not reused.
  void reset() { objects_.clear(); }

 private:
  struct Object {
    std::int64_t id = 0;
    std::string class_name;
    Box box;                                             ///< last detection
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< v_hat of Eq. (4) [px/frame]
    int missed = 0;   ///< frames since then in which the detector did not find it
    int skipped = 0;  ///< frames since then without detector output
    [[nodiscard]] int frames_since_detection() const { return missed + skipped; }
    /// Eq. (5), applied once for each frame since the last detection.
    [[nodiscard]] Box predicted() const { return translated(box, frames_since_detection() * velocity); }
  };

  void select_dynamic_classes(const DetectionSet& set);
  void count_frame(bool has_detections);
  [[nodiscard]] Box predicted_and_grown(const Object& object) const;
  void assign_detections();
  void remove_abandoned();

  DynamicConfig config_;
  std::vector<Object> objects_;  ///< by ascending id
  std::int64_t next_id_ = 0;
  // Of the newest frame; members only to reuse the memory.
  std::vector<Detection> detections_;  ///< of the configured classes
  std::vector<TrackedBox> boxes_;      ///< last result
  std::vector<PredictedBox> predictions_;
  BoxAssociation association_;
};

}  // namespace stillpoint
