// SPDX-License-Identifier: BSD-3-Clause
/// Accuracy of dynamic labels, evaluated against the per-pixel ground truth of rendered sequences.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "bench/run/drifted_tracks.h"
#include "core/types/tracked_frame.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// Counts of features, each feature counted once per frame.
///
/// Excluded are features of age 1, which no check has processed yet; features on the outline of an object,
/// where a corner belongs to both sides; and features on an undetectable object at rest, where both labels
/// are correct. Persons count as dynamic even when they do not move.
struct LabelScore {
  struct Group {
    std::int64_t all = 0;
    std::int64_t flagged = 0;  ///< labelled as not stable
    /// flagged / all; nothing without features.
    [[nodiscard]] std::optional<double> flagged_ratio() const {
      if (all == 0) return std::nullopt;
      return static_cast<double>(flagged) / static_cast<double>(all);
    }
  };
  Group people;
  Group undetectable_objects;  ///< moving objects of classes without a detector
  Group background;

  /// Fraction of the flagged features that are on a person or a moving object.
  [[nodiscard]] std::optional<double> precision() const;

  /// @param features of the frame, by ascending id
  /// @param labels   of these features, by ascending id
  /// @param truth    ground-truth labels of the image
  /// @param drifted  already updated with the frame
  void add(std::span<const TrackedFeature> features, std::span<const DynamicLabel> labels,
           const datasets::MotionLabels& truth, const DriftedTracks& drifted);
};

}  // namespace stillpoint::bench
