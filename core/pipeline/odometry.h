// SPDX-License-Identifier: BSD-3-Clause
/// The stages put together from a configuration; knows nothing of threads.
#pragma once

#include <optional>

#include "core/backend/estimator.h"
#include "core/frontend/feature_tracker.h"
#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// One odometry over one sequence. Pictures come in order, each after the inertial samples up to its
/// exposure.
class Odometry {
 public:
  /// @throws InputError if the rig lacks what the configuration asks for
  Odometry(const OdometryConfig& config, const Rig& rig);

  void add_imu(const ImuSample& sample) { estimator_.add_imu(sample); }
  [[nodiscard]] OdometryUpdate process(const Frame& frame);

  [[nodiscard]] const ImuHealth& imu_health() const { return estimator_.imu_health(); }

 private:
  [[nodiscard]] bool enters_window(Timestamp t) const;

  OdometryConfig config_;
  FeatureTracker tracker_;
  Estimator estimator_;
  std::optional<Timestamp> last_frame_;
  std::optional<Timestamp> last_window_frame_;
};

}  // namespace stillpoint
