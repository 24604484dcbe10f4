// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint systems`: a program of each kind that does not work is named in one line with a remedy. The
// programs are scripts that read the ground truth of the exported sequence.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "datasets/synthetic/sequence/request_rig.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Writes the true pose of each image, changed as KIND says: awk -v KIND=... rgb.txt groundtruth.txt.
constexpr const char* kReplay = R"AWK(
function times(ax, ay, az, aw, bx, by, bz, bw) {
  qx = aw * bx + ax * bw + ay * bz - az * by
  qy = aw * by - ax * bz + ay * bw + az * bx
  qz = aw * bz + ax * by - ay * bx + az * bw
  qw = aw * bw - ax * bx - ay * by - az * bz
}
function rotate(ax, ay, az, aw, x, y, z) {
  times(ax, ay, az, aw, x, y, z, 0)
  times(qx, qy, qz, qw, -ax, -ay, -az, aw)
  rx = qx; ry = qy; rz = qz
}
BEGIN { i = 0; n = 0 }
/^#/ { next }
FILENAME ~ /rgb.txt$/ { stamp[n++] = $1; next }
i < n && $1 + 0.003 > stamp[i] {
  t = stamp[i]; x = $2; y = $3; z = $4; ax = $5; ay = $6; az = $7; aw = $8
  if (KIND == "inverse") {
    rotate(-ax, -ay, -az, aw, -x, -y, -z); x = rx; y = ry; z = rz; ax = -ax; ay = -ay; az = -az
  }
  if (KIND == "body") {
    split(T, c, " ")
    rotate(ax, ay, az, aw, c[1], c[2], c[3]); x += rx; y += ry; z += rz
    times(ax, ay, az, aw, c[4], c[5], c[6], c[7]); ax = qx; ay = qy; az = qz; aw = qw
  }
  if (KIND == "scale") { x *= 3; y *= 3; z *= 3 }
  if (KIND == "offset") t = sprintf("%.6f", t + 0.1)
  if (KIND == "index") t = i
  if (KIND == "nanoseconds") t = sprintf("%.0f", t * 1e9)
  if (KIND == "nan" && i % 10 == 5) x = "nan"
  if (KIND == "wrong") { x = sin(i); y = cos(2 * i); z = i % 7 }
  if (KIND == "turning") {
    x = cos(i / 20); y = sin(i / 20); z = 0; ax = 0; ay = 0; az = sin(i / 40); aw = cos(i / 40)
  }
  if (KIND == "resting") {
    x = 0.02 * sin(i / 100); y = 0.02 * cos(i / 100); z = 0.02 * sin(i / 33)
    ax = 0.6 * sin(i / 100); ay = 0.5 * cos(i / 100); az = 0.4 * sin(i / 50); aw = sqrt(1 - ax * ax - ay * ay - az * az)
  }
  if (KIND != "slow" || i % 3 == 0) printf "%s %s %s %s %.9f %.9f %.9f %.9f\n", t, x, y, z, ax, ay, az, aw
  i++
}
END { if (KIND == "half") printf "%s 0.1 0.", t }
)AWK";

/// A description whose program is a script.
struct FakeSystem {
  TemporaryFolder folder;

  /// @param script lines of sh; $1 is the sequence, $2 the output folder
  FakeSystem(const std::string& script, const std::string& keys = "") {
    folder.write("sys/replay.awk", kReplay);
    folder.write("sys/fake.sh", script);
    folder.write("sys/fake.toml", "name = \"fake\"\n" + keys +
                                      "command = [\"sh\", \"{here}/fake.sh\", \"{sequence}\", \"{out}\"]\n");
  }

  [[nodiscard]] ProgramResult check(const std::vector<std::string>& options = {},
                                    const std::vector<std::string>& environment = {}) const {
    std::vector<std::string> arguments = {"systems", "check", (folder.path() / "sys/fake.toml").string(),
                                          "--out", (folder.path() / "check").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments, {.environment = environment});
  }
};

/// A fake that replays the ground truth.
std::string replay(const std::string& kind) {
  Pose T_b_c = synth::realsense_T_b_c();  // axes of the body: x forward, y left, z up
  T_b_c = Pose{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()} * T_b_c;
  const Pose T_c_b = T_b_c.inverse();
  std::string numbers;
  for (const double number :
       {T_c_b.p.x(), T_c_b.p.y(), T_c_b.p.z(), T_c_b.q.x(), T_c_b.q.y(), T_c_b.q.z(), T_c_b.q.w()})
    numbers += std::to_string(number) + " ";
  return "awk -v KIND=" + kind + " -v T=\"" + numbers +
         "\" -f \"$(dirname \"$0\")/replay.awk\" \"$1/rgb.txt\" \"$1/groundtruth.txt\" "
         ">\"$2/trajectory.tum\"\n";
}

void expect_finding(const ProgramResult& result, const std::vector<std::string>& parts) {
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  const std::string line = result.out.substr(0, result.out.find('\n'));
  EXPECT_TRUE(line.starts_with("fake: ")) << line;
  for (const std::string& part : parts) EXPECT_NE(line.find(part), std::string::npos) << part << "\n" << line;
  EXPECT_LE(std::ranges::count(result.out, '\n'), 2);
}

TEST(SystemsCheck, AcceptsASystemThatWorks) {
  const ProgramResult result = FakeSystem("echo started\n" + replay("good")).check();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_TRUE(result.out.starts_with("fake: ok: 90 poses for 90 images")) << result.out;
}

TEST(SystemsCheck, KeepsTheMessagesOfTheProgram) {
  const FakeSystem fake("echo to stdout\necho to stderr >&2\n" + replay("good"));
  const ProgramResult result = fake.check();
  std::ifstream log(fake.folder.path() / "check/program.log");
  const std::string text{std::istreambuf_iterator<char>(log), {}};
  EXPECT_EQ(text, "to stdout\nto stderr\n");
  EXPECT_NE(result.out.find("program.log"), std::string::npos) << result.out;
}

TEST(SystemsCheck, AcceptsTheConventionsThatADescriptionStates) {
  EXPECT_EQ(FakeSystem(replay("inverse"), "inverse = true\n").check().exit_code, 0);
  EXPECT_EQ(FakeSystem(replay("body"), "poses = \"body\"\n").check().exit_code, 0);
  EXPECT_EQ(FakeSystem(replay("scale"), "scale = \"unknown\"\n").check().exit_code, 0);
}

TEST(SystemsCheck, AChangedSequenceIsExportedAnew) {
  const TemporaryFolder cache;
  const std::vector<std::string> environment = {"XDG_CACHE_HOME=" + cache.path().string()};
  const FakeSystem harmful(replay("good") + "sed -i '20,$d' \"$1/rgb.txt\"\nrm \"$1/imu.txt\"\n");
  expect_finding(harmful.check({}, environment),
                 {"wrote outside of its folder", "rgb.txt", "write to {out} only"});
  const ProgramResult result =
      FakeSystem("test -e \"$1/imu.txt\" || exit 1\n" + replay("good")).check({}, environment);
  EXPECT_TRUE(result.out.starts_with("fake: ok: 90 poses for 90 images")) << result.out;
}

TEST(SystemsCheck, NamesAProgramThatIsNotFound) {
  const FakeSystem fake("");
  fake.folder.write("sys/fake.toml", "name = \"fake\"\ncommand = [\"./no_such\"]\n");
  expect_finding(fake.check(), {"no_such is not found", "command"});
}

TEST(SystemsCheck, NamesAProgramThatExitsNonZero) {
  expect_finding(FakeSystem("echo vocabulary missing >&2\nexit 3\n").check(),
                 {"exited with code 3: vocabulary missing", "command"});
}

TEST(SystemsCheck, NamesAProgramThatIsTerminatedByASignal) {
  expect_finding(FakeSystem("kill -SEGV $$\n").check(), {"terminated by signal 11", "debugger"});
}

TEST(SystemsCheck, NamesAProgramThatWritesNothing) {
  expect_finding(FakeSystem("exit 0\n").check(), {"wrote no trajectory.tum", "no other file"});
  expect_finding(FakeSystem(replay("good") + "mv \"$2/trajectory.tum\" \"$2/poses.txt\"\n").check(),
                 {"wrote no trajectory.tum", "poses.txt; set trajectory"});
  expect_finding(FakeSystem(": >\"$2/trajectory.tum\"\n").check(), {"trajectory.tum has no poses"});
  expect_finding(FakeSystem("mkdir \"$2/trajectory.tum\"\n").check(), {"is a folder"});
  expect_finding(FakeSystem("echo ERROR: no vocabulary\n").check(),
                 {"it printed last: ERROR: no vocabulary"});
  expect_finding(FakeSystem("cat config.yaml\n").check(), {"No such file", "{here}/FILE"});
}

TEST(SystemsCheck, NamesEqualOrientations) {
  const std::string constant =
      "awk '{ print $1, $2, $3, $4, 0, 0, 0, 1 }' \"$2/trajectory.tum\" >\"$2/t\"\n"
      "mv \"$2/t\" \"$2/trajectory.tum\"\n";
  expect_finding(FakeSystem(replay("good") + constant).check(),
                 {"all orientations of the estimate are equal", "write the orientation"});
}

TEST(SystemsCheck, NamesHalfALine) {
  expect_finding(FakeSystem(replay("half")).check(), {"last line", "3 of 8 values", "close the file"});
}

TEST(SystemsCheck, NamesNaN) {
  expect_finding(FakeSystem(replay("nan")).check(), {"9 of 90 rows", "NaN", "write no row"});
}

TEST(SystemsCheck, NamesInversePoses) {
  expect_finding(FakeSystem(replay("inverse")).check(), {"inverted", "set inverse = true"});
}

TEST(SystemsCheck, NamesPosesOfTheBody) {
  expect_finding(FakeSystem(replay("body")).check(), {"body (IMU)", "set poses = \"body\""});
}

TEST(SystemsCheck, NamesAScale) {
  expect_finding(FakeSystem(replay("scale")).check(), {"2.998 times as large", "scale = \"unknown\""});
}

TEST(SystemsCheck, NamesALowRate) {
  expect_finding(FakeSystem(replay("slow")).check(), {"poses at 10 Hz for images at 30 Hz", "each image"});
}

TEST(SystemsCheck, NamesWrongStamps) {
  expect_finding(FakeSystem(replay("offset")).check(), {"time offset of -0.1", "stamps of the images"});
  expect_finding(FakeSystem(replay("index")).check(), {"do not overlap in time", "stamps of the images"});
  expect_finding(FakeSystem(replay("nanoseconds")).check(), {"stamp", "set trajectory_format = \"euroc\""});
  EXPECT_EQ(FakeSystem(replay("nanoseconds"), "trajectory_format = \"euroc\"\n").check().exit_code, 0)
      << "qx first, as the separator is a blank";
}

TEST(SystemsCheck, NamesPosesThatDoNotFollowTheMotion) {
  // The last two look like inverse poses and like poses of the body.
  for (const char* kind : {"wrong", "turning", "resting"})
    expect_finding(FakeSystem(replay(kind)).check(), {"do not follow the motion", "calibration"});
}

TEST(SystemsCheck, NamesAProgramThatHangs) {
  expect_finding(FakeSystem("exec tail -f /dev/null\n").check({"--time-limit", "0.5"}),
                 {"did not end within 0.5 s", "--time-limit"});
}

// The memory is that of a child of the shell.
TEST(SystemsCheck, NamesAProgramThatEatsMemory) {
  const ProgramResult result =
      FakeSystem("awk 'BEGIN { s = \"x\"; while (length(s) < 5e8) s = s s; while (1) n = length(s) }'\n:\n")
          .check({"--memory-limit", "100", "--time-limit", "30"});
  expect_finding(result, {"more than 100 MB of memory", "--memory-limit"});
}

TEST(SystemsCheck, NamesAProgramThatPrintsWithoutEnd) {
  expect_finding(FakeSystem("exec yes\n").check(), {"printed more than 16 MB", "reduce"});
}

TEST(SystemsCheck, NamesAProgramThatNeedsADisplay) {
  expect_finding(FakeSystem("echo 'qt.qpa.xcb: could not connect to display' >&2\nkill -ABRT $$\n").check(),
                 {"needs a display", "xvfb-run"});
  expect_finding(FakeSystem("[ -n \"$DISPLAY\" ] || { echo 'cannot open display:' >&2; exit 1; }\n").check(),
                 {"needs a display", "xvfb-run"});
}

TEST(SystemsCheck, NamesAProgramThatWritesOutsideOfItsFolder) {
  expect_finding(FakeSystem(replay("good") + "echo 1 >\"$2/../stray.txt\"\n").check(),
                 {"wrote outside of its folder: ", "stray.txt", "{out}"});
  expect_finding(FakeSystem(replay("good") + "echo 1 >\"$(dirname \"$0\")/map.bin\"\n").check(), {"map.bin"});
  // In a folder of all programs, it writes a file each time.
  for (const char* name : {"slam_state", "slam_$$.map"}) {
    const TemporaryFolder shared;
    const FakeSystem fake(replay("good") + "date +%N >\"$TMPDIR/" + name + "\"\n");
    expect_finding(fake.check({}, {"TMPDIR=" + shared.path().string()}), {"/slam_"});
  }
  const TemporaryFolder cleaned;  // as by a compiler, whose files end while the system runs
  for (const char* name : {"cc1.s", "cc2.s"}) cleaned.write(name, "");
  const FakeSystem fake(replay("good") + "rm \"$(ls \"$TMPDIR\"/cc* | head -1)\"\n");
  const ProgramResult removed = fake.check({}, {"TMPDIR=" + cleaned.path().string()});
  EXPECT_EQ(removed.exit_code, 0) << removed.out;
}

TEST(SystemsCommand, NewWritesADescriptionThatCheckReads) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "my_slam.toml").string();
  EXPECT_EQ(run_program({"systems", "new", "my_slam", "--out", file}).exit_code, 0);
  const ProgramResult result =
      run_program({"systems", "check", file, "--out", (folder.path() / "c").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("my_slam: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("is not found"), std::string::npos) << result.out;
  EXPECT_EQ(run_program({"systems", "new", "my_slam", "--out", file}).exit_code, 2);  // is not overwritten
}

TEST(SystemsCommand, ListNamesProgramsThatAreNotFound) {
  const FakeSystem fake("");
  const std::string file = (fake.folder.path() / "sys/fake.toml").string();
  EXPECT_NE(run_program({"systems", "list", "--file", file}).out.find("/sh"), std::string::npos);
  fake.folder.write("sys/fake.toml", "name = \"fake\"\ncommand = [\"./no_such\"]\n");
  EXPECT_NE(run_program({"systems", "list", "--file", file}).out.find("not found: ./no_such"),
            std::string::npos);
}

TEST(SystemsCommand, ConfigDiffComparesDescriptionsAndParameterSets) {
  const TemporaryFolder folder;
  const std::string file =
      folder
          .write("slam.toml",
                 "name = \"slam\"\ncommand = [\"cat\", \"{param.corners}\"]\nlayout = \"euroc\"\n"
                 "[param]\ncorners = 500\n[variant.few]\ncorners = 100\n")
          .string();
  const std::string other = folder.write("other.toml", "name = \"other\"\ncommand = [\"cat\"]\n").string();
  EXPECT_EQ(run_program({"config", "diff", file, file + "+few"}).out, "param.corners = 500 -> 100\n");
  const ProgramResult result = run_program({"config", "diff", file, other});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("layout = \"euroc\" -> \"tum\"\n"), std::string::npos) << result.out;
  EXPECT_EQ(run_program({"config", "diff", "orb_pnp", "orb_pnp"}).out, "");
  const ProgramResult mixed = run_program({"config", "diff", file, "vo"});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_NE(mixed.err.find("no description of a system"), std::string::npos) << mixed.err;
  EXPECT_EQ(run_program({"config", "diff", file, file + "+fex"}).exit_code, 2);
}

}  // namespace
}  // namespace stillpoint
