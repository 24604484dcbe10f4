// SPDX-License-Identifier: BSD-3-Clause
/// Settings of how the stages are joined. Paper Sec. II.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct PipelineConfig {
  /// Pictures between the one whose state predicts a picture for the tracker and that picture's predecessor.
  /// 0: the tracker waits for the newest state; 1: it works beside the optimisation of the picture before.
  int feedback_lag = 0;
  double detection_max_age_s = 0.1;  ///< `realtime`: boxes older than this are late, and do not count
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, PipelineConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("feedback_lag", config.feedback_lag, 0, 10);
  field("detection_max_age_s", config.detection_max_age_s, 0.0, 10.0);
}

}  // namespace stillpoint
