// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the data exchange between the stages. Paper Sec. II. The field list explains each key.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct PipelineConfig {
  int feedback_lag = 0;
  bool imu_rate = false;
  int perturbation_seed = 0;  ///< see core/pipeline/stages/replication.h

  /// Boxes of an older image are discarded as late; modes `realtime` and `device`. Not a key: no config
  /// changes it.
  double detection_max_age_s = 0.1;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, PipelineConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("feedback_lag", config.feedback_lag,
        FieldInfo{
            "Lag of the feedback to the tracker. With 0, frame k is tracked after the optimization of frame "
            "k-1; with 1, in parallel with it and by the state of frame k-2.",
            "frames", 0, 10, "II"});
  field(
      "imu_rate", config.imu_rate,
      FieldInfo{.text = "Whether the pose at each IMU sample is written and scored as well.", .paper = "II"});
  field("perturbation_seed", config.perturbation_seed,
        FieldInfo{
            "Seed of a numerically negligible perturbation of gyroscope samples and feature positions; 0 = "
            "none. Runs that differ in this seed are replicates: they show how much of a change of the "
            "result is due to rounding.",
            "", 0, 1000000000});
}

}  // namespace stillpoint
