// SPDX-License-Identifier: BSD-3-Clause
/// Runs another system over our sequences.
#pragma once

#include "bench/systems/slam_system.h"

namespace stillpoint {

class ExternalRun : public SlamSystem {
 public:
  explicit ExternalRun(ExternalSystem system) : system_(std::move(system)) {}

  /// Exports the sequence, once for all runs, if the system wants it in another form.
  [[nodiscard]] ProcessSpec command(const RunRequest& request) const override;

  /// Scores the trajectory that it left behind.
  [[nodiscard]] RunOutcome outcome(const RunRequest& request, const ProcessEnd& end) const override;

 private:
  ExternalSystem system_;
};

}  // namespace stillpoint
