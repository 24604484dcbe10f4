// SPDX-License-Identifier: BSD-3-Clause
/// Renders the next sequence of a plan on another thread while runs are executed.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <optional>

#include "bench/plan/plan_sequences.h"

namespace stillpoint::bench {

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

}  // namespace stillpoint::bench
