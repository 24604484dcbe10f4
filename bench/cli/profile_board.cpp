// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/profile_board.h"

#include <algorithm>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/profile/board_file.h"
#include "bench/record/output_folder.h"
#include "bench/record/run_files.h"
#include "bench/record/score_text.h"
#include "bench/run/run_result.h"
#include "eval/metrics/statistics.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

/// What a user of the board would notice.
struct BoardSpeed {
  std::size_t pictures = 0;
  int dropped = 0;
  int late_detections = 0;
  std::int64_t beyond_budget = 0;  ///< poses later than the budget after their picture
  double median_ms = 0.0;          ///< of latencies
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

BoardSpeed speed_of(const RunSummary& summary, double budget_ms) {
  const RealtimeReport report = summary.realtime.value_or(RealtimeReport{});
  const std::vector<double>& latencies = report.latencies_ms;
  return {.pictures = summary.frames,
          .dropped = report.dropped,
          .late_detections = report.late_detections,
          .beyond_budget = std::ranges::count_if(latencies, [&](double ms) { return ms > budget_ms; }),
          .median_ms = percentile(latencies, 0.5).value_or(0.0),
          .p95_ms = percentile(latencies, 0.95).value_or(0.0),
          .max_ms = percentile(latencies, 1.0).value_or(0.0)};
}

Json json_of(const BoardFile& board, const BoardModel& model, const RunResult& result,
             const BoardSpeed& speed, double budget_ms) {
  return {{"board", board.title},
          {"source", board.source},
          {"deterministic", model.is_deterministic()},
          {"sequence", result.sequence},
          {"status", status_name(result.status)},
          {"pictures", speed.pictures},
          {"dropped", speed.dropped},
          {"late_detections", speed.late_detections},
          {"budget_ms", budget_ms},
          {"beyond_budget", speed.beyond_budget},
          {"latency_ms", {{"median", speed.median_ms}, {"p95", speed.p95_ms}, {"max", speed.max_ms}}},
          {"score", score_members(result.score)}};
}

void print(const BoardFile& board, const BoardModel& model, const RunResult& result, const BoardSpeed& speed,
           double budget_ms) {
  std::cout << fmt::format(
      "{}\n{}\n{} pictures, {} dropped, {} with late boxes; pose after {:.1f} ms (median), {:.1f} ms (95 %), "
      "{:.1f} ms "
      "(longest), {} times later than {:g} ms\n",
      board.title,
      model.is_deterministic() ? "fixed costs: every run is the same"
                               : "scaled times: runs differ as times do",
      speed.pictures, speed.dropped, speed.late_detections, speed.median_ms, speed.p95_ms, speed.max_ms,
      speed.beyond_budget, budget_ms);
  std::cout << result.sequence << ": " << status_name(result.status) << '\n' << score_text(result.score);
}

}  // namespace

int profile_on_board(const SensorStream& stream, BoardRequest request) {
  const BoardFile board = load_board(request.board);
  const BoardModel model = board_model(board);
  request.spec.board = model;
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  const auto on_update = [&](const OdometryUpdate& update) {
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
  };
  RunResult result = score_run(
      stream.info(),
      run_odometry(stream, request.spec,
                   {.on_update = on_update, .on_picture = {}, .stop_requested = interrupt_requested}));
  if (interrupt_requested()) return kExitInterrupted;
  const BoardSpeed speed = speed_of(result.run.summary, request.budget_ms);
  write_files(request.folder,
              {{"board.json", json_of(board, model, result, speed, request.budget_ms).dump(2) + "\n"},
               {"trajectory.tum", trajectory_text(result)}});
  progress.wipe();
  print(board, model, result, speed, request.budget_ms);
  std::cout << request.folder.string() << '\n';
  return result.status == RunStatus::kOk ? kExitOk : kExitFindings;
}

}  // namespace stillpoint
