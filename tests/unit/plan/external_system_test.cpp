// SPDX-License-Identifier: BSD-3-Clause
// Descriptions of external systems, their placeholders, and their runs in plans.
#include "bench/systems/external_system.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include "bench/plan/plan_matrix.h"
#include "bench/systems/external_run.h"
#include "bench/systems/module_times.h"
#include "eval/io/text_reader.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

void expect_bad_description(const std::string& text, const std::vector<std::string>& parts) {
  expect_input_error([&] { static_cast<void>(parse_external_system(text, "s.toml")); }, parts);
}

TEST(ExternalDescription, TheTemplateIsValid) {
  const ExternalSystem system = parse_external_system(description_template("my \"slam\""), "my_slam.toml");
  EXPECT_EQ(system.name, "my \"slam\"");
  EXPECT_EQ(system.command.size(), 3u);
  EXPECT_EQ(system.working_folder, "{out}");
}

TEST(ExternalDescription, NamesTheLineOfAFault) {
  const std::string begin = "name = \"s\"\ncommand = [\"s\"]\n";
  expect_bad_description(begin + "layuot = \"tum\"", {"s.toml:3: unknown key \"layuot\"", "\"layout\"?"});
  expect_bad_description(begin + "layout = \"tumm\"", {"s.toml:3: ", "\"tumm\"", "\"euroc\""});
  expect_bad_description(begin + "environment = [\"A\"]", {"s.toml:3: ", "\"NAME=value\""});
  expect_bad_description(begin + "calibration_template = \"none.in\"", {"s.toml:3: ", "none.in", "{fx}"});
  expect_bad_description(begin + "[param]\na = [1, 2]", {"s.toml:4: \"param.a\" is a list"});
  expect_bad_description("name = \"s\"\ncommand = [\"s\", \"{sequense}\"]",
                         {"s.toml:2: \"{sequense}\" is no placeholder", "\"sequence\"?"});
  expect_bad_description("name = \"s\"\ncommand = [\"s\", \"{param.a}\"]", {"s.toml:2: ", "[param]"});
  expect_bad_description("name = \"s\"\ncommand = [\"s\", \"{calibration}\"]",
                         {"s.toml:2: ", "calibration_template"});
  expect_bad_description(begin + "[source]\ngit = \".\"", {"s.toml:4: [source] has no binary"});
  expect_bad_description(begin + "[source]\nbinary = \"/bin/s\"", {"s.toml:4: ", "is absolute"});
  expect_bad_description(begin + "[source]\ngit = \"https://a.org/s\"\nbinary = \"s\"",
                         {"s.toml:4: ", "clone it"});
  expect_bad_description("name = \"s\"\ncommand = [\"{binary}\"]", {"s.toml:2: ", "[source]"});
  expect_bad_description("command = [\"s\"]", {"s.toml: has no name"});
  expect_bad_description("name = \"stillpoint\"\ncommand = [\"s\"]", {"s.toml:1: ", "use another name"});
  expect_bad_description("command = [\"s\"]\nname = \"a\\nb\"", {"s.toml:2: ", "line break"});
  expect_bad_description("name = \"s\"", {"s.toml: has no command"});
}

TEST(ExternalDescription, ParameterSetsAreVariants) {
  const TemporaryFolder folder;
  const std::string file =
      folder
          .write(
              "a+b.toml",
              "name = \"s\"\ncommand = [\"s\", \"{param.n}\"]\n[param]\nn = 1\nm = 2\n[variant.few]\nn = 9\n"
              "[variant.no-m]\nm = 0\n")
          .string();
  const ExternalSystem plain = load_external_system(file);
  EXPECT_EQ(plain.variant, "s");
  const ExternalSystem both = load_external_system(file + "+few+no-m");
  EXPECT_EQ(both.name, "s");
  EXPECT_EQ(both.variant, "s+few+no-m");
  EXPECT_EQ(both.param, (std::map<std::string, std::string>{{"n", "9"}, {"m", "0"}}));
  EXPECT_NE(both.hash, plain.hash);
  expect_input_error([&] { static_cast<void>(load_external_system(file + "+fwe")); },
                     {"a+b.toml: has no table [variant.fwe]", "\"few\"?"});
  const std::string empty =
      folder.write("e.toml", "name = \"s\"\ncommand = [\"s\"]\n[variant.few]\n").string();
  expect_input_error([&] { static_cast<void>(load_external_system(empty + "+few")); },
                     {"has no table [variant.few] with a parameter"});
  const std::string begin = "name = \"s\"\ncommand = [\"s\"]\n[param]\nn = 1\n";
  expect_bad_description(begin + "[variant.few]\nk = 1", {"s.toml:6: ", "\"variant.few.k\"", "[param]"});
  expect_bad_description(begin + "[variant]\nn = 1", {"s.toml:6: ", "\"variant.n\"", "[variant.SET]"});
}

TEST(Placeholders, OtherBracesAreNotChanged) {
  EXPECT_EQ(expanded("{a}{a} {print $1} {} {1} {", {{"a", "{b}"}}, "p"), "{b}{b} {print $1} {} {1} {");
}

// A rebuilt program and an edited script are other systems, whose runs are not in the store.
TEST(ExternalDescription, HashContainsTheFilesOfTheCommand) {
  const TemporaryFolder folder;
  folder.write("run.sh", "exit 0\n");
  const std::string file =
      folder.write("s.toml", "name = \"s\"\ncommand = [\"sh\", \"{here}/run.sh\"]\n").string();
  const std::string before = load_external_system(file).hash;
  EXPECT_EQ(load_external_system(file).hash, before);
  folder.write("run.sh", "exit 1\n");
  EXPECT_NE(load_external_system(file).hash, before);
  // The program of a container is that of its image.
  const std::string program = folder.write("bin/slam", "1").string();
  const std::string contained = folder
                                    .write("sys/s.toml",
                                           "name = \"s\"\nrunner = \"podman\"\nimage = "
                                           "\"s:1\"\ncommand = [\"" +
                                               program + "\"]\n")
                                    .string();
  const std::string of_image = load_external_system(contained).hash;
  folder.write("bin/slam", "2");
  EXPECT_EQ(load_external_system(contained).hash, of_image);
}

TEST(ExternalDescription, HashContainsScriptsOfShellsAndInterpreters) {
  const TemporaryFolder folder;
  for (const char* const keys :
       {"command = [\"sh\", \"-c\", 'cat \"{sequence}/rgb.txt\" | \"{here}/slam.awk\" >\"{out}/t\"']",
        "command = [\"slam\", \"--config={here}/slam.awk\"]",
        "working_folder = \".\"\ncommand = [\"awk\", \"-f\", \"slam.awk\"]",
        "working_folder = \"{here}\"\ncommand = [\"awk\", \"-f\", \"slam.awk\"]"}) {
    folder.write("a b/slam.awk", "1\n");
    const std::string file = folder.write("a b/s.toml", std::string("name = \"s\"\n") + keys + "\n").string();
    const std::string before = load_external_system(file).hash;
    folder.write("a b/slam.awk", "2\n");
    EXPECT_NE(load_external_system(file).hash, before) << keys;
  }
}

TEST(ExternalDescription, FindsItsProgramBesideItAndInPath) {
  const TemporaryFolder folder;
  const fs::path program = folder.write("slam", "#!/bin/sh\n");
  ExternalSystem system =
      load_external_system(folder.write("s.toml", "name = \"s\"\ncommand = [\"./slam\"]\n").string());
  EXPECT_EQ(find_program(system), "");  // not executable
  chmod(program.c_str(), 0755);
  EXPECT_EQ(find_program(system), program.string());
  system.command = {"{here}/slam"};
  EXPECT_EQ(find_program(system), program.string());
  system.command = {"sh"};
  EXPECT_TRUE(find_program(system).ends_with("/sh"));
  system.command = {"no_such_program"};
  EXPECT_EQ(find_program(system), "");
}

TEST(Placeholders, OfTheCalibration) {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 500.5, .fy = 501, .cx = 320, .cy = 240};
  rig.camera.distortion = {0.1, -0.2, 0.003, 0.004, 0.05};
  rig.T_b_c.p = {1, 2, 3};
  Placeholders values = calibration_placeholders(rig, {.frames_per_s = 30, .imu_hz = 200});
  EXPECT_EQ(values.at("fx"), "500.5");
  EXPECT_EQ(values.at("p1"), "0.003");
  EXPECT_EQ(values.at("k3"), "0.05");
  EXPECT_EQ(values.at("T_b_c"),
            "1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 1.0");
  EXPECT_EQ(values.at("fps"), "30");
  EXPECT_EQ(values.at("fy"), "501.0");
  rig.camera.model = CameraModel::kKannalaBrandt;
  values = calibration_placeholders(rig, {});
  EXPECT_EQ(values.at("k4"), "0.004");
  EXPECT_FALSE(values.contains("p1"));
}

TEST(ExternalDescription, ExamplesAreValidWithTheirTemplates) {
  std::size_t examples = 0;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(STILLPOINT_SOURCE_DIR "/bench/systems/examples")) {
    if (entry.path().extension() != ".toml") continue;
    ++examples;
    const ExternalSystem system = load_external_system(entry.path().string());
    Placeholders values = calibration_placeholders(Rig{}, {});
    for (const auto& [name, value] : system.param) values[std::string(kParamPrefix) + name] = value;
    const fs::path file = fs::path(system.folder) / system.calibration_template;
    EXPECT_NO_THROW(static_cast<void>(expanded(eval::read_text_file(file), values, file.string())));
  }
  EXPECT_GE(examples, 1u);
}

// Inverse poses of the body, T_b_w: the camera is at T_w_c = T_b_w^-1 T_b_c.
TEST(ExternalOutput, IsReadAsPosesOfTheCamera) {
  const TemporaryFolder folder;
  folder.write("poses.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  ExternalSystem system;
  system.trajectory = "poses.txt";
  system.inverse = true;
  system.poses = PosedFrame::kBody;
  datasets::SequenceInfo info;
  info.rig.T_b_c.p = {0, 0.5, 0};
  const SystemTrajectory output = read_output(system, folder.path(), info);
  ASSERT_EQ(output.trajectory.poses.size(), 2u);
  EXPECT_EQ(output.trajectory.poses[1].T_w_f.p, Eigen::Vector3d(-1, 0.5, 0));
  EXPECT_NE(output.text.find("-1.000000000 0.500000000"), std::string::npos) << output.text;
}

TEST(ExternalRun, MessagesOfAFailureAreText) {
  const TemporaryFolder folder;
  const ExternalRun run(parse_external_system("name = \"s\"\ncommand = [\"s\"]\n", "s.toml"));
  RunRequest request;
  request.work = folder.path();
  ProcessResult process;
  process.exit_code = 3;
  process.messages = "loading\n10 %\rnot found: \xFC\n";  // Latin-1
  const RunOutcome outcome = run.outcome(request, process);
  EXPECT_EQ(outcome.detail, "exited with code 3: 10 % not found: \\xfc");
  process.messages.clear();
  EXPECT_EQ(run.outcome(request, process).detail, "exited with code 3");
}

TEST(ExternalDescription, NamesTheFormatsOfACalibration) {
  const std::string begin = "name = \"s\"\ncommand = [\"s\", \"{calibration}\"]\n";
  EXPECT_NO_THROW(
      static_cast<void>(parse_external_system(begin + "calibration_format = \"vins\"\n", "s.toml")));
  expect_bad_description(begin + "calibration_format = \"openvin\"",
                         {"s.toml:3: ", "\"openvin\"", "kalibr", "calibration_template"});
}

/// Times that a system with these keys wrote to a file; without a file it printed them.
std::vector<ModuleCost> module_times(const std::string& keys, const std::string& file,
                                     const std::string& text) {
  const TemporaryFolder folder;
  if (!file.empty()) folder.write(file, text);
  ProcessResult process;
  process.messages = text;
  return read_module_times(parse_external_system("name = \"s\"\ncommand = [\"s\"]\n" + keys, "s.toml"),
                           folder.path(), process);
}

void expect_bad_times(const std::string& keys, const std::string& file, const std::string& text,
                      const std::vector<std::string>& parts) {
  expect_input_error([&] { static_cast<void>(module_times(keys, file, text)); }, parts);
}

TEST(ExternalTimes, OfJsonAreListsOrStatistics) {
  const std::string keys = "timings = \"t.json\"\n";
  EXPECT_TRUE(module_times("", "", "").empty());
  const std::vector<ModuleCost> costs =
      module_times(keys, "t.json",
                   R"({"timings": {"modules": {"track": [1, 2, 6]}, "threads": {"all": {"calls": 2,
                      "mean": 3.5, "median": 3.5, "p95": 4, "max": 4}}}})");
  ASSERT_EQ(costs.size(), 2u);
  EXPECT_EQ(costs[0].module + " per " + costs[0].per, "track per call");
  EXPECT_EQ(costs[0].calls, 3);
  EXPECT_EQ(costs[0].mean_ms, 3.0);
  EXPECT_EQ(costs[0].median_ms, 2.0);
  EXPECT_EQ(costs[0].max_ms, 6.0);
  EXPECT_EQ(costs[1].module + " per " + costs[1].per, "all per frame");
  EXPECT_EQ(costs[1].mean_ms, 3.5);
  EXPECT_EQ(module_times(keys, "t.json", R"({"modules": {"track": [1], "loop": []}})").size(), 1u);
  expect_bad_times(keys, "t.json", R"({"modules": {"track": {"mean": 3, "calls": 1}}})",
                   {"t.json: modules.track", "\"median\"", "a list of milliseconds"});
  expect_bad_times(keys, "t.json", R"({"modules": {"track": [1, "2"]}})",
                   {"modules.track", "\"2\"", "number"});
  expect_bad_times(keys, "t.json", R"({"modules": {"track": [-1]}})", {"modules.track", "-1 is no time"});
  expect_bad_times(keys, "t.json", R"({"track": [1]})", {"t.json", "\"modules\"", "[timing]"});
  expect_bad_times(keys, "t.json", "track 3.1\n", {"t.json", "is no JSON", "[timing]"});
  expect_bad_times(keys, "", "", {"t.json", "was not written", "timings"});
}

TEST(ExternalTimes, OfCsvAreColumns) {
  const std::string keys = "timings = \"t.csv\"\n";
  const std::vector<ModuleCost> costs = module_times(keys, "t.csv",
                                                     "\xEF\xBB\xBF"
                                                     "frame,track_ms,map_ms\r\n0,1.5,\r\n1,2.5,8\r\n");
  ASSERT_EQ(costs.size(), 2u);
  EXPECT_EQ(costs[0].module, "map");
  EXPECT_EQ(costs[0].calls, 1);
  EXPECT_EQ(costs[1].module, "track");
  EXPECT_EQ(costs[1].mean_ms, 2.0);
  EXPECT_TRUE(module_times(keys, "t.csv", "frame,track_ms\n").empty());
  const std::string table = keys + "timing_unit = \"s\"\n[timing]\nupdate = \"msckf update\"\n";
  const std::vector<ModuleCost> of_seconds =
      module_times(table, "t.csv", "# timestamp (sec),tracking,msckf update\n1.0,0.1,0.002\n");
  ASSERT_EQ(of_seconds.size(), 1u);
  EXPECT_EQ(of_seconds[0].module, "update");
  EXPECT_DOUBLE_EQ(of_seconds[0].max_ms, 2.0);
  expect_bad_times(keys, "t.csv", "frame;track\n0;1\n", {"t.csv:1", "\"_ms\"", "frame, track", "[timing]"});
  expect_bad_times(table, "t.csv", "t,update\n0,1\n", {"t.csv:1", "\"msckf update\" of timing.update"});
  expect_bad_times(keys, "t.csv", "f;a_ms\n0;1,5\n", {"t.csv:2", "\"1,5\"", "decimal point"});
  expect_bad_times(keys, "t.csv", "f,a_ms\n0,1\n1\n", {"t.csv:3", "1 cells", "whole rows"});
}

TEST(ExternalTimes, OfLinesAreGroupsOfAPattern) {
  const std::string table = "[timing]\ntrack = 'track(?:ing)?: ([0-9.eE-]+) us'\n";
  const std::string lines = "frame 0 tracking: 1500 us\nloop\nframe 1 track: 500 us, map 9 ms\n";
  for (const char* const file : {"", "log.txt"}) {
    const std::string timings = *file == '\0' ? "" : "timings = \"log.txt\"\n";
    const std::vector<ModuleCost> costs =
        module_times(timings + "timing_unit = \"us\"\n" + table, file, lines);
    ASSERT_EQ(costs.size(), 1u);
    EXPECT_EQ(costs[0].module, "track");
    EXPECT_EQ(costs[0].calls, 2);
    EXPECT_DOUBLE_EQ(costs[0].mean_ms, 1.0);
  }
  expect_bad_times(table, "", "Tracking: 3 us\n",
                   {"messages of the program", "timing.track", "case-sensitive"});
  expect_bad_times("[timing]\ntrack = 'track (.*) ms'\n", "", "track 1,5 ms\n",
                   {"messages of the program:1: timing.track", "\"1,5\""});
  const std::string begin = "name = \"s\"\ncommand = [\"s\"]\n";
  expect_bad_description(begin + "[timing]\na = 'no group'", {"s.toml:4: ", "timing.a", "one group"});
  expect_bad_description(begin + "[timing]\na = '(open'", {"s.toml:4: ", "timing.a", "regular expression"});
  expect_bad_description(begin + "timing_unit = \"s\"", {"s.toml: ", "timing_unit", "[timing]"});
}

TEST(ExternalRun, StartsItsProgramInAContainer) {
  const TemporaryFolder folder;
  const std::string text =
      "name = \"s\"\nlayout = \"as_is\"\nrunner = \"podman\"\nimage = \"s:1\"\nrunner_options = "
      "[\"--pids-limit=9\"]\n"
      "environment = [\"A=1\"]\ncommand = [\"/slam\", \"{sequence}\"]\n";
  const ExternalRun run(parse_external_system(text, (folder.path() / "s.toml").string()));
  EXPECT_TRUE(run.is_contained());
  RunRequest request;
  request.sequence = folder.path() / "office";
  request.work = folder.path() / "out";
  request.time_limit_s = 9.5;
  request.memory_limit_mb = 300;
  const ProcessSpec spec = run.command(request);
  const std::string here = folder.path().string();
  EXPECT_EQ(spec.program, "podman");
  EXPECT_EQ(spec.arguments, (std::vector<std::string>{"run", "--network=none", "--workdir=" + here + "/out",
                                                      "--volume=" + here + "/office:" + here + "/office:ro",
                                                      "--volume=" + here + ":" + here + ":ro",
                                                      "--volume=" + here + "/out:" + here + "/out",
                                                      "--env=A=1", "--rm", "--memory=300m", "--timeout=10",
                                                      "--pids-limit=9", "s:1", "/slam", here + "/office"}));
  expect_bad_description("name = \"s\"\ncommand = [\"s\"]\nrunner = \"docker\"", {"s.toml: ", "no image"});
  expect_bad_description("name = \"s\"\ncommand = [\"s\"]\nimage = \"a\"", {"s.toml: ", "no runner"});
  const std::string contained = "name = \"s\"\nrunner = \"podman\"\nimage = \"a\"\n";
  expect_bad_description(contained + "command = [\"{bin}/s\"]", {"s.toml:4: ", "{bin}", "image"});
  expect_bad_description(contained + "command = [\"s\"]\n[source]\nbinary = \"s\"",
                         {"s.toml:6: ", "[source]", "image"});
}

TEST(ExternalOutput, MatricesHaveTheStampsOfTheFrames) {
  const TemporaryFolder folder;
  folder.write("poses.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n1 0 0 8 0 1 0 0 0 0 1 0\n");
  ExternalSystem system;
  system.trajectory = "poses.txt";
  system.trajectory_format = OutputFormat::kKitti;
  datasets::SequenceInfo info;
  info.frame_times = {{.ns = 5'000'000'000}, {.ns = 6'000'000'000}};
  const Trajectory read = read_output(system, folder.path(), info).trajectory;
  ASSERT_EQ(read.poses.size(), 2u);
  EXPECT_EQ(read.poses[1].t.ns, 6'000'000'000);
  EXPECT_EQ(read.poses[1].T_w_f.p.x(), 8.0);
}

/// A plan with a system that has the parameter "n". @param keys lines before [rendered]
PlanMatrix system_plan(const TemporaryFolder& folder, const std::string& keys,
                       const std::string& tables = "") {
  const std::string system =
      folder
          .write("s.toml",
                 "name = \"s\"\nversion = \"3\"\ncommand = [\"s\", \"{param.n}\"]\n[param]\nn = 1\n")
          .string();
  return expand_plan(
      load_plan(folder
                    .write("plan.toml", "systems = [\"" + system + "\"]\n" + keys +
                                            "[rendered]\nsequences = [\"walking_xyz\"]\n" + tables)
                    .string()),
      "build", {});
}

TEST(ExternalSystemInPlan, IsFoundRelativeToThePlan) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "c+x/plans");
  folder.write("c+x/s.toml", "name = \"s\"\ncommand = [\"s\"]\n[variant.few]\n[param]\n");
  folder.write("c+x/plans/t.toml", "name = \"t\"\ncommand = [\"t\"]\n");
  const auto plan = folder.write(
      "c+x/plans/plan.toml",
      "systems = [\"../s.toml\", \"t.toml\", \"orb_pnp\"]\n[rendered]\nsequences = [\"walking_xyz\"]\n");
  const PlanMatrix matrix = expand_plan(load_plan(plan.string()), "build", {});
  ASSERT_EQ(matrix.systems.size(), 3u);
  EXPECT_EQ(matrix.systems[0].variant, "s");
  EXPECT_EQ(matrix.systems[1].variant, "t");
}

TEST(ExternalSystemInPlan, OfNoFolderNamesBothPlaces) {
  const TemporaryFolder folder;
  const auto plan = folder.write("plan.toml", "systems = [\"none.toml\"]\n");
  expect_input_error([&] { static_cast<void>(load_plan(plan.string())); },
                     {"plan.toml:1", "none.toml", "folder of the plan"});
}

TEST(ExternalSystemInPlan, HasRunsAtThePointsOfItsParameters) {
  const TemporaryFolder folder;
  const PlanMatrix matrix = system_plan(folder, "variants = [\"vo\"]\n", "[sweep]\nparam.n = [1, 2]\n");
  ASSERT_EQ(matrix.runs.size(), 2u);  // vo has no parameter n
  EXPECT_EQ(matrix.runs[1].identity.system, "s");
  EXPECT_EQ(matrix.runs[1].identity.axis, "param.n");
  EXPECT_EQ(matrix.runs[1].identity.axis_value, 2.0);
  EXPECT_EQ(matrix.runs[1].identity.build, "3");
}

TEST(ExternalSystemInPlan, RejectsTheSweepOfAParameterThatNoSystemHas) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(system_plan(folder, "", "[sweep]\nparam.m = [1]\n")); },
                     {"plan.toml:5: ", "parameter \"m\"", "[param]"});
}

TEST(ExternalSystemInPlan, HasARunForEachFault) {
  const TemporaryFolder folder;
  const PlanMatrix matrix = system_plan(folder, "faults = [\"none\", \"blank:start=1\"]\nmax_frames = 30\n");
  ASSERT_EQ(matrix.runs.size(), 2u);
  EXPECT_EQ(matrix.runs[1].identity.sequence, "walking_xyz + blank:start=1");
  EXPECT_EQ(matrix.runs[1].fault.substr(0, 5), "blank");
  EXPECT_EQ(matrix.runs[1].max_frames, 30);
  EXPECT_NE(matrix.runs[0].identity.sequence_id, matrix.runs[1].identity.sequence_id);
}

// Frames that arrive late, and recorded boxes, are not in an exported sequence.
TEST(ExternalSystemInPlan, RejectsAFaultThatWouldNotReachIt) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(system_plan(folder, "faults = [\"frame_late\"]\n")); },
                     {"plan.toml:2: ", "frame_late", "exported"});
}

TEST(ExternalSystemInPlan, RejectsAFaultOfRecordedFiles) {
  const TemporaryFolder folder;
  const std::string system =
      folder.write("as_is.toml", "name = \"s\"\ncommand = [\"s\"]\nlayout = \"as_is\"\n").string();
  const std::string plan = "systems = [\"" + system + "\"]\nfaults = [\"blank\"]\n";
  expect_input_error([&] { static_cast<void>(load_plan(folder.write("plan.toml", plan).string())); },
                     {"plan.toml:2: ", "as_is", "\"tum\""});
}

}  // namespace
}  // namespace stillpoint::bench
