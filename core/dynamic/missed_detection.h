// SPDX-License-Identifier: BSD-3-Clause
/// Carries boxes over the pictures in which the detector misses them. Paper Sec. III-D, Eqs. (3)-(5).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/dynamic/box_association.h"
#include "core/dynamic/dynamic_config.h"
#include "core/types/box_geometry.h"
#include "core/types/detection.h"

namespace stillpoint {

/// Where an object is in the present picture.
struct TrackedBox {
  std::int64_t id = 0;  ///< of the object, unique in a run
  std::string class_name;
  Box box;                   ///< detected, or carried and grown [px]; without the mask's margin
  bool compensated = false;  ///< not detected in this picture
};

/// The table of moving objects, one call of `update` a picture.
///
/// Which box is which object: see `associate`. An object's reach is its carried box, growth included.
///
/// Velocity is per picture: over a gap of n pictures Eq. (3) is divided by n.
class MissedDetectionCompensation {
 public:
  explicit MissedDetectionCompensation(DynamicConfig config) : config_(std::move(config)) {}

  /// Takes what is known of the next picture.
  ///
  /// Where the set is present, objects without a detection count as missed; where it is late or nobody
  /// looked, every object is carried, and counts as unwatched. Detections of classes that are not configured
  /// and boxes without area are passed over.
  /// @return boxes to mask: the detected ones in order of the set, then the carried ones by age. Without
  ///         `missed_detection` the detected ones alone. Valid until the next call.
  [[nodiscard]] const std::vector<TrackedBox>& update(const DetectionSet& set);

  /// Forgets every object; numbers are not used again.
  void reset() { objects_.clear(); }

 private:
  struct Object {
    std::int64_t id = 0;
    std::string class_name;
    Box box;                                             ///< as last detected
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< weighted, Eq. (4) [px per picture]
    int missed = 0;                                      ///< pictures since that were searched in vain
    int unwatched = 0;                                   ///< pictures since that nobody looked at
    [[nodiscard]] int carried() const { return missed + unwatched; }
    /// Eq. (5) once for each picture since.
    [[nodiscard]] Box predicted() const { return moved(box, carried() * velocity); }
  };

  void select_dynamic_classes(const DetectionSet& set);
  void advance(bool watched);
  [[nodiscard]] Box carried_box(const Object& object) const;
  void take_up_detections();
  void give_up_lost();

  DynamicConfig config_;
  std::vector<Object> objects_;  ///< by rising id
  std::int64_t next_id_ = 0;
  // Of the newest picture, kept for their memory.
  std::vector<Detection> detections_;  ///< of classes that may move
  std::vector<TrackedBox> boxes_;      ///< handed out
  std::vector<ExpectedBox> expected_;
  BoxAssociation association_;
};

}  // namespace stillpoint
