// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/sequence_renderer.h"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include <fmt/format.h>

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

SequenceFolders::SequenceFolders(const PlanMatrix& matrix, const PlanHooks& hooks)
    : matrix_(matrix), hooks_(hooks), renderer_(hooks.stop_requested) {}

void SequenceFolders::announce(std::size_t sequence) const {
  if (!hooks_.on_step) return;
  const auto rendered_in = [](std::span<const PlanSequence> sequences) {
    return std::ranges::count_if(sequences,
                                 [](const PlanSequence& planned) { return planned.rendering.has_value(); });
  };
  const std::span<const PlanSequence> all = matrix_.sequences;
  hooks_.on_step(fmt::format("render {} (sequence {} of {})", all[sequence].name,
                             rendered_in(all.first(sequence + 1)), rendered_in(all)));
}

bool SequenceFolders::is_ready(std::size_t sequence) const {
  return !matrix_.sequences[sequence].rendering || folders_.contains(sequence) ||
         unrendered_.contains(sequence);
}

std::filesystem::path SequenceFolders::find(std::size_t sequence) {
  if (const auto found = folders_.find(sequence); found != folders_.end()) return found->second;
  const PlanSequence& planned = matrix_.sequences[sequence];
  if (planned.rendering) announce(sequence);
  const Stopwatch time;
  std::filesystem::path folder =
      sequence_folder(planned, {.progress = hooks_.on_rendered, .stop_requested = hooks_.stop_requested});
  if (planned.rendering) rendering_s_ += time.seconds();
  if (!folder.empty()) folders_[sequence] = folder;
  return folder;
}

void SequenceFolders::render_ahead(std::size_t sequence) {
  if (renderer_.is_busy()) return;
  announce(sequence);
  renderer_.start(sequence, matrix_.sequences[sequence]);
}

void SequenceFolders::take_rendered() {
  const SequenceRenderer::Rendered rendered = renderer_.take();
  rendering_s_ += rendered.seconds;
  if (rendered.folder.empty())
    unrendered_.insert(rendered.index);
  else
    folders_[rendered.index] = rendered.folder;
}

}  // namespace stillpoint::bench
