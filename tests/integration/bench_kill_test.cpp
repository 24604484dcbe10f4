// SPDX-License-Identifier: BSD-3-Clause
// Benchmarks of the replay system that are killed, executed by several workers, or have failing runs.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/store/store.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/sequences/replay_bench.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = STILLPOINT_BINARY_DIR "/stillpoint";
constexpr int kRuns = 200;
constexpr int kKills = 20;

/// Starts the benchmark, and kills it after a delay. @return whether it was still running
bool kill_after(const TemporaryFolder& folder, const fs::path& plan, const fs::path& store,
                int milliseconds) {
  const pid_t child = fork();
  if (child == 0) {
    setenv("STILLPOINT_DATA", folder.path().c_str(), 1);
    setenv("STILLPOINT_REGISTRY", (folder.path() / "none.json").c_str(), 1);
    static_cast<void>(!std::freopen("/dev/null", "w", stdout));
    static_cast<void>(!std::freopen("/dev/null", "w", stderr));
    std::vector<std::string> arguments = replay_arguments(folder, plan, store);
    arguments.insert(arguments.begin(), "stillpoint");
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    execv(kProgram, pointers.data());
    _exit(127);
  }
  poll(nullptr, 0, milliseconds);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

/// The content of a store that must not depend on interruptions: everything except measured times and the
/// random times of the replay program.
std::map<std::string, std::string> content_of(const fs::path& file) {
  std::map<std::string, std::string> content;
  const bench::Store store(file);
  for (const bench::StoredRun& run : store.runs()) {
    content[run.key] =
        run.identity.sequence + " " + std::to_string(run.identity.repetition) + " " +
        bench::outcome_name(run.outcome) + " " + run.detail + " " + run.blobs.at("trajectory") + " " +
        std::to_string(*bench::metric_value(run, "ate_rmse_m")) + " " + run.manifest_hash + " " +
        std::to_string(run.costs.size()) + " " + std::to_string(store.trajectory(run).poses.size());
  }
  return content;
}

TEST(BenchKill, TwentyKillsGiveTheSameStoreAsAnUninterruptedBenchmark) {
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "log").string();
  const fs::path plan = write_replay_plan(folder, kRuns / 2, "\"--log\", \"" + log + "\", ");
  const fs::path uninterrupted = folder.path() / "uninterrupted.sqlite";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(replay_bench(folder, plan, uninterrupted).exit_code, 0);
  const std::chrono::duration<double, std::milli> uninterrupted_ms = std::chrono::steady_clock::now() - start;
  fs::remove(log);

  const fs::path killed = folder.path() / "killed.sqlite";
  std::mt19937 random(5);
  // Fraction of the uninterrupted duration before each kill: 3/4 of the duration in total, on average.
  std::uniform_real_distribution<double> fraction(0.0, 1.5 / kKills);
  int interrupted = 0;
  for (int i = 0; i < kKills; ++i)
    interrupted +=
        kill_after(folder, plan, killed, static_cast<int>(fraction(random) * uninterrupted_ms.count())) ? 1
                                                                                                        : 0;
  EXPECT_GE(interrupted, kKills / 2);  // otherwise the benchmark is too short to be killed
  const ProgramResult last = replay_bench(folder, plan, killed);
  EXPECT_EQ(last.exit_code, 0) << last.err;

  EXPECT_EQ(bench::Store(killed).unfinished(), 0);
  const std::map<std::string, std::string> content = content_of(uninterrupted);
  EXPECT_EQ(content.size(), static_cast<std::size_t>(kRuns));
  EXPECT_EQ(content, content_of(killed));
  std::size_t finished = 0;
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);) ++finished;
  EXPECT_GE(finished, static_cast<std::size_t>(kRuns));
  EXPECT_LE(finished,
            static_cast<std::size_t>(kRuns + 2 * kKills));  // each kill repeats at most the two active runs
}

/// What loop closure adds to a run, and its trajectory.
struct LoopContent {
  std::string trajectory;
  std::vector<double> metrics;
  bool operator==(const LoopContent&) const = default;
};

std::map<std::string, LoopContent> loops_of(const fs::path& file) {
  std::map<std::string, LoopContent> content;
  for (const bench::StoredRun& run : bench::Store(file).runs()) {
    LoopContent& values = content[run.key];
    values.trajectory = run.blobs.at("trajectory");
    for (const char* metric : {"loops", "loop_keyframes", "ate_rmse_m", "ate_loop_m", "ate_optimized_m"})
      values.metrics.push_back(bench::metric_value(run, metric).value());
  }
  return content;
}

TEST(BenchKill, KilledRunsWithLoopClosureAreRepeated) {
  const TemporaryFolder folder;
  static_cast<void>(copy_of_rendered_sequence(folder));
  const fs::path config = folder.write(
      "loops.toml", "[loop]\nenabled = true\nmin_gap_s = 0.5\nmin_translation_m = 0.02\nmin_inliers = 20\n");
  const fs::path plan = folder.write("plan.toml", "repetitions = 6\nvariants = [\"vo+" + config.string() +
                                                      "\"]\n[recorded]\nsequences = [\"copy\"]\n");
  const fs::path uninterrupted = folder.path() / "uninterrupted.sqlite";
  const auto start = std::chrono::steady_clock::now();
  const ProgramResult whole = replay_bench(folder, plan, uninterrupted);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::chrono::duration<double, std::milli> whole_ms = std::chrono::steady_clock::now() - start;

  const fs::path killed = folder.path() / "killed.sqlite";
  int interrupted = 0;
  for (const double fraction : {0.2, 0.35, 0.5})
    interrupted += kill_after(folder, plan, killed, static_cast<int>(fraction * whole_ms.count())) ? 1 : 0;
  EXPECT_GE(interrupted, 1);
  ASSERT_EQ(replay_bench(folder, plan, killed).exit_code, 0);
  const auto content = loops_of(uninterrupted);
  ASSERT_EQ(content.size(), 6U);
  EXPECT_GT(content.begin()->second.metrics[0], 0.0) << "the sequence has no loop";
  EXPECT_TRUE(content == loops_of(killed));
}

TEST(BenchKill, TheSecondCallExecutesNothing) {
  const TemporaryFolder folder;
  const fs::path plan = write_replay_plan(folder, 2, "");
  const fs::path store = folder.path() / "store.sqlite";
  EXPECT_NE(replay_bench(folder, plan, store).out.find("4 of 4 runs executed, 0 cached"), std::string::npos);
  EXPECT_NE(replay_bench(folder, plan, store).out.find("0 of 4 runs executed, 4 cached"), std::string::npos);
}

TEST(BenchKill, TwoWorkersExecuteEachRunOnce) {
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "log").string();
  const fs::path plan = write_replay_plan(folder, 20, "\"--log\", \"" + log + "\", ");
  const fs::path store = folder.path() / "store.sqlite";
  const pid_t other = fork();
  if (other == 0) {
    const ProgramResult result = replay_bench(folder, plan, store);
    if (result.exit_code != 0) std::fputs(result.err.c_str(), stderr);
    _exit(result.exit_code);
  }
  const ProgramResult result = replay_bench(folder, plan, store);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  int status = 0;
  waitpid(other, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(bench::Store(store).runs().size(), 40u);
  std::multiset<std::string> finished;
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);) finished.insert(line);
  EXPECT_EQ(finished.size(), 40u);  // no run was executed twice
}

bench::StoredRun first_run(const fs::path& store) { return bench::Store(store).runs().front(); }

TEST(BenchKill, RecordsTheSignalOfACrashedRun) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  EXPECT_EQ(replay_bench(folder, write_replay_plan(folder, 1, "\"--crash-after\", \"7\", "), store).exit_code,
            1);
  EXPECT_EQ(first_run(store).outcome, bench::Outcome::kCrashed);
  EXPECT_NE(first_run(store).detail.find("signal 11"), std::string::npos);
}

TEST(BenchKill, TerminatesARunAtItsTimeLimit) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  EXPECT_EQ(replay_bench(folder, write_replay_plan(folder, 1, "\"--hang\", ", "time_limit_s = 0.3\n"), store)
                .exit_code,
            1);
  EXPECT_EQ(first_run(store).outcome, bench::Outcome::kTimedOut);
}

TEST(BenchKill, TerminatesARunAtItsMemoryLimit) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  EXPECT_EQ(
      replay_bench(folder, write_replay_plan(folder, 1, "\"--fill\", \"300\", ", "memory_limit_mb = 100\n"),
                   store)
          .exit_code,
      1);
  EXPECT_EQ(first_run(store).outcome, bench::Outcome::kOutOfMemory);
}

}  // namespace
}  // namespace stillpoint
