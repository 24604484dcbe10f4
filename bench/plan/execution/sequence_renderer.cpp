// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/sequence_renderer.h"

#include <chrono>

#include "core/base/error.h"

namespace stillpoint::bench {

SequenceRenderer::~SequenceRenderer() {
  abandoned_ = true;
  if (folder_.valid()) folder_.wait();
}

void SequenceRenderer::start(std::size_t index, const PlanSequence& sequence) {
  STILLPOINT_CHECK(!is_busy());
  index_ = index;
  const auto is_stopped = [this] { return abandoned_ || (stop_requested_ && stop_requested_()); };
  folder_ = std::async(std::launch::async, [sequence, is_stopped] {
    return sequence_folder(sequence, {.progress = {}, .stop_requested = is_stopped});
  });
}

bool SequenceRenderer::is_finished() const {
  return folder_.valid() && folder_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

SequenceRenderer::Rendered SequenceRenderer::take() {
  try {
    return {index_, folder_.get()};
  } catch (const InputError&) {
    return {index_, {}};
  }
}

}  // namespace stillpoint::bench
