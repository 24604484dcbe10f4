// SPDX-License-Identifier: BSD-3-Clause
// External programs as benchmark systems: exported sequences, and import of their trajectories and times.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "bench/store/store.h"
#include "tests/support/program.h"
#include "tests/support/sequences/fake_sequence.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReplay = STILLPOINT_BINARY_DIR "/tests/replay_program";

/// Executes a command that finds the rendered sequence by its name, office.
ProgramResult run_here(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  ProgramOptions options;
  options.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string(),
                         "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string(),
                         "STILLPOINT_CACHE=" + (folder.path() / "cache").string()};
  return run_program(arguments, options);
}

std::string store_of(const TemporaryFolder& folder) { return (folder.path() / "store.sqlite").string(); }

/// Benchmarks the system of a file in the folder on the rendered sequence.
/// @param keys further lines of the plan
/// @param tables at its end
ProgramResult bench_system(const TemporaryFolder& folder, const std::string& file,
                           const std::string& keys = "", const std::string& tables = "") {
  const fs::path plan = folder.write("plan.toml", "systems = [\"" + (folder.path() / file).string() +
                                                      "\"]\nprotocols = [\"strict:se3\"]\n" + keys +
                                                      "[recorded]\nsequences = [\"office\"]\n" + tables);
  return run_here(folder, {"bench", plan.string(), "--store", store_of(folder), "--out",
                           (folder.path() / "out").string()});
}

/// Writes the description of the replay program. @param error of its trajectory [m], or a placeholder
void write_replay(const TemporaryFolder& folder, const std::string& name, const std::string& error,
                  const std::string& keys = "") {
  folder.write(name + ".toml", "name = \"replay\"\ncommand = [\"" + std::string(kReplay) +
                                   "\", \"--error\", \"" + error +
                                   "\", \"run\", \"{sequence}\", \"--out\", \"{out}\"]\n" + keys);
}

/// Benchmarks the replay program. @param keys additional lines of its system file
ProgramResult run_bench(const TemporaryFolder& folder, const std::string& keys,
                        const std::string& flags = "") {
  folder.write("replay.toml", "name = \"replay\"\n" + keys + "command = [\"" + kReplay + "\", " + flags +
                                  "\"run\", \"{sequence}\", \"--out\", \"{out}\"]\n");
  return bench_system(folder, "replay.toml");
}

bench::StoredRun run_of(const TemporaryFolder& folder) {
  return bench::Store(folder.path() / "store.sqlite").runs().front();
}

TEST(ExternalSystem, ReadsAnExportedSequenceAndIsScored) {
  const TemporaryFolder folder;
  const ProgramResult result = run_bench(folder, "layout = \"tum\"\ntimings = \"result.json\"\n",
                                         "\"--error\", \"0.01\", \"--pause\", \"200\", ");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const bench::StoredRun run = run_of(folder);
  EXPECT_EQ(run.identity.system, "replay");
  EXPECT_EQ(run.outcome, bench::Outcome::kOk) << run.detail;
  // A sine of amplitude 0.01 m has an RMS of 0.01 / sqrt(2) = 0.0071 m; the alignment reduces it slightly.
  EXPECT_NEAR(*bench::metric_value(run, "ate_rmse_m"), 0.0071, 0.0003);
  EXPECT_NEAR(*bench::metric_value(run, "strict:se3/ate_rmse_m"), 0.0071, 0.0003);
  EXPECT_GT(*bench::metric_value(run, "process_wall_s"), 0.0);
  EXPECT_GT(bench::metric_value(run, "peak_memory_mb").value_or(0.0), 1.0);
  EXPECT_EQ(run.costs.size(), 2u);
  EXPECT_TRUE(fs::exists(folder.path() / "cache" / "exports"));
  EXPECT_NE(result.out.find("| office   | replay"), std::string::npos) << result.out;
}

TEST(ExternalSystem, HasTheCalibrationInTheFormatOfAProgram) {
  const TemporaryFolder folder;
  folder.write("s.toml",
               "name = \"s\"\nlayout = \"as_is\"\ncalibration_format = \"openvins\"\ncalibration_file = "
               "\"config/rig.yaml\"\ncommand = [\"cat\", \"{calibration}\"]\n");
  const fs::path out = folder.path() / "run";
  const ProgramResult result = run_here(
      folder, {"systems", "run", (folder.path() / "s.toml").string(), "office", "--out", out.string()});
  EXPECT_EQ(result.exit_code, 1) << result.err;  // no trajectory
  std::ifstream file(out / "program.log");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(text.find("T_imu_cam"), std::string::npos) << text << result.out;
}

TEST(ExternalSystem, HasTheInertialAxesWithTheSamplesThatTheyAreOf) {
  const TemporaryFolder folder;
  const fs::path sequence = folder.path() / "turned";
  fs::copy(rendered_sequence(), sequence, fs::copy_options::recursive);
  folder.write("turned/rig.toml", "imu = { gyro_axes = [1.125, 0, 0, 0, 1, 0, 0, 0, 1] }\n");
  for (const auto& [layout, row] : {std::pair("as_is", "[1.125, 0, 0]"), std::pair("tum", "[1, 0, 0]")}) {
    folder.write("s.toml",
                 std::string("name = \"s\"\nlayout = \"") + layout +
                     "\"\ncalibration_format = \"openvins\"\ncommand = [\"cat\", \"{calibration}\"]\n");
    const fs::path out = folder.path() / layout;
    static_cast<void>(run_here(folder, {"systems", "run", (folder.path() / "s.toml").string(),
                                        sequence.string(), "--out", out.string()}));
    std::ifstream file(out / "program.log");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(text.find(std::string("Tw:\n    - ") + row), std::string::npos) << layout << "\n" << text;
  }
}

TEST(ExternalSystem, ARunThatEndsOnTheInterruptionIsNotStored) {
  const TemporaryFolder folder;
  folder.write(
      "s.toml",
      "name = \"s\"\nlayout = \"as_is\"\ncommand = [\"sh\", \"-c\", \"trap 'exit 0' TERM; kill -TERM "
      "$PPID; while :; do sleep 0.05; done\"]\n");
  const ProgramResult result = bench_system(folder, "s.toml");
  EXPECT_EQ(result.exit_code, 130) << result.out << result.err;
  EXPECT_TRUE(bench::Store(store_of(folder)).runs().empty());
}

TEST(ExternalSystem, WithoutTrajectoryIsLost) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_bench(folder, "layout = \"tum\"\ntrajectory = \"elsewhere.txt\"\n").exit_code, 1);
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kLost);
  EXPECT_EQ(run_of(folder).detail, "wrote no elsewhere.txt");
}

// Its calibration is missing, which the program does not need: it has not crashed.
TEST(ExternalSystem, OnASequenceThatCannotBeReadIsBadData) {
  const TemporaryFolder folder;
  fake_sequence(folder, "kitchen");
  folder.write("copy.toml",
               "name = \"copy\"\nlayout = \"as_is\"\n"
               "command = [\"cp\", \"{sequence}/groundtruth.txt\", \"{out}/trajectory.tum\"]\n");
  const fs::path plan =
      folder.write("plan.toml", "systems = [\"copy.toml\"]\n[recorded]\nsequences = [\"./kitchen\"]\n");
  const ProgramResult result = run_here(folder, {"bench", plan.string(), "--store", store_of(folder)});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kBadData);
  EXPECT_NE(run_of(folder).detail.find("rig.toml: the camera calibration is missing"), std::string::npos)
      << run_of(folder).detail;
}

TEST(ExternalSystem, WithOnePoseIsLost) {
  const TemporaryFolder folder;
  const std::string script =
      folder.write("one.sh", "#!/bin/sh\necho '0.1 0 0 0 0 0 0 1' >\"$1/trajectory.tum\"\n").string();
  folder.write("one.toml",
               "name = \"one\"\nlayout = \"tum\"\ncommand = [\"sh\", \"" + script + "\", \"{out}\"]\n");
  const ProgramResult result = bench_system(folder, "one.toml");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kLost);
  EXPECT_EQ(run_of(folder).detail, "trajectory.tum has only one pose, which tells no error");
  EXPECT_NE(result.out.find("| lost "), std::string::npos) << result.out;
}

TEST(ExternalSystem, WithPosesAtOtherTimesIsLost) {
  const TemporaryFolder folder;
  const std::string script = folder
                                 .write("late.sh",
                                        "#!/bin/sh\nfor t in 900.0 900.1 900.2; do echo $t 0 0 0 0 0 0 1; "
                                        "done >\"$1/trajectory.tum\"\n")
                                 .string();
  folder.write("late.toml",
               "name = \"late\"\nlayout = \"tum\"\ncommand = [\"sh\", \"" + script + "\", \"{out}\"]\n");
  EXPECT_EQ(bench_system(folder, "late.toml").exit_code, 1);
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kLost);
  EXPECT_NE(run_of(folder).detail.find("trajectory.tum has poses from 900"), std::string::npos)
      << run_of(folder).detail;
}

TEST(ExternalSystem, IsRejectedWithoutACommand) {
  const TemporaryFolder folder;
  const auto system = folder.write("s.toml", "name = \"s\"\n");
  const auto plan = folder.write(
      "plan.toml", "systems = [\"" + system.string() + "\"]\n[rendered]\nsequences = [\"market\"]\n");
  const ProgramResult result = run_program({"plan", "show", plan.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("s.toml: has no command"), std::string::npos) << result.err;
}

std::vector<bench::StoredRun> runs_of(const TemporaryFolder& folder) {
  return bench::Store(store_of(folder)).runs();
}

// The exported sequence has the fault; poses of the true trajectory are not wrong.
TEST(ExternalSystem, IsExecutedWithAFault) {
  const TemporaryFolder folder;
  write_replay(folder, "replay", "0.001");
  const ProgramResult result =
      bench_system(folder, "replay.toml",
                   "faults = [\"none\", \"blank:start=1\"]\nexpected = [\"survive\", \"survive\"]\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::vector<bench::StoredRun> runs = runs_of(folder);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_FALSE(bench::metric_value(runs[0], "false_confidence"));
  EXPECT_EQ(*bench::metric_value(runs[1], "false_confidence"), 0.0);
  for (const char* report : {"summary", "imperfections"}) {
    const ProgramResult stats =
        run_here(folder, {"stats", report, "--plan", "plan", "--store", store_of(folder)});
    EXPECT_EQ(stats.exit_code, 0) << stats.err;
    EXPECT_NE(stats.out.find("replay"), std::string::npos) << stats.out;
  }
  const ProgramResult matrix = run_here(
      folder,
      {"stats", "faults", "--plan", (folder.path() / "plan.toml").string(), "--store", store_of(folder)});
  EXPECT_EQ(matrix.exit_code, 0) << matrix.err;
  const std::string page = (folder.path() / "page").string();
  EXPECT_EQ(run_here(folder, {"report", store_of(folder), "--out", page}).exit_code, 0);
  std::size_t exports = 0;
  std::set<std::uintmax_t> sizes;  // of the image 2 s after the first one, which is blank in one of them
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path() / "cache" / "exports")) {
    ++exports;
    std::vector<fs::path> images;
    for (const fs::directory_entry& image : fs::directory_iterator(entry.path() / "office" / "rgb"))
      images.push_back(image.path());
    std::ranges::sort(images);
    sizes.insert(fs::file_size(images.at(45)));
  }
  EXPECT_EQ(exports, 2u);
  EXPECT_EQ(sizes.size(), 2u);
}

TEST(ExternalSystem, AChangeOfTheSequenceIsAnErrorAndReachesNoLaterRun) {
  const TemporaryFolder folder;
  folder.write("harmful.toml", "name = \"harmful\"\ncommand = [\"sh\", \"-c\", \"'" + std::string(kReplay) +
                                   "' --error 0.01 run '{sequence}' --out '{out}' && "
                                   "rm '{sequence}/imu.txt'\"]\n");
  EXPECT_EQ(bench_system(folder, "harmful.toml").exit_code, 1);
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kBadData);
  EXPECT_NE(run_of(folder).detail.find("files of the sequence were changed"), std::string::npos)
      << run_of(folder).detail;
  write_replay(folder, "replay", "0.01");
  EXPECT_EQ(bench_system(folder, "replay.toml").exit_code, 0);
  std::size_t inertial = 0;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(folder.path() / "cache" / "exports"))
    inertial += entry.path().filename() == "imu.txt" ? 1 : 0;
  EXPECT_EQ(inertial, 1u);
}

/// A copy of the rendered sequence, as a recording of a user, and a plan of systems that read its files.
ProgramResult bench_copy(const TemporaryFolder& folder, const std::string& systems) {
  if (!fs::exists(folder.path() / "copy"))
    fs::copy(rendered_sequence(), folder.path() / "copy", fs::copy_options::recursive);
  folder.write("plan.toml", "systems = [" + systems + "]\n[recorded]\nsequences = [\"./copy\"]\n");
  return run_here(folder, {"bench", (folder.path() / "plan.toml").string(), "--store", store_of(folder),
                           "--out", (folder.path() / "out").string(), "--jobs", "1"});
}

TEST(ExternalSystem, AChangeOfARecordingIsAnErrorAndStopsLaterRuns) {
  const TemporaryFolder folder;
  folder.write("harmful.toml", "name = \"harmful\"\nlayout = \"as_is\"\ncommand = [\"sh\", \"-c\", \"'" +
                                   std::string(kReplay) +
                                   "' --error 0.01 run '{sequence}' --out '{out}' && "
                                   "rm '{sequence}/request.toml' && touch '{sequence}/new.txt'\"]\n");
  write_replay(folder, "replay", "0.01", "layout = \"as_is\"\n");
  const ProgramResult result = bench_copy(folder, "\"harmful.toml\", \"replay.toml\"");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const std::vector<bench::StoredRun> runs = bench::Store(folder.path() / "store.sqlite").runs();
  ASSERT_EQ(runs.size(), 2u);
  for (const bench::StoredRun& run : runs) {
    EXPECT_EQ(run.outcome, bench::Outcome::kBadData) << run.identity.system;
    EXPECT_NE(run.detail.find("copy/new.txt new, copy/request.toml removed"), std::string::npos)
        << run.detail;
    EXPECT_FALSE(bench::metric_value(run, "ate_m")) << run.identity.system;
  }
}

TEST(ExternalSystem, ASingleRunThatChangesARecordingIsAnError) {
  const TemporaryFolder folder;
  fs::copy(rendered_sequence(), folder.path() / "copy", fs::copy_options::recursive);
  folder.write("touch.toml",
               "name = \"touch\"\nlayout = \"as_is\"\n"
               "command = [\"touch\", \"{sequence}/request.toml\"]\n");
  const ProgramResult result =
      run_here(folder, {"systems", "run", (folder.path() / "touch.toml").string(),
                        (folder.path() / "copy").string(), "--out", (folder.path() / "single").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("bad_data, files of the sequence were changed"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("copy/request.toml changed"), std::string::npos) << result.out;
}

TEST(ExternalSystem, AFileBesideARecordingIsNoListOfItsFiles) {
  const TemporaryFolder folder;
  folder.write("copy.files", "notes of the user\n");
  write_replay(folder, "replay", "0.01", "layout = \"as_is\"\n");
  EXPECT_EQ(bench_copy(folder, "\"replay.toml\"").exit_code, 0);
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kOk) << run_of(folder).detail;
}

TEST(ExternalSystem, IsExecutedOnTheFirstFrames) {
  const TemporaryFolder folder;
  write_replay(folder, "replay", "0.001");
  EXPECT_EQ(bench_system(folder, "replay.toml", "max_frames = 30\n").exit_code, 0);
  EXPECT_EQ(*bench::metric_value(run_of(folder), "coverage"), 1.0);
  std::size_t images = 0;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(folder.path() / "cache" / "exports"))
    images += entry.path().parent_path().filename() == "rgb" ? 1 : 0;
  EXPECT_EQ(images, 30u);
}

TEST(ExternalSystem, ParametersAreSwept) {
  const TemporaryFolder folder;
  write_replay(folder, "replay", "{param.error}", "[param]\nerror = 0.5\n");
  const ProgramResult result =
      bench_system(folder, "replay.toml", "repetitions = 2\n", "[sweep]\nparam.error = [0.01, 0.02]\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::vector<bench::StoredRun> runs = runs_of(folder);
  ASSERT_EQ(runs.size(), 4u);
  for (const bench::StoredRun& run : runs) {
    EXPECT_EQ(run.identity.axis, "param.error");
    EXPECT_NEAR(*bench::metric_value(run, "ate_rmse_m"), 0.71 * run.identity.axis_value, 0.001);
  }
  const ProgramResult sweep = run_here(folder, {"stats", "sweep", "--store", store_of(folder)});
  EXPECT_EQ(sweep.exit_code, 0) << sweep.err;
  EXPECT_NE(sweep.out.find("param.error"), std::string::npos) << sweep.out;
  const ProgramResult repeat = run_here(folder, {"stats", "repeat", "--store", store_of(folder)});
  EXPECT_EQ(repeat.exit_code, 0) << repeat.err;
  EXPECT_NE(repeat.out.find("All repetitions are bit-equal"), std::string::npos) << repeat.out;
  // Two runs were repeated once: 0.05^(1/2) = 0.22.
  EXPECT_NE(repeat.out.find("up to 78 % of the runs of replay (2)"), std::string::npos) << repeat.out;
  EXPECT_EQ(repeat.out.find("a single run is sufficient"), std::string::npos) << repeat.out;
}

TEST(ExternalSystem, ParameterSetsAreAnAblation) {
  const TemporaryFolder folder;
  write_replay(folder, "replay", "{param.error}", "[param]\nerror = 0.01\n[variant.worse]\nerror = 0.03\n");
  const std::string file = (folder.path() / "replay.toml").string();
  const fs::path plan = folder.write("plan.toml", "systems = [\"" + file + "\", \"" + file +
                                                      "+worse\"]\nablation_base = \"replay\"\n[recorded]\n"
                                                      "sequences = [\"office\"]\n");
  const ProgramResult bench = run_here(folder, {"bench", plan.string(), "--store", store_of(folder), "--out",
                                                (folder.path() / "out").string()});
  EXPECT_EQ(bench.exit_code, 0) << bench.err;
  EXPECT_NE(bench.out.find("replay+worse"), std::string::npos) << bench.out;
  const ProgramResult ablation = run_here(folder, {"stats", "ablation", store_of(folder)});
  EXPECT_EQ(ablation.exit_code, 0) << ablation.err;
  EXPECT_NE(ablation.out.find("replay+worse"), std::string::npos) << ablation.out;
  EXPECT_NE(ablation.out.find("+200.0 %"), std::string::npos) << ablation.out;  // 0.03 / 0.01 - 1
  const std::string page = (folder.path() / "page").string();
  EXPECT_EQ(run_here(folder, {"report", store_of(folder), "--out", page}).exit_code, 0);
}

/// A system without motion that reads the rows of `data play`.
void write_reader(const TemporaryFolder& folder) {
  folder.write("reader.awk", "$1 == \"rgb\" { print $2, 0, 0, 0, 0, 0, 0, 1 > OUT \"/trajectory.tum\" }\n");
  folder.write(
      "reader.toml",
      "name = \"reader\"\ncommand = [\"sh\", \"-c\", \"{bin}/stillpoint data play {sequence} --speed {speed} "
      "| awk -v OUT={out} -f {here}/reader.awk\"]\n");
}

TEST(ExternalSystem, IsPlayedAtTheRateOfTheSensors) {
  const TemporaryFolder folder;
  write_reader(folder);
  const ProgramResult result = bench_system(folder, "reader.toml", "mode = \"realtime\"\nmax_frames = 46\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const bench::StoredRun run = run_of(folder);
  EXPECT_EQ(run.identity.mode, "external, realtime");
  EXPECT_EQ(*bench::metric_value(run, "coverage"), 1.0);
  EXPECT_GE(*bench::metric_value(run, "process_wall_s"), 1.5);  // 45 intervals at 30 Hz
  write_replay(folder, "replay", "0.01");
  const ProgramResult refused = bench_system(folder, "replay.toml", "mode = \"realtime\"\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("needs {speed}"), std::string::npos) << refused.err;
}

TEST(ExternalSystem, AStoredRunIsRepeatedWithItsDescription) {
  const TemporaryFolder folder;
  const auto describe = [&folder](const std::string& error) {
    folder.write("replay.toml", "name = \"re+play\"\ncommand = [\"" + std::string(kReplay) +
                                    "\", \"--error\", \"" + error +
                                    "\", \"run\", \"{sequence}\", \"--out\", \"{out}\"]\n");
  };
  describe("0.01");
  EXPECT_EQ(bench_system(folder, "replay.toml").exit_code, 0);
  const std::vector<std::string> command = {"reproduce", run_of(folder).key,
                                            "--store",   store_of(folder),
                                            "--out",     (folder.path() / "again").string()};
  describe("0.02");  // the description of the run is the stored one
  const ProgramResult result = run_here(folder, command);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("equal trajectories; ATE 0.007"), std::string::npos) << result.out;
  // The plan of the store has the run of the newer description then.
  EXPECT_EQ(bench_system(folder, "replay.toml").exit_code, 0);
  const ProgramResult older = run_here(folder, command);
  EXPECT_EQ(older.exit_code, 0) << older.out << older.err;
  EXPECT_NE(older.out.find("equal trajectories; ATE 0.007"), std::string::npos) << older.out;
  fs::remove_all(folder.path() / "cache");
  const ProgramResult unknown = run_here(folder, {"reproduce", "0123456789", "--store", store_of(folder)});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("store list"), std::string::npos) << unknown.err;
  fs::remove(folder.path() / "replay.toml");
  const ProgramResult missing = run_here(folder, command);
  EXPECT_EQ(missing.exit_code, 2) << missing.out;
  for (const char* part : {"cannot be repeated", "must exist where they were", "replay.toml"})
    EXPECT_NE(missing.err.find(part), std::string::npos) << missing.err;
}

TEST(ExternalSystem, ARunIsProfiled) {
  const TemporaryFolder folder;
  write_replay(folder, "replay", "0.01", "timings = \"result.json\"\n");
  const std::string out = (folder.path() / "run").string();
  const ProgramResult result =
      run_here(folder, {"systems", "run", (folder.path() / "replay.toml").string(), "office", "--out", out});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"feature_tracking", "state_optimization", "p95"})
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out;
  std::ifstream file(fs::path(out) / "result.json");
  const std::string json{std::istreambuf_iterator<char>(file), {}};
  for (const char* metric : {"process_cpu_s", "process_wall_s", "peak_memory_mb"})
    EXPECT_NE(json.find(metric), std::string::npos) << json;
}

// Each verb of the program is in the table, and none of its cells is empty or says only that it does not
// work.
TEST(ExternalSystem, TheTableOfTheManualHasAllVerbs) {
  std::ifstream file(STILLPOINT_SOURCE_DIR "/bench/README.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| verb |") || (!rows.empty() && line.starts_with("|"))) rows.push_back(line);
    if (!rows.empty() && line.empty()) break;
  }
  ASSERT_GT(rows.size(), 10u);
  for (const std::string& row : rows) {
    const std::string last = row.substr(row.rfind("| ", row.size() - 2) + 2);
    EXPECT_GT(last.size(), 4u) << row;
    EXPECT_FALSE(last.starts_with("no")) << row;
  }
  const std::string help = run_program({"--help"}).out;
  std::istringstream lines(help.substr(help.find("Subcommands:")));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string verb;
    if (!(words >> verb)) continue;
    const bool is_listed = std::ranges::any_of(rows, [&](const std::string& row) {
      return row.find("`" + verb + "`") < row.find(" | ") || row.find("`" + verb + " ") < row.find(" | ");
    });
    EXPECT_TRUE(is_listed) << verb;
  }
}

/// Compares two descriptions in three pairs: bit-equal results make a change exact.
ProgramResult compare_systems(const TemporaryFolder& folder, const std::string& base,
                              const std::string& head) {
  const fs::path plan = folder.write("plan.toml", "[recorded]\nsequences = [\"office\"]\n");
  return run_here(folder, {"compare", (folder.path() / base).string(), (folder.path() / head).string(),
                           "--plan", plan.string(), "--pairs", "3", "--store", store_of(folder)});
}

TEST(ExternalSystem, TwoDescriptionsAreComparedInPairs) {
  const TemporaryFolder folder;
  write_replay(folder, "a", "0.01");
  write_replay(folder, "b", "0.02");
  const ProgramResult worse = compare_systems(folder, "a.toml", "b.toml");
  EXPECT_EQ(worse.exit_code, 1) << worse.out << worse.err;
  EXPECT_NE(worse.out.find("3 pairs of runs: 3 compared"), std::string::npos) << worse.out;
  std::vector<std::string> order;
  for (const bench::StoredRun& run : runs_of(folder)) order.push_back(run.identity.build.substr(0, 4));
  EXPECT_EQ(order, (std::vector<std::string>{"base", "head", "head", "base", "base", "head"}));
  fs::remove(store_of(folder));
  EXPECT_NE(compare_systems(folder, "a.toml", "a.toml").exit_code, 1);
  const ProgramResult mixed =
      run_here(folder, {"compare", (folder.path() / "a.toml").string(), store_of(folder)});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_NE(mixed.err.find("compare two descriptions"), std::string::npos) << mixed.err;
}

TEST(ExternalSystem, VersionsHaveADashboardAndAreCompared) {
  const TemporaryFolder folder;
  for (const auto& [version, error] : {std::pair("1.0", "0.01"),
                                       {"1.1", "0.01"},
                                       {"1.2", "0.01"},
                                       {"2.0", "0.05"},
                                       {"2.1", "0.05"},
                                       {"2.2", "0.05"}}) {
    write_replay(folder, "replay", error, "version = \"" + std::string(version) + "\"\n");
    EXPECT_EQ(bench_system(folder, "replay.toml", "repetitions = 3\n").exit_code, 0);
  }
  const std::string out = (folder.path() / "dashboard").string();
  const ProgramResult dashboard =
      run_here(folder, {"dashboard", store_of(folder), "--out", out, "--system", "replay"});
  EXPECT_EQ(dashboard.exit_code, 0) << dashboard.err;
  EXPECT_TRUE(fs::exists(fs::path(out) / "index.html"));
  EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(out) / "commits"), {}), 6);
  const ProgramResult regressions = run_here(folder, {"regressions", store_of(folder)});
  EXPECT_EQ(regressions.exit_code, 1) << regressions.err;
  EXPECT_NE(regressions.out.find("2.0"), std::string::npos) << regressions.out;
  const std::string store = store_of(folder);
  EXPECT_NE(run_here(folder, {"compare", store + "@1.0", store + "@1.1"}).exit_code, 1);
  const ProgramResult worse = run_here(folder, {"compare", store + "@1.1", store + "@2.0"});
  EXPECT_EQ(worse.exit_code, 1) << worse.out << worse.err;
  EXPECT_EQ(run_here(folder, {"regressions", store, "--system", "orb"}).exit_code, 2);
}

/// The first block of code that follows `from` in a document.
std::string code_block(const std::string& document, std::size_t& from) {
  const std::size_t begin = document.find('\n', document.find("```", from)) + 1;
  const std::size_t end = document.find("```", begin);
  from = end + 3;
  return document.substr(begin, end - begin);
}

TEST(ExternalSystem, TheToyOfTheManualRuns) {
  std::ifstream file(STILLPOINT_SOURCE_DIR "/bench/README.md");
  const std::string manual{std::istreambuf_iterator<char>(file), {}};
  std::size_t at = manual.find("A toy in another language");
  ASSERT_NE(at, std::string::npos);
  const TemporaryFolder folder;
  folder.write("toy.toml", code_block(manual, at));
  folder.write("toy.awk", code_block(manual, at));
  const ProgramResult result = bench_system(folder, "toy.toml");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kOk) << run_of(folder).detail;
  EXPECT_EQ(*bench::metric_value(run_of(folder), "coverage"), 1.0);
}

TEST(ExternalSystem, MessagesOfTheProgramAreStored) {
  const TemporaryFolder folder;
  folder.write("loud.toml", "name = \"loud\"\ncommand = [\"sh\", \"-c\", \"echo to stdout; exit 3\"]\n");
  EXPECT_EQ(bench_system(folder, "loud.toml").exit_code, 1);
  const bench::Store store(store_of(folder));
  EXPECT_EQ(store.attachment(run_of(folder), "log"), "to stdout\n");
  EXPECT_EQ(run_of(folder).detail, "exited with code 3: to stdout");
}

TEST(ExternalSystem, BenchRejectsFilesThatAreNotStores) {
  const TemporaryFolder folder;
  const auto plan = folder.write("plan.toml", "variants = [\"vo\"]\n[rendered]\nsequences = [\"market\"]\n");
  const auto notes = folder.write("notes.txt", std::string(3000, 'n'));
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", notes.string(), "--out", (folder.path() / "out").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.err.starts_with("stillpoint: error: " + notes.string())) << result.err;
  EXPECT_EQ(fs::file_size(notes), 3000u);
}

TEST(RegisteredSequence, IsRejectedAfterItsFilesHaveChanged) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  const auto plan = folder.write("plan.toml", "variants = [\"vo\"]\n[recorded]\nsequences = [\"named\"]\n");
  ProgramOptions options;
  options.environment = {"STILLPOINT_REGISTRY=" + (folder.path() / "sequences.json").string()};
  EXPECT_EQ(run_program({"data", "add", "named", copy.string()}, options).exit_code, 0);
  const std::string list = run_program({"data", "list"}, options).out;
  EXPECT_TRUE(list.starts_with("named ")) << list;
  EXPECT_EQ(run_program({"plan", "show", plan.string()}, options).exit_code, 0);
  std::ofstream(copy / "groundtruth.txt", std::ios::app) << "# one more line\n";
  const ProgramResult changed = run_program({"plan", "show", plan.string()}, options);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_NE(changed.err.find("as registered"), std::string::npos) << changed.err;
}

}  // namespace
}  // namespace stillpoint
