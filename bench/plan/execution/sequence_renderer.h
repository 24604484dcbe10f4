// SPDX-License-Identifier: BSD-3-Clause
/// Folders of the sequences of a plan, some of which are rendered when their first run is due, or on another
/// thread while runs of another sequence are executed.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <set>

#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/plan/plan_sequences.h"

namespace stillpoint::bench {

/// Renders the next sequence of a plan on another thread while runs are executed.
class SequenceRenderer {
 public:
  /// @param stop_requested polled before each frame, from any thread
  explicit SequenceRenderer(std::function<bool()> stop_requested)
      : stop_requested_(std::move(stop_requested)) {}
  /// Stops a rendering.
  ~SequenceRenderer();
  SequenceRenderer(const SequenceRenderer&) = delete;
  SequenceRenderer& operator=(const SequenceRenderer&) = delete;

  /// Begins to render a sequence; the previous one must have been taken.
  /// @param index returned by `take`
  void start(std::size_t index, const PlanSequence& sequence);

  /// Whether a sequence was started and not taken.
  [[nodiscard]] bool is_busy() const { return rendered_.valid(); }

  /// Whether `take` returns at once.
  [[nodiscard]] bool is_finished() const;

  struct Rendered {
    std::size_t index = 0;
    std::filesystem::path folder;  ///< empty if the rendering was stopped or failed
    double seconds = 0.0;          ///< duration of a rendering that succeeded
  };

  /// Waits for the rendering. A failure is not reported here: `sequence_folder` reports it for each run.
  [[nodiscard]] Rendered take();

 private:
  std::function<bool()> stop_requested_;
  std::atomic<bool> abandoned_ = false;
  std::size_t index_ = 0;
  std::future<Rendered> rendered_;
};

/// The folders of all sequences of a plan, which are given by their index in `PlanMatrix::sequences`.
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
  /// Calls `PlanHooks::on_step` before a rendering.
  void announce(std::size_t sequence) const;

  const PlanMatrix& matrix_;
  const PlanHooks& hooks_;
  SequenceRenderer renderer_;
  std::map<std::size_t, std::filesystem::path> folders_;
  std::set<std::size_t> unrendered_;  ///< whose rendering ahead failed
  double rendering_s_ = 0.0;
};

}  // namespace stillpoint::bench
