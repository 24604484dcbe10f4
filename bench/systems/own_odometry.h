// SPDX-License-Identifier: BSD-3-Clause
/// Our odometry as a child process: `stillpoint run`.
#pragma once

#include "bench/systems/slam_system.h"

namespace stillpoint {

class OwnOdometry : public SlamSystem {
 public:
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessEnd& end) const override;
};

/// What the runs of this program are recorded under: its git commit, and a hash of the changes when there are
/// any.
[[nodiscard]] std::string build_name();

}  // namespace stillpoint
