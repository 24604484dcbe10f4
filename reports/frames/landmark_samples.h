// SPDX-License-Identifier: BSD-3-Clause
/// Landmarks of a run for the 3-D view of the report page: features with measured depth and their labels.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/model/run_csv.h"
#include "core/pipeline/runners/runner.h"

namespace stillpoint::report {

/// Takes each feature once as static and once as dynamic, in two located frames per second of the first
/// world.
class LandmarkSamples {
 public:
  /// Frames in order.
  void add(const FrameReport& report);

  /// At most 1500 of the samples, at equal steps, as `bench::landmark_text`.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<bench::LandmarkSample> samples_;
  std::set<std::pair<std::int64_t, bool>> taken_;  ///< id of the feature, and whether it was dynamic
  std::optional<Timestamp> last_t_;                ///< of the last frame that was sampled
};

}  // namespace stillpoint::report
