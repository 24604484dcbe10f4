// SPDX-License-Identifier: BSD-3-Clause
/// The odometry of this project, run as a child process: `stillpoint run`.
#pragma once

#include "bench/systems/slam_system.h"

namespace stillpoint::bench {

class OwnOdometry : public SlamSystem {
 public:
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;
};

/// Build name in run records: git commit, and a hash of uncommitted changes if any.
[[nodiscard]] std::string build_name();

}  // namespace stillpoint::bench
