// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/sequence_renderer.h"

#include <chrono>
#include <utility>

#include "bench/plan/execution/harness_profile.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"

namespace stillpoint::bench {

SequenceRenderer::~SequenceRenderer() {
  abandoned_ = true;
  if (rendered_.valid()) rendered_.wait();
}

void SequenceRenderer::start(std::size_t index, const PlanSequence& sequence) {
  STILLPOINT_CHECK(!is_busy());
  index_ = index;
  const auto is_stopped = [this] { return abandoned_ || (stop_requested_ && stop_requested_()); };
  rendered_ = std::async(std::launch::async, [index, sequence, is_stopped] {
    name_this_thread("rendering");
    const Stopwatch time;
    std::filesystem::path folder = sequence_folder(sequence, {.progress = {}, .stop_requested = is_stopped});
    return Rendered{.index = index, .folder = std::move(folder), .seconds = time.seconds()};
  });
}

bool SequenceRenderer::is_finished() const {
  return rendered_.valid() && rendered_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

SequenceRenderer::Rendered SequenceRenderer::take() {
  try {
    return rendered_.get();
  } catch (const InputError&) {
    return {.index = index_, .folder = {}};
  }
}

}  // namespace stillpoint::bench
