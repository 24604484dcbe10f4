// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint bench` with a plan file.
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A plan for the rendered sequence, used as a recorded one, and a missing sequence.
std::string plan_text(const std::string& variants) {
  return "title = \"Test\"\n[recorded]\nsequences = [\"" + rendered_sequence().filename().string() +
         "\", \"not_available\"]\nvariants = [" + variants + "]\nrequired = false\n";
}

ProgramResult run_bench(const TemporaryFolder& folder, const std::string& variants,
                        ProgramOptions options = {}) {
  const fs::path plan = folder.write("plan.toml", plan_text(variants));
  options.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string()};
  return run_program({"bench", plan.string(), "--out", (folder.path() / "out").string(), "--store",
                      (folder.path() / "store.sqlite").string(), "--jobs", "1"},
                     options);
}

nlohmann::json rows_of(const TemporaryFolder& folder) {
  return nlohmann::json::parse(std::ifstream(folder.path() / "out" / "table.json"))["rows"];
}

TEST(BenchCommand, ExecutesAllVariantsOnAllSequencesAndPrintsATable) {
  const TemporaryFolder folder;
  const ProgramResult result = run_bench(folder, "\"stillpoint\", \"vo\"");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json rows = rows_of(folder);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["variant"], "stillpoint");
  EXPECT_EQ(rows[0]["status"], "ok");
  EXPECT_LT(rows[0]["ate_rmse_m"], 0.05);
  EXPECT_EQ(rows[3]["sequence"], "not_available");
  EXPECT_EQ(rows[3]["status"], "skipped");
  std::ifstream markdown(folder.path() / "out" / "table.md");
  const std::string text{std::istreambuf_iterator<char>(markdown), {}};
  EXPECT_NE(text.find("| office        | vo         | ok      |"), std::string::npos) << text;
  EXPECT_NE(result.out.find("| office        | vo         | ok      |"), std::string::npos) << result.out;
}

TEST(BenchCommand, WritesOnlyTheStoreThatItIsTold) {
  const TemporaryFolder folder, working_folder;
  const fs::path plan = folder.write("plan.toml", plan_text("\"vo\""));
  const fs::path before = fs::current_path();
  fs::current_path(working_folder.path());
  const ProgramResult result =
      run_program({"bench", plan.string(), "--store", (folder.path() / "store.sqlite").string()},
                  {.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string()}});
  fs::current_path(before);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::is_empty(working_folder.path()));
  EXPECT_NE(result.out.find("| office        | vo      | ok      |"), std::string::npos) << result.out;
}

TEST(BenchCommand, PrintsAndWritesWhereTheTimeWent) {
  const TemporaryFolder folder;
  const ProgramResult result = run_bench(folder, "\"stillpoint\"");
  EXPECT_NE(result.out.find("start of processes"), std::string::npos) << result.out;
  const nlohmann::json profile = nlohmann::json::parse(std::ifstream(folder.path() / "out" / "profile.json"));
  EXPECT_EQ(profile["runs"], 1);
  EXPECT_GT(profile["odometry_s"], 0.0);
  EXPECT_GT(profile["storing_s"], 0.0);
  EXPECT_EQ(profile["other_process_s"], 0.0);
}

/// Number of files in the frame cache after a timing plan.
std::ptrdiff_t cached_after_timing(const TemporaryFolder& folder, const std::vector<std::string>& options) {
  const fs::path sequence = copy_of_rendered_sequence(folder);
  const fs::path plan = folder.write(
      "plan.toml", "kind = \"timing\"\n[recorded]\nsequences = [\"copy\"]\nvariants = [\"stillpoint\"]");
  std::vector<std::string> arguments = {"bench",   plan.string(),
                                        "--out",   (folder.path() / "out").string(),
                                        "--store", (folder.path() / "store.sqlite").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProgramResult result =
      run_program(arguments, {.environment = {"STILLPOINT_DATA=" + folder.path().string(),
                                              "STILLPOINT_CACHE=" + (folder.path() / "cache").string(),
                                              "STILLPOINT_CACHE_SIZE=1GB"}});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err.find("read images of copy") != std::string::npos, options.empty()) << result.err;
  std::error_code none;
  const fs::directory_iterator files(folder.path() / "cache" / "frames", none);
  return none ? 0 : std::count_if(begin(files), end(files), [](const fs::directory_entry& entry) {
    return entry.path().extension() == ".frames";
  });
}

TEST(BenchCommand, FillsTheFrameCacheBeforeTimingRuns) {
  EXPECT_EQ(cached_after_timing(TemporaryFolder(), {}), 1);
  EXPECT_EQ(cached_after_timing(TemporaryFolder(), {"--no-frame-cache"}), 0);
}

TEST(BenchCommand, ReportsAFailedRunWithItsReason) {
  const TemporaryFolder folder;
  // The gyroscope file of the recording is empty.
  const fs::path defective = copy_of_rendered_sequence(folder);
  std::ofstream(defective / "d400_gyroscope.txt", std::ios::trunc).close();
  const fs::path plan =
      folder.write("plan.toml", "[recorded]\nsequences = [\"copy\"]\nvariants = [\"stillpoint\"]");
  ProgramOptions options;
  options.environment = {"STILLPOINT_DATA=" + folder.path().string()};
  const ProgramResult result = run_program({"bench", plan.string(), "--out", (folder.path() / "out").string(),
                                            "--store", (folder.path() / "store.sqlite").string()},
                                           options);
  EXPECT_EQ(result.exit_code, 1);
  const nlohmann::json rows = rows_of(folder);
  EXPECT_EQ(rows[0]["status"], "bad_data");
  EXPECT_NE(rows[0]["reason"].get<std::string>().find("d400_gyroscope.txt"), std::string::npos);
  EXPECT_NE(result.out.find("copy stillpoint bad_data: "), std::string::npos);
}

TEST(BenchCommand, CtrlCWritesATableThatIsMarkedAsInterrupted) {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.interrupt_after = "run office stillpoint";
  const ProgramResult result = run_bench(folder, "\"stillpoint\", \"vo\"", options);
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_NE(result.out.find("Test (interrupted: not all runs were executed)"), std::string::npos)
      << result.out;
  EXPECT_NE(rows_of(folder)[1]["status"], "ok");  // the second run was not executed
}

TEST(BenchCommand, RejectsAnUnknownPlan) {
  const ProgramResult result = run_program({"bench", "quik"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "stillpoint: error: unknown plan \"quik\"; did you mean \"quick\"?\n");
}

}  // namespace
}  // namespace stillpoint
