// SPDX-License-Identifier: BSD-3-Clause
/// Folders of the sequences of a plan, some of which are rendered when their first run is due, or while runs
/// of another sequence are executed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>

#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/execution/sequence_renderer.h"
#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Sequences are given by their index in `PlanMatrix::sequences`.
class SequenceFolders {
 public:
  /// @param matrix, hooks must outlive this object
  SequenceFolders(const PlanMatrix& matrix, const PlanHooks& hooks);

  /// Whether `find` does not render.
  [[nodiscard]] bool is_ready(std::size_t sequence) const;

  /// The folder of a sequence, rendered first if necessary; empty if the rendering was stopped.
  /// @throws InputError as `sequence_folder`
  [[nodiscard]] std::filesystem::path find(std::size_t sequence);

  /// Renders a sequence on another thread, unless one is being rendered.
  void render_ahead(std::size_t sequence);

  /// Whether a rendering on another thread is complete, which `take_rendered` makes available.
  [[nodiscard]] bool is_finished() const { return renderer_.is_finished(); }
  [[nodiscard]] bool is_rendering() const { return renderer_.is_busy(); }
  /// Waits for the rendering on another thread.
  void take_rendered();

  /// Time of all renderings so far.
  [[nodiscard]] double rendering_s() const { return rendering_s_; }

 private:
  const PlanMatrix& matrix_;
  const PlanHooks& hooks_;
  SequenceRenderer renderer_;
  std::map<std::size_t, std::filesystem::path> folders_;
  std::set<std::size_t> unrendered_;  ///< whose rendering ahead failed
  double rendering_s_ = 0.0;
};

}  // namespace stillpoint::bench
