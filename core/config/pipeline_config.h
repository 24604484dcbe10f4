// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the data exchange between the stages. Paper Sec. II.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct PipelineConfig {
  /// Lag of the feedback to the tracker [frames]. 0: tracking of frame k waits for the optimized state of
  /// frame k-1; 1: it uses that of frame k-2 and runs in parallel with the optimization of frame k-1.
  int feedback_lag = 0;
  double detection_max_age_s = 0.1;  ///< mode `realtime`: older boxes are discarded as late
  bool imu_rate = false;             ///< also output the pose at each IMU sample, and score these poses
  /// Seed of a numerically negligible perturbation of gyro samples and feature positions, see
  /// core/pipeline/stages/input_perturbation.h; 0 = none. Runs with different seeds are replicates, which
  /// show how much of a change of the result is due to rounding.
  int perturbation_seed = 0;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, PipelineConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("feedback_lag", config.feedback_lag, 0, 10);
  field("detection_max_age_s", config.detection_max_age_s, 0.0, 10.0);
  field("imu_rate", config.imu_rate);
  field("perturbation_seed", config.perturbation_seed, 0, 1000000000);
}

}  // namespace stillpoint
