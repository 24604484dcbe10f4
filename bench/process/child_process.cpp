// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

namespace stillpoint::bench {
namespace {

constexpr int kExecFailed = 127;
constexpr std::size_t kMaxMessageBytes = 65'536;
constexpr std::int64_t kMaxBytesPerPoll = std::int64_t{1} << 20;  // a child may print faster than it is read
constexpr std::int64_t kForkTolerance = std::int64_t{1} << 21;    // pages that fork itself touches
constexpr std::int64_t kSmallestProcess = 200'000;  // bytes; less is measured while exec replaces the memory
// Memory is measured after 1, 2, 4, ... ms, so that short processes are measured as well, and at least as
// often as:
constexpr std::chrono::milliseconds kLongestInterval{100};
constexpr int kExitPollIntervalMs = 2;  // a child that closed stderr is about to exit

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

cpu_set_t processor_set(const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(static_cast<std::size_t>(core), &set);
  return set;
}

/// Argument vector for exec: pointers into `words`, null-terminated. `words` must outlive it.
std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Data that the child needs after fork, prepared before it: only async-signal-safe calls are allowed then.
struct Launch {
  const char* program;
  char* const* arguments;
  char* const* environment;
  const char* folder;  ///< null = inherited
  const char* output;  ///< file that receives stdout; null = the message pipe
  int message_pipe;
  pid_t parent;
  bool pinned;
  cpu_set_t processors;
  bool fixed_addresses;
};

/// Executes the program with stderr redirected to the pipe and stdout to a file.
[[noreturn]] void exec_child(const Launch& launch) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  signal(SIGXFSZ, SIG_DFL);                            // this program ignores it, see bench/cli/main.cpp
  if (getppid() != launch.parent) _exit(kExecFailed);  // the parent died before prctl
  if (launch.pinned) sched_setaffinity(0, sizeof launch.processors, &launch.processors);
  dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
  dup2(launch.output == nullptr ? launch.message_pipe
                                : open(launch.output, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666),
       STDOUT_FILENO);
  dup2(launch.message_pipe, STDERR_FILENO);
  if (launch.folder == nullptr || chdir(launch.folder) == 0) {
    if (launch.fixed_addresses) personality(ADDR_NO_RANDOMIZE);
    execvpe(launch.program, launch.arguments, launch.environment);
  }
  constexpr char kMessage[] = "cannot be started\n";
  static_cast<void>(!write(STDERR_FILENO, kMessage, sizeof kMessage - 1));
  _exit(kExecFailed);
}

/// The processes that the threads of a process have started and that are still running; none if the kernel
/// does not list them.
std::vector<pid_t> children_of(pid_t pid) {
  std::vector<pid_t> children;
  std::error_code ended;
  const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
  for (std::filesystem::directory_iterator task(tasks, ended), end; !ended && task != end;
       task.increment(ended)) {
    std::ifstream file(task->path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

/// A process and its descendants, itself first: a system may be started by a script.
std::vector<pid_t> family_of(pid_t pid) {
  std::vector<pid_t> family = {pid};
  for (std::size_t i = 0; i < family.size(); ++i) {
    const std::vector<pid_t> children = children_of(family[i]);
    family.insert(family.end(), children.begin(), children.end());
  }
  return family;
}

/// Of one process.
std::int64_t resident_bytes(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::int64_t total_pages = 0;
  std::int64_t resident_pages = 0;
  file >> total_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

/// Largest resident size of one process since it was executed; 0 if it has ended.
std::int64_t peak_resident_bytes(pid_t pid) {
  constexpr std::string_view kField = "VmHWM:";
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(kField)) return std::strtoll(line.c_str() + kField.size(), nullptr, 10) * 1024;
  }
  return 0;
}

/// Unlike that of any other child.
std::string next_mark() {
  static std::atomic<int> count{0};
  return "STILLPOINT_PROCESS=" + std::to_string(getpid()) + "." + std::to_string(++count);
}

/// Kills the processes whose environment contains `mark`: launchers such as roslaunch start theirs in
/// sessions of their own, which a signal to the process group does not reach.
/// @return whether there were any
bool kill_marked(const std::string& mark) {
  bool any = false;
  std::error_code ended;
  for (std::filesystem::directory_iterator entry("/proc", ended), end; !ended && entry != end;
       entry.increment(ended)) {
    const pid_t process = std::atoi(entry->path().filename().c_str());
    if (process <= 0) continue;
    std::ifstream file(entry->path() / "environ", std::ios::binary);
    for (std::string variable; std::getline(file, variable, '\0');) {
      if (variable != mark) continue;
      any = kill(process, SIGKILL) == 0 || any;
      break;
    }
  }
  return any;
}

/// Two pipes that exec closes; reading does not block.
std::array<std::array<int, 2>, 2> make_pipes() {
  std::array<std::array<int, 2>, 2> pipes{};
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    if (pipe2(pipes[i].data(), O_CLOEXEC) != 0) {
      const int error = errno;
      if (i > 0) std::ranges::for_each(pipes[0], close);
      errno = error;
      throw_errno("pipe");
    }
    fcntl(pipes[i][0], F_SETFL, O_NONBLOCK);
  }
  return pipes;
}

double cpu_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

std::filesystem::path executable_path() {
  const std::filesystem::path executable = std::filesystem::read_symlink("/proc/self/exe");
  const char* const launcher = std::getenv("STILLPOINT_LAUNCHER");
  const bool is_loader = executable.filename().string().starts_with("ld-linux");
  return is_loader && launcher != nullptr ? launcher : executable;
}

std::vector<int> allowed_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<int> processors;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(static_cast<std::size_t>(i), &set)) processors.push_back(i);
  }
  return processors;
}

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t newline = text.rfind('\n');
  return newline == std::string::npos ? text : text.substr(newline + 1);
}

ChildProcess::ChildProcess(const ProcessSpec& spec) : spec_(spec), start_(std::chrono::steady_clock::now()) {
  std::vector<std::string> words = {spec.program.filename().string()};
  words.insert(words.end(), spec.arguments.begin(), spec.arguments.end());
  const std::vector<char*> arguments = pointers_to(words);
  std::vector<std::string> settings = spec.environment.value_or(std::vector<std::string>{});
  if (spec.environment) settings.push_back(mark_ = next_mark());
  const std::vector<char*> environment = pointers_to(settings);

  const auto [ends, execution] = make_pipes();
  const Launch launch{.program = spec.program.c_str(),
                      .arguments = arguments.data(),
                      .environment = spec.environment ? environment.data() : environ,
                      .folder = spec.folder.empty() ? nullptr : spec.folder.c_str(),
                      .output = spec.output_in_messages ? nullptr
                                : spec.output.empty()   ? "/dev/null"
                                                        : spec.output.c_str(),
                      .message_pipe = ends[1],
                      .parent = getpid(),
                      .pinned = !spec.cores.empty(),
                      .processors = processor_set(spec.cores),
                      .fixed_addresses = spec.fixed_addresses};
  resident_at_fork_ = resident_bytes(getpid());
  pid_ = fork();
  if (pid_ == 0) exec_child(launch);
  close(ends[1]);
  close(execution[1]);
  pipe_ = ends[0];
  execution_pipe_ = execution[0];
  if (pid_ < 0) {
    close(pipe_);
    close(execution_pipe_);
    throw_errno("fork");
  }
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill_family();
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  close_pipe();
  if (execution_pipe_ >= 0) close(execution_pipe_);
}

void ChildProcess::read_messages() {
  std::array<char, 4096> block{};
  const std::int64_t end = message_bytes_ + kMaxBytesPerPoll;
  while (pipe_ >= 0 && message_bytes_ < end) {
    const ssize_t got = read(pipe_, block.data(), block.size());
    if (got > 0) {
      result_.messages.append(block.data(), static_cast<std::size_t>(got));
      message_bytes_ += got;
    }
    if (got == 0) close_pipe();
    if (got < 0 && errno != EINTR) break;
  }
  if (result_.messages.size() > 2 * kMaxMessageBytes) {
    result_.messages.erase(0, result_.messages.size() - kMaxMessageBytes);
    result_.messages_incomplete = true;
  }
}

void ChildProcess::close_pipe() {
  if (pipe_ >= 0) close(pipe_);
  pipe_ = -1;
}

bool ChildProcess::has_exited() const {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == pid_;
}

void ChildProcess::measure_memory() {
  const auto now = std::chrono::steady_clock::now();
  if (now - std::max(measured_, start_) < interval_) return;  // a child that prints is polled more often
  measured_ = now;
  if (!is_executed()) return;
  interval_ = std::min(2 * interval_, kLongestInterval);
  resident_ = 0;
  for (const pid_t process : family_of(pid_)) {
    resident_ += resident_bytes(process);
    const std::int64_t peak = peak_resident_bytes(process);
    if (peak < kSmallestProcess) continue;
    if (process == pid_) peak_ = peak;  // replaced: of the program executed last
    if (process != pid_) peak_of_descendants_ = std::max(peak_of_descendants_, peak);
  }
}

bool ChildProcess::is_executed() {
  char byte = 0;
  if (execution_pipe_ >= 0 && read(execution_pipe_, &byte, 1) == 0) {
    close(execution_pipe_);
    execution_pipe_ = -1;
  }
  return execution_pipe_ < 0;
}

std::optional<std::int64_t> ChildProcess::peak_memory_bytes(std::int64_t counted_by_kernel) const {
  if (counted_by_kernel > resident_at_fork_ + kForkTolerance) return counted_by_kernel;
  const std::int64_t measured = std::max(peak_, peak_of_descendants_);
  if (measured == 0) return std::nullopt;
  return std::min(measured, counted_by_kernel);
}

void ChildProcess::enforce_limits() {
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const bool late = spec_.time_limit_s && elapsed_s > *spec_.time_limit_s;
  const bool large = spec_.memory_limit_bytes && resident_ > *spec_.memory_limit_bytes;
  const bool loud = spec_.message_limit_bytes && message_bytes_ > *spec_.message_limit_bytes;
  const bool is_killed = result_.timed_out || result_.out_of_memory || result_.too_many_messages;
  if ((!late && !large && !loud) || is_killed) return;
  result_.timed_out = late;
  result_.out_of_memory = large && !late;
  result_.too_many_messages = loud && !large && !late;
  kill_family();
}

bool ChildProcess::poll_once() {
  read_messages();
  if (has_exited()) return false;
  measure_memory();
  enforce_limits();
  return true;
}

int ChildProcess::poll_timeout_ms() const {
  if (pipe_ < 0) return kExitPollIntervalMs;
  return static_cast<int>(interval_.count());
}

// A build tool starts compilers in process groups of their own, and a shell does not pass signals on.
void ChildProcess::terminate() const {
  for (const pid_t process : family_of(pid_)) kill(process, SIGTERM);
}

void ChildProcess::kill_family() const {
  kill(-pid_, SIGKILL);
  kill(pid_, SIGKILL);  // its process group may not exist yet
  kill_descendants();
}

void ChildProcess::kill_descendants() const {
  constexpr int kMaxRounds = 10;  // they may start others until they are killed
  for (int round = 0; !mark_.empty() && round < kMaxRounds && kill_marked(mark_); ++round) {
  }
}

ProcessResult ChildProcess::wait() {
  int status = 0;
  rusage usage{};
  while (wait4(pid_, &status, 0, &usage) < 0) {
    if (errno != EINTR) throw_errno("wait4");
  }
  result_.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  read_messages();
  kill(-pid_, SIGKILL);  // its remaining children
  kill_descendants();
  pid_ = -1;
  result_.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  result_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  result_.user_s = cpu_seconds(usage.ru_utime);
  result_.system_s = cpu_seconds(usage.ru_stime);
  result_.peak_memory_bytes = peak_memory_bytes(std::int64_t{usage.ru_maxrss} * 1024);
  return result_;
}

ProcessResult run_process(const ProcessSpec& spec) {
  ChildProcess child(spec);
  while (child.poll_once()) {
    pollfd waited{.fd = child.message_pipe(), .events = POLLIN, .revents = 0};
    poll(&waited, 1, child.poll_timeout_ms());
  }
  return child.wait();
}

void ProcessPool::start(std::size_t tag, const ProcessSpec& spec) {
  children_.push_back({tag, std::make_unique<ChildProcess>(spec)});
}

void ProcessPool::forward_stop() {
  if (!stop_requested_ || !stop_requested_()) return;
  const auto now = std::chrono::steady_clock::now();
  const bool is_first = !stopped_;
  if (is_first) stopped_ = now;
  for (const Entry& entry : children_) {
    if (is_first) entry.child->terminate();
    if (now - *stopped_ >= grace_) entry.child->kill_family();
  }
}

void ProcessPool::wait_for_messages() const {
  std::vector<pollfd> descriptors;
  int poll_timeout_ms = children_.front().child->poll_timeout_ms();
  for (const Entry& entry : children_) {
    descriptors.push_back({.fd = entry.child->message_pipe(), .events = POLLIN, .revents = 0});
    poll_timeout_ms = std::min(poll_timeout_ms, entry.child->poll_timeout_ms());
  }
  poll(descriptors.data(), descriptors.size(), poll_timeout_ms);
}

std::optional<std::pair<std::size_t, ProcessResult>> ProcessPool::wait_next(
    const std::function<bool()>& wake) {
  while (!children_.empty()) {
    forward_stop();
    for (auto entry = children_.begin(); entry != children_.end(); ++entry) {
      if (entry->child->poll_once()) continue;
      const std::size_t tag = entry->tag;
      const ProcessResult result = entry->child->wait();
      children_.erase(entry);
      return std::pair{tag, result};
    }
    if (wake && wake()) return std::nullopt;
    wait_for_messages();
  }
  return std::nullopt;
}

}  // namespace stillpoint::bench
