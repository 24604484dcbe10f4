// SPDX-License-Identifier: BSD-3-Clause
/// Runs an external SLAM system on a sequence.
#pragma once

#include "bench/systems/slam_system.h"

namespace stillpoint::bench {

class ExternalRun : public SlamSystem {
 public:
  explicit ExternalRun(ExternalSystem system) : system_(std::move(system)) {}

  /// Command line of the system. Exports the sequence first if the system requires another layout; exports
  /// are cached.
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;

  /// Evaluates the trajectory written by the system.
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessResult& process) const override;

 private:
  ExternalSystem system_;
};

}  // namespace stillpoint::bench
