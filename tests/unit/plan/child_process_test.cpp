// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/child_process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "bench/profile/meters/process_usage.h"
#include "eval/io/text_reader.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

ProcessSpec shell(const std::string& script) { return {.program = "sh", .arguments = {"-c", script}}; }

TEST(ChildProcess, ReportsExitCodeAndMessages) {
  const ProcessResult end = run_process(shell("echo first >&2; echo last words >&2; exit 5"));
  EXPECT_EQ(end.exit_code, 5);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(last_line(end.messages), "last words");
}

TEST(ChildProcess, ReportsTheTerminatingSignal) {
  EXPECT_EQ(run_process(shell("kill -ABRT $$")).signal, SIGABRT);
}

TEST(ChildProcess, ReportsAProgramThatCannotBeStarted) {
  const ProcessResult end = run_process({.program = "no_such_program"});
  EXPECT_EQ(end.exit_code, 127);
  EXPECT_EQ(last_line(end.messages), "cannot be started");
}

TEST(ProcessPool, KillsAProgramThatIgnoresTheRequestToStop) {
  const TemporaryFolder folder;
  const std::filesystem::path ready = folder.path() / "ready";
  ProcessPool pool([&ready] { return std::filesystem::exists(ready); }, std::chrono::milliseconds(200));
  pool.start(7, shell("trap '' TERM; : >'" + ready.string() + "'; sleep 20; sleep 20"));
  const auto end = pool.wait_next();
  ASSERT_TRUE(end);
  EXPECT_EQ(end->second.signal, SIGKILL);
  EXPECT_LT(end->second.wall_s, 15.0);
}

TEST(ChildProcess, LeavesNoFileOpenWithoutDescriptorsForItsPipes) {
  std::vector<int> unused;
  for (int file = 0; unused.size() < 4; ++file) {
    if (fcntl(file, F_GETFD) < 0) unused.push_back(file);
  }
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit three{.rlim_cur = static_cast<rlim_t>(unused[3]), .rlim_max = before.rlim_max};  // of four
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &three), 0);
  EXPECT_THROW(run_process(shell("true")), std::system_error);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  for (const int file : unused) EXPECT_LT(fcntl(file, F_GETFD), 0) << file;
}

TEST(ChildProcess, PassesOnlyTheGivenEnvironment) {
  ProcessSpec spec = shell("echo \"$COLOUR$HOME\" >&2");
  spec.environment = {"COLOUR=red", "PATH=/usr/bin:/bin"};
  EXPECT_EQ(last_line(run_process(spec).messages), "red");
}

/// Launchers such as roslaunch start their programs in sessions of their own.
TEST(ChildProcess, EndsDescendantsInOtherSessionsWithIt) {
  const TemporaryFolder folder;
  const std::string pid_file = (folder.path() / "pid").string();
  const auto is_running = [&pid_file] {
    const std::string pid = eval::read_text_file(pid_file);
    std::ifstream status("/proc/" + pid.substr(0, pid.find('\n')) + "/environ");
    return status.get() !=
           std::ifstream::traits_type::eof();  // of a process that has ended: missing or empty
  };
  ProcessSpec spec = shell("setsid sh -c 'echo $$ >" + pid_file + "; exec sleep 60' & while ! test -s " +
                           pid_file + "; do sleep 0.01; done");
  spec.environment = {"PATH=/usr/bin:/bin"};
  EXPECT_EQ(run_process(spec).exit_code, 0);
  for (int i = 0; is_running() && i < 100; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(is_running());
  spec.arguments.back() += "; sleep 60";
  spec.time_limit_s = 0.5;
  EXPECT_TRUE(run_process(spec).timed_out);
  for (int i = 0; is_running() && i < 100; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(is_running());
}

TEST(ChildProcess, StartsInTheGivenFolder) {
  ProcessSpec spec = shell("pwd >&2");
  spec.folder = "/usr";
  EXPECT_EQ(last_line(run_process(spec).messages), "/usr");
  spec.folder = "/no/such/folder";
  EXPECT_EQ(run_process(spec).exit_code, 127);
}

TEST(ChildProcess, FixedAddressesMakeTheMemoryLayoutReproducible) {
  ProcessSpec spec = shell("read -r map </proc/self/maps; echo \"$map\" >&2");
  spec.fixed_addresses = true;
  EXPECT_EQ(run_process(spec).messages, run_process(spec).messages);
}

TEST(ChildProcess, KillsAProcessAtItsTimeLimit) {
  ProcessSpec spec = shell("exec tail -f /dev/null");
  spec.time_limit_s = 0.05;
  const ProcessResult end = run_process(spec);
  EXPECT_TRUE(end.timed_out);
  EXPECT_EQ(end.signal, SIGKILL);
  EXPECT_GE(end.wall_s, 0.05);
}

// The pipe never becomes empty: reading until then would not return.
TEST(ChildProcess, KillsAtItsTimeLimitAProcessThatPrintsWithoutEnd) {
  ProcessSpec spec = shell("exec yes >&2");
  spec.time_limit_s = 0.05;
  const ProcessResult end = run_process(spec);
  EXPECT_TRUE(end.timed_out);
  EXPECT_FALSE(end.too_many_messages);
}

TEST(ChildProcess, KillsAProcessAtItsMessageLimit) {
  ProcessSpec spec = shell("exec yes");
  spec.output_in_messages = true;
  spec.message_limit_bytes = 100'000;
  spec.time_limit_s = 60.0;
  const ProcessResult end = run_process(spec);
  EXPECT_TRUE(end.too_many_messages);
  EXPECT_FALSE(end.timed_out);
  EXPECT_EQ(last_line(end.messages.substr(0, 4)), "y");
}

// 16 MB of a child of the shell, which itself is smaller.
TEST(ChildProcess, MemoryLimitCountsDescendants) {
  ProcessSpec spec =
      shell("awk 'BEGIN { s = \"x\"; while (length(s) < 16000000) s = s s; while (1) n = length(s) }'; :");
  spec.memory_limit_bytes = 8'000'000;
  spec.time_limit_s = 20.0;
  const ProcessResult end = run_process(spec);
  EXPECT_TRUE(end.out_of_memory);
  EXPECT_FALSE(end.timed_out);
}

TEST(ChildProcess, MeasuresProcessorTimeAndMemory) {
  const ProcessResult end = run_process(shell("i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done"));
  EXPECT_GT(end.user_s + end.system_s, 0.0);
  EXPECT_GT(end.peak_memory_bytes.value(), 100'000);
}

/// The kernel counts the copy that fork makes of this process.
TEST(ChildProcess, MemoryIsThatOfTheChildAndNotOfThisProcess) {
  std::vector<char> large(300'000'000, 'x');
  const ProcessResult small = run_process({.program = "/bin/sleep", .arguments = {"0.5"}});
  EXPECT_LT(small.peak_memory_bytes.value(), 50'000'000);
  EXPECT_GT(small.peak_memory_bytes.value(), 100'000);
  int measured = 0;
  for (int i = 0; i < 10; ++i) {  // too short for a measurement at a fixed interval of 50 ms
    const ProcessResult brief = run_process({.program = "/bin/sleep", .arguments = {"0.02"}});
    EXPECT_LT(brief.peak_memory_bytes.value_or(0), 50'000'000);
    measured += brief.peak_memory_bytes.has_value() ? 1 : 0;
  }
  EXPECT_GT(measured, 0);  // each of them, but for a busy machine
  const ProcessResult script = run_process(
      shell("awk 'BEGIN { s = \"x\"; while (length(s) < 60000000) s = s s; system(\"sleep 0.3\") }'; :"));
  EXPECT_GT(script.peak_memory_bytes.value(), 60'000'000);
  EXPECT_LT(script.peak_memory_bytes.value(), 290'000'000);
  EXPECT_EQ(large.back(), 'x');
}

TEST(ProcessPool, ReturnsEveryResultWithItsTag) {
  ProcessPool pool({});
  for (std::size_t tag = 0; tag < 3; ++tag) pool.start(tag, shell("exit " + std::to_string(tag)));
  for (int i = 0; i < 3; ++i) {
    const auto ended = pool.wait_next();
    ASSERT_TRUE(ended);
    EXPECT_EQ(static_cast<std::size_t>(ended->second.exit_code), ended->first);
  }
  EXPECT_FALSE(pool.wait_next());
}

TEST(ProcessPool, TerminatesItsChildrenOnRequest) {
  ProcessPool pool([] { return true; });
  pool.start(0, shell("exec tail -f /dev/null"));
  EXPECT_EQ(pool.wait_next()->second.signal, SIGTERM);
}

// As compilers below a build tool, which has them in process groups of their own.
TEST(ProcessPool, TerminatesTheDescendantsOfItsChildrenOnRequest) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "pid";
  const auto is_written = [&] { return std::filesystem::exists(file); };
  ProcessPool pool(is_written);
  pool.start(0, shell("setsid sh -c 'echo $$ >" + file.string() + ".new; mv " + file.string() + ".new " +
                      file.string() + "; exec sleep 60' & wait"));
  EXPECT_EQ(pool.wait_next()->second.signal, SIGTERM);
  pid_t descendant = 0;
  std::ifstream(file) >> descendant;
  ASSERT_GT(descendant, 0);
  int left = 100;  // a killed process is listed until its new parent has waited for it
  const auto runs = [&] {
    std::ifstream stat("/proc/" + std::to_string(descendant) + "/stat");
    std::string number, name, state;
    return stat >> number >> name >> state && state != "Z";
  };
  while (runs() && --left > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GT(left, 0) << "the descendant still runs";
  if (left == 0) kill(descendant, SIGKILL);
}

TEST(MachineLoad, CountsAllColumnsButIdleAndIowaitAsBusy) {
  // user 10, nice 1, system 5, idle 100, iowait 20, irq 2, softirq 3, steal 4; guest time is within user.
  const MachineLoad load = parse_machine_load("cpu  10 1 5 100 20 2 3 4 7 0\ncpu0 ...");
  EXPECT_EQ(load.busy, 25);
  EXPECT_EQ(load.total, 145);
}

TEST(MachineLoad, DetectsLoadFromOtherProcesses) {
  const std::vector<Metric> metrics = load_metrics({.busy = 0, .total = 0}, {.busy = 60, .total = 200},
                                                   0.1);  // 10 ticks of the process itself
  ASSERT_EQ(metrics.size(), 2u);
  EXPECT_NEAR(metrics[0].value, 0.25, 1e-12);
  EXPECT_EQ(metrics[1].value, 0.0);
}

}  // namespace
}  // namespace stillpoint::bench
