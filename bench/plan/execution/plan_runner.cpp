// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/plan_runner.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/plan/execution/outcome_scorer.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/plan/execution/sequence_renderer.h"
#include "bench/profile/meters/process_usage.h"
#include "bench/run/frame_cache.h"
#include "bench/run/odometry_run.h"
#include "bench/systems/external_run.h"
#include "bench/systems/file_states.h"
#include "bench/systems/slam_system.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

/// Time after the first frame at which frame `index` is the next one [s]; 0 for the first.
/// @throws InputError if the sequence cannot be opened, or has too few frames
double time_of_frame(const std::filesystem::path& folder, int index) {
  if (index == 0) return 0.0;
  const auto stream = datasets::open_sequence(folder);
  const std::vector<Timestamp>& times = stream->info().frame_times;
  if (static_cast<std::size_t>(index) >= times.size()) {
    throw InputError(
        "seeds",
        fmt::format("seed number {} begins {} later, but the sequence has {}; use fewer seeds", index + 1,
                    counted(static_cast<std::size_t>(index), "frame"), counted(times.size(), "frame")));
  }
  constexpr double kRounding_s = 2e-6;  // of the option --start
  return seconds_between(times.front(), times[static_cast<std::size_t>(index)]) - kRounding_s;
}

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A line of the profile; `text` is its label, and `id` its name in JSON.
struct Part {
  const char* id;
  const char* text;
  double HarnessProfile::*seconds;
};
constexpr std::array<Part, 5> kWorkerParts = {
    {{"odometry_s", "odometry", &HarnessProfile::odometry_s},
     {"image_waits_s", "waiting for images", &HarnessProfile::image_waits_s},
     {"start_s", "start of processes", &HarnessProfile::start_s},
     {"output_s", "scores and files of runs", &HarnessProfile::output_s},
     {"other_process_s", "other processes", &HarnessProfile::other_process_s}}};
constexpr std::array<Part, 5> kOtherParts = {
    {{"decoding_s", "decoding threads", &HarnessProfile::decoding_s},
     {"rendering_s", "rendering", &HarnessProfile::rendering_s},
     {"preparing_s", "frame cache and warm-up", &HarnessProfile::preparing_s},
     {"scoring_s", "scoring", &HarnessProfile::scoring_s},
     {"storing_s", "storing", &HarnessProfile::storing_s}}};

double number(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
}

double seconds_of_calls(const RunOutcome& outcome, const std::string& module) {
  double sum_s = 0.0;
  for (const ModuleCost& cost : outcome.costs) {
    if (cost.module == module) sum_s += 1e-3 * cost.mean_ms * static_cast<double>(cost.calls);
  }
  return sum_s;
}

double worker_seconds(const HarnessProfile& profile) {
  return static_cast<double>(profile.workers) * profile.wall_s;
}

std::string profile_line(const HarnessProfile& profile, const char* text, double seconds) {
  const double all_s = worker_seconds(profile);
  return fmt::format("  {:<26}{:>9.2f} s  {:>5.1f} %\n", text, seconds,
                     all_s > 0.0 ? 100.0 * seconds / all_s : 0.0);
}

}  // namespace

double HarnessProfile::idle_s() const {
  double busy_s = 0.0;
  for (const Part& part : kWorkerParts) busy_s += this->*part.seconds;
  return std::max(0.0, worker_seconds(*this) - busy_s);
}

HarnessProfile with_run(HarnessProfile profile, const ProcessResult& process, const RunOutcome& outcome) {
  ++profile.runs;
  const auto text = outcome.attachments.find("result");
  const Json result = text == outcome.attachments.end()
                          ? Json()
                          : Json::parse(text->second, nullptr, /*allow_exceptions=*/false);
  if (!result.is_object() || !result.contains("start_s")) {
    profile.other_process_s += process.wall_s;
    return profile;
  }
  const double run_s = number(result, "wall_s");
  const double waits_s = std::min(run_s, number(result, "image_waits_s"));
  const double start_s = std::min(number(result, "start_s"), std::max(0.0, process.wall_s - run_s));
  profile.odometry_s += run_s - waits_s;
  profile.image_waits_s += waits_s;
  profile.start_s += start_s;
  profile.output_s += std::max(0.0, process.wall_s - run_s - start_s);
  profile.decoding_s += seconds_of_calls(outcome, "image_decoding");
  return profile;
}

std::string profile_text(const HarnessProfile& profile) {
  std::string text = fmt::format("{}, {} at once, {:.1f} s; time of the workers:\n",
                                 counted(profile.runs, "run"), profile.workers, profile.wall_s);
  for (const Part& part : kWorkerParts) {
    if (profile.*part.seconds > 0.0) text += profile_line(profile, part.text, profile.*part.seconds);
  }
  text += profile_line(profile, "no run to execute", profile.idle_s());
  text += "outside of the workers:\n";
  for (const Part& part : kOtherParts) {
    if (profile.*part.seconds > 0.0) text += profile_line(profile, part.text, profile.*part.seconds);
  }
  return text;
}

std::string profile_json(const HarnessProfile& profile) {
  Json json = {
      {"schema", 1}, {"runs", profile.runs}, {"workers", profile.workers}, {"wall_s", profile.wall_s}};
  for (const Part& part : kWorkerParts) json[part.id] = profile.*part.seconds;
  json["idle_s"] = profile.idle_s();
  for (const Part& part : kOtherParts) json[part.id] = profile.*part.seconds;
  return json.dump(2) + "\n";
}

void require_recorded_boxes(const PlanMatrix& matrix) {
  for (const PlannedRun& run : matrix.runs) {
    const PlanSequence& sequence = matrix.sequences[run.sequence];
    const bool is_own = !is_external(run.identity) && run.program.empty();
    if (!is_own || sequence.rendering || !sequence.unavailable_reason.empty()) continue;
    try {
      require_recorded_boxes(load_config(run.config), sequence.folder);
    } catch (const InputError& error) {
      throw InputError("run \"" + run_label(matrix.plan, run.identity) + "\"", error.what());
    }
  }
}

namespace {

constexpr int kLeasePollMs = 200;

/// @throws InputError if a sequence changed since the first call for it
void require_unchanged(SequenceWatch& watch, const fs::path& sequence) {
  const std::string changes = watch.changes_of(sequence);
  if (!changes.empty())
    throw InputError(sequence.string(), "was changed since the first run: " + changes +
                                            "; restore it, and run the command again");
}

/// One call of `run_plan`.
class PlanRunner {
 public:
  PlanRunner(const PlanMatrix& matrix, StoreWriter& writer, const PlanOptions& options,
             const PlanHooks& hooks)
      : matrix_(matrix),
        writer_(writer),
        hooks_(hooks),
        pool_(hooks.stop_requested),
        folders_(matrix, hooks),
        jobs_(matrix.plan.kind == RunKind::kTiming ? 1 : std::max(1, options.jobs)),
        scorer_(writer) {
    for (const ExternalSystem& system : matrix.systems) external_.emplace_back(system);
    const std::vector<std::size_t> order = execution_order(matrix, Store(writer.file()).runs(), jobs_);
    report_.missing = matrix.runs.size() - order.size();
    for (const std::size_t run : order)
      writer.is_done(run_key(identity_of(run))) ? count_cached() : queue_.push_back(run);
  }

  PlanReport run() {
    const Stopwatch time;
    while (true) {
      while (!stopped() && select_next()) start_next();
      if (!stopped()) render_ahead();
      while (scorer_.is_finished() || scorer_.pending() > 2 * static_cast<std::size_t>(jobs_)) store_next();
      const auto is_due = [this] { return (is_idle() && folders_.is_finished()) || scorer_.is_finished(); };
      if (const auto ended = pool_.wait_next(is_due)) {
        end_run(ended->first, ended->second);
      } else if (pool_.running() > 0) {
        continue;
      } else if (scorer_.pending() > 0) {
        store_next();
      } else if (stopped() || (queue_.empty() && leased_by_other_.empty())) {
        break;
      } else if (queue_.empty()) {
        wait_for_other_worker();
        queue_.swap(leased_by_other_);
      }
    }
    report_.interrupted = stopped();
    report_.profile.workers = jobs_;
    report_.profile.wall_s = time.seconds();
    report_.profile.rendering_s = folders_.rendering_s();
    return report_;
  }

 private:
  [[nodiscard]] bool stopped() const { return hooks_.stop_requested && hooks_.stop_requested(); }
  [[nodiscard]] const RunIdentity& identity_of(std::size_t run) const { return matrix_.runs[run].identity; }
  [[nodiscard]] const PlanSequence& sequence_of(std::size_t run) const {
    return matrix_.sequences[matrix_.runs[run].sequence];
  }
  [[nodiscard]] const SlamSystem& system_of(std::size_t run) const {
    if (is_external(identity_of(run))) return external_[matrix_.runs[run].system];
    return own_;
  }

  void count_cached() {
    ++report_.cached;
    report_progress();
  }

  void count_executed() {
    ++report_.executed;
    report_progress();
  }

  void report_progress() const {
    if (hooks_.on_progress)
      hooks_.on_progress(report_.executed + report_.cached, matrix_.runs.size() - report_.missing);
  }

  void wait_for_other_worker() {
    if (!wait_reported_ && hooks_.on_step) {
      hooks_.on_step("wait for " + counted(leased_by_other_.size(), "run") + " of another worker");
    }
    wait_reported_ = true;
    poll(nullptr, 0, kLeasePollMs);
  }

  /// Whether a further run may be started.
  [[nodiscard]] bool is_idle() const { return pool_.running() < static_cast<std::size_t>(jobs_); }

  [[nodiscard]] bool is_ready(std::size_t run) const { return folders_.is_ready(matrix_.runs[run].sequence); }

  /// Whether its time is measured, so that nothing else may disturb it.
  [[nodiscard]] bool is_timed(std::size_t run) const {
    return matrix_.plan.kind == RunKind::kTiming || identity_of(run).mode.ends_with("realtime");
  }

  /// Moves the next run that can be started to the front of the queue; without one and without running
  /// processes the first run, whose sequence is then rendered.
  /// @return false if none should be started now
  bool select_next() {
    if (queue_.empty() || !is_idle()) return false;
    if (folders_.is_finished() || (folders_.is_rendering() && pool_.running() == 0)) folders_.take_rendered();
    const auto ready = std::ranges::find_if(queue_, [&](std::size_t run) { return is_ready(run); });
    if (ready == queue_.end()) return pool_.running() == 0;
    const std::size_t run = *ready;
    queue_.erase(ready);
    queue_.push_front(run);
    return true;
  }

  /// Renders the next sequence while runs of the last one are executed. Timing runs execute alone.
  void render_ahead() {
    if (matrix_.plan.kind == RunKind::kTiming || pool_.running() == 0 || folders_.is_rendering()) return;
    const auto next = std::ranges::find_if(queue_, [&](std::size_t run) { return !is_ready(run); });
    if (next != queue_.end()) folders_.render_ahead(matrix_.runs[*next].sequence);
  }

  void start_next() {
    const std::size_t run = queue_.front();
    queue_.pop_front();
    if (writer_.is_done(run_key(identity_of(run)))) return count_cached();
    while (!is_ready(run) && scorer_.pending() > 0) store_next();  // rendering takes long
    try {
      const fs::path folder = folders_.find(matrix_.runs[run].sequence);
      if (folder.empty()) return;             // the rendering was stopped
      require_unchanged(sequences_, folder);  // a program may have written into it
      prepare(run, folder);
      if (acquire(run)) start(run, folder);
    } catch (const InputError& error) {
      store_bad_data(run, error);
    }
  }

  /// Requests the lease of a run; counts or postpones the run if it is not granted.
  bool acquire(std::size_t run) {
    const RunLease lease = writer_.acquire(identity_of(run));
    if (lease == RunLease::kDone) count_cached();
    if (lease == RunLease::kLeasedByOther) leased_by_other_.push_back(run);
    if (lease == RunLease::kGranted) leased_.insert(run);
    return lease == RunLease::kGranted;
  }

  /// Stores a run that could not be started. Errors of the store itself propagate to the caller.
  void store_bad_data(std::size_t run, const InputError& error) {
    if (!leased_.contains(run) && !acquire(run)) return;
    writer_.finish(identity_of(run), {.outcome = Outcome::kBadData, .detail = error.what()});
    leased_.erase(run);
    count_executed();
  }

  [[nodiscard]] RunRequest request_of(std::size_t run, const fs::path& folder) const {
    const PlannedRun& planned = matrix_.runs[run];
    return {.identity = planned.identity,
            .config = planned.config,
            .max_frames = planned.max_frames,
            .start_s = time_of_frame(folder, planned.later_frames),
            .gray_noise = planned.later_frames,
            .fault = planned.fault,
            .program = planned.program,
            .commit_time = planned.commit_time,
            .sequence = folder,
            .work = writer_.work_folder(identity_of(run)),
            // Drawing the annotated images would distort the measured times.
            .images = is_timed(run) ? 0 : matrix_.plan.images,
            .frame_cache = matrix_.plan.frame_cache,
            .time_limit_s = matrix_.plan.time_limit_s,
            .memory_limit_mb = matrix_.plan.memory_limit_mb};
  }

  [[nodiscard]] ProcessSpec spec_of(std::size_t run, const fs::path& folder) const {
    const BenchPlan& plan = matrix_.plan;
    ProcessSpec spec = system_of(run).command(request_of(run, folder));
    spec.time_limit_s = plan.time_limit_s;
    if (plan.memory_limit_mb > 0) spec.memory_limit_bytes = std::int64_t{plan.memory_limit_mb} << 20;
    if (!plan.cores.empty()) spec.cores = parse_cpu_list(plan.cores);  // else as set by the system
    return spec;
  }

  /// Before the first timed run of a sequence: decodes its images into the frame cache, so that all runs read
  /// them from there, and executes runs whose results are discarded: they bring the CPU to its steady clock.
  void prepare(std::size_t run, const fs::path& folder) {
    if (!is_timed(run) || !prepared_.insert(matrix_.runs[run].sequence).second) return;
    const Stopwatch time;
    if (matrix_.plan.frame_cache && !is_external(identity_of(run))) {
      if (hooks_.on_step) hooks_.on_step("read images of " + sequence_of(run).name);
      fill_frame_cache(folder, matrix_.runs[run].max_frames, hooks_.stop_requested);
    }
    const int warm_ups = matrix_.plan.kind == RunKind::kTiming ? matrix_.plan.warm_up : 0;
    for (int i = 0; i < warm_ups && !stopped(); ++i) {
      if (hooks_.on_step) hooks_.on_step("warm up " + sequence_of(run).name);
      static_cast<void>(run_process(spec_of(run, folder)));
      fs::remove_all(writer_.work_folder(identity_of(run)));
    }
    report_.profile.preparing_s += time.seconds();
  }

  void start(std::size_t run, const fs::path& folder) {
    if (hooks_.on_step) hooks_.on_step("run " + run_label(matrix_.plan, identity_of(run)));
    fs::remove_all(writer_.work_folder(identity_of(run)));  // of a worker that was killed
    const ProcessSpec spec = spec_of(run, folder);
    load_before_ = machine_load();
    pool_.start(run, spec);
  }

  /// Scores a run on another thread while the next one is executed; a timed run must not be disturbed, so the
  /// previous one is stored first.
  void end_run(std::size_t run, const ProcessResult& end) {
    const RunRequest request = request_of(run, folders_.find(matrix_.runs[run].sequence));
    // Another program may end with any status on SIGTERM, and leave the first part of its trajectory.
    const bool was_interrupted =
        is_external(identity_of(run)) || end.signal != 0 || end.exit_code == kInterruptedCode;
    if (stopped() && was_interrupted) {
      leased_.erase(run);
      writer_.release(identity_of(run));
      fs::remove_all(request.work);
      return;
    }
    const std::string changes = sequences_.changes_of(request.sequence);
    scorer_.start(run, end, [this, run, end, request, changes] {
      return unless_changed(outcome_of_run(system_of(run), request, end, matrix_.plan), changes);
    });
    while (is_timed(run) && scorer_.pending() > 0) store_next();
  }

  void store_next() {
    ScoredRun scored = scorer_.take();
    RunOutcome& outcome = scored.outcome;
    if (matrix_.plan.kind == RunKind::kTiming) {
      const std::vector<Metric> load =
          load_metrics(load_before_, machine_load(), scored.process.user_s + scored.process.system_s);
      outcome.metrics.insert(outcome.metrics.end(), load.begin(), load.end());
    }
    const Stopwatch storing;
    writer_.finish(identity_of(scored.run), outcome);
    leased_.erase(scored.run);
    fs::remove_all(writer_.work_folder(identity_of(scored.run)));
    report_.profile = with_run(report_.profile, scored.process, outcome);
    report_.profile.scoring_s += scored.scoring_s;
    report_.profile.storing_s += scored.writing_s + storing.seconds();
    count_executed();
  }

  static constexpr int kInterruptedCode = 130;  // exit code of `stillpoint run`

  const PlanMatrix& matrix_;
  StoreWriter& writer_;
  const PlanHooks& hooks_;
  ProcessPool pool_;
  SequenceFolders folders_;
  SequenceWatch sequences_;
  OwnOdometry own_;
  std::vector<ExternalRun> external_;
  int jobs_;
  std::deque<std::size_t> queue_;
  std::deque<std::size_t> leased_by_other_;  ///< runs leased by other workers
  std::set<std::size_t> leased_;             ///< runs leased by this worker
  std::set<std::size_t> prepared_;           ///< sequences of timed runs
  MachineLoad load_before_;
  bool wait_reported_ = false;
  PlanReport report_;
  OutcomeScorer scorer_;  ///< last, as its threads use the other members
};

}  // namespace

void prepare_store(const PlanMatrix& matrix, StoreWriter& writer, const PlanOptions& options) {
  std::vector<Outcome> repeated = {Outcome::kBadData};
  if (options.retry) {
    repeated = {Outcome::kLost, Outcome::kCrashed, Outcome::kTimedOut, Outcome::kOutOfMemory,
                Outcome::kBadData};
  }
  writer.remove_runs(matrix.keys, repeated);
  if (!options.record) return;
  writer.record_plan({.name = matrix.plan.name,
                      .title = matrix.plan.title,
                      .text = matrix.plan.text,
                      .run_keys = matrix.keys});
}

void require_unchanged_sequences(SequenceWatch& watch, const PlanMatrix& matrix) {
  for (const PlanSequence& sequence : matrix.sequences) {
    if (!sequence.rendering && sequence.unavailable_reason.empty()) require_unchanged(watch, sequence.folder);
  }
}

PlanReport run_plan(const PlanMatrix& matrix, StoreWriter& writer, const PlanOptions& options,
                    const PlanHooks& hooks) {
  require_recorded_boxes(matrix);
  prepare_store(matrix, writer, options);
  return PlanRunner(matrix, writer, options, hooks).run();
}

}  // namespace stillpoint::bench
