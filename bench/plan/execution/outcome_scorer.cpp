// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/outcome_scorer.h"

#include <chrono>
#include <utility>

#include "bench/plan/execution/harness_profile.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"

namespace stillpoint::bench {

void OutcomeScorer::start(std::size_t run, const ProcessResult& process, std::function<RunOutcome()> score) {
  scored_.push_back(std::async(std::launch::async, [this, run, process, score = std::move(score)] {
    name_this_thread("scoring");
    ScoredRun scored{.run = run, .process = process, .outcome = {}};
    const Stopwatch scoring;
    scored.outcome = score();
    scored.scoring_s = scoring.seconds();
    const Stopwatch writing;
    writer_.write_files(scored.outcome);
    scored.writing_s = writing.seconds();
    return scored;
  }));
}

bool OutcomeScorer::is_finished() const {
  return !scored_.empty() && scored_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

ScoredRun OutcomeScorer::take() {
  STILLPOINT_CHECK(!scored_.empty());
  std::future<ScoredRun> first = std::move(scored_.front());
  scored_.pop_front();
  return first.get();
}

}  // namespace stillpoint::bench
