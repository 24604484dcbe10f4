// SPDX-License-Identifier: BSD-3-Clause
// Descriptions of external systems, their placeholders, and their runs in plans.
#include "bench/systems/external_system.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include "bench/plan/plan_matrix.h"
#include "bench/systems/external_run.h"
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
