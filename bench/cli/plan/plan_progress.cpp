// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_progress.h"

#include <memory>

#include <spdlog/spdlog.h>

#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"

namespace stillpoint::bench {

PlanHooks plan_progress() {
  const auto rendering = std::make_shared<std::unique_ptr<ProgressLine>>();
  const auto runs = std::make_shared<std::unique_ptr<ProgressLine>>();
  const auto line = [](std::unique_ptr<ProgressLine>& progress, const char* label, std::size_t total,
                       const char* unit) {
    if (!progress) progress = std::make_unique<ProgressLine>(label, total, unit);
    return progress.get();
  };
  return {
      .on_step =
          [rendering, runs](const std::string& step) {
            rendering->reset();
            if (*runs) (*runs)->clear();
            spdlog::info("{}", step);
            if (*runs) (*runs)->draw();
          },
      .on_rendered =
          [rendering, line](int done, int total) {
            line(*rendering, "rendering", static_cast<std::size_t>(total), "frames")
                ->update(static_cast<std::size_t>(done));
          },
      .on_progress = [runs, line](std::size_t done,
                                  std::size_t total) { line(*runs, "bench", total, "runs")->update(done); },
      .stop_requested = interrupt_requested};
}

}  // namespace stillpoint::bench
