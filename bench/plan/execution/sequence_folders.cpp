// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/sequence_folders.h"

#include "bench/plan/execution/harness_profile.h"

namespace stillpoint::bench {

SequenceFolders::SequenceFolders(const PlanMatrix& matrix, const PlanHooks& hooks)
    : matrix_(matrix), hooks_(hooks), renderer_(hooks.stop_requested) {}

bool SequenceFolders::is_ready(std::size_t sequence) const {
  return !matrix_.sequences[sequence].rendering || folders_.contains(sequence) ||
         unrendered_.contains(sequence);
}

std::filesystem::path SequenceFolders::find(std::size_t sequence) {
  if (const auto found = folders_.find(sequence); found != folders_.end()) return found->second;
  const PlanSequence& planned = matrix_.sequences[sequence];
  if (planned.rendering && hooks_.on_step) hooks_.on_step("render " + planned.name);
  const Stopwatch time;
  std::filesystem::path folder =
      sequence_folder(planned, {.progress = hooks_.on_rendered, .stop_requested = hooks_.stop_requested});
  if (planned.rendering) rendering_s_ += time.seconds();
  if (!folder.empty()) folders_[sequence] = folder;
  return folder;
}

void SequenceFolders::render_ahead(std::size_t sequence) {
  if (renderer_.is_busy()) return;
  if (hooks_.on_step) hooks_.on_step("render " + matrix_.sequences[sequence].name);
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
