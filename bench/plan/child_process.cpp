// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/child_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace stillpoint {
namespace {

constexpr const char* kSelf = "/proc/self/exe";
constexpr int kExecFailed = 127;

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// Becomes the program with stderr in the pipe and stdout nowhere; calls only what is safe after fork.
[[noreturn]] void become_self(char* const* arguments, int message_pipe) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(message_pipe, STDERR_FILENO);
  execv(kSelf, arguments);
  _exit(kExecFailed);
}

/// Everything the child says until it ends.
std::string read_messages(int pipe, pid_t child, const std::function<bool()>& stop_requested) {
  std::string text;
  std::array<char, 4096> block{};
  while (true) {
    const ssize_t got = read(pipe, block.data(), block.size());
    if (got > 0) text.append(block.data(), static_cast<std::size_t>(got));
    if (got == 0 || (got < 0 && errno != EINTR)) return text;
    if (got < 0 && stop_requested && stop_requested()) kill(child, SIGTERM);
  }
}

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t newline = text.rfind('\n');
  return newline == std::string::npos ? text : text.substr(newline + 1);
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw_errno("waitpid");
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

ChildResult run_self(const std::vector<std::string>& arguments, const std::function<bool()>& stop_requested) {
  std::vector<std::string> words = {"stillpoint"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_errno("pipe");
  const pid_t child = fork();
  if (child < 0) throw_errno("fork");
  if (child == 0) become_self(pointers.data(), ends[1]);
  close(ends[1]);
  const std::string messages = read_messages(ends[0], child, stop_requested);
  close(ends[0]);
  return {.exit_code = wait_for(child), .last_message = last_line(messages)};
}

}  // namespace stillpoint
