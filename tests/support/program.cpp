// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/program.h"

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

constexpr int kPipeBytes = 4096;
constexpr uid_t kNobody = 65534;
constexpr const char* kProgram = STILLPOINT_BINARY_DIR "/stillpoint";

void limit_files(std::uint64_t bytes) {
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
}

[[noreturn]] void exec_program(std::vector<std::string> arguments, const ProgramOptions& options,
                               const std::string& out_file, int err_pipe) {
  const std::string& out = options.out_file.empty() ? out_file : options.out_file;
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(err_pipe, STDERR_FILENO);
  setenv("STILLPOINT_CACHE_SIZE", "0", 0);  // tests leave nothing in the user's cache
  for (std::string setting : options.environment) {
    const std::size_t equals = setting.find('=');
    setenv(setting.substr(0, equals).c_str(), setting.substr(equals + 1).c_str(), 1);
  }
  if (options.without_write_access && geteuid() == 0 && setuid(kNobody) != 0) _exit(127);
  if (options.file_limit_bytes) limit_files(*options.file_limit_bytes);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  execv(kProgram, pointers.data());
  _exit(127);
}

/// Reads stderr until the child closes it. Sends SIGINT once when the output contains `interrupt_after`.
std::string read_err(int pipe, pid_t child, const std::string& interrupt_after) {
  std::string text;
  bool interrupted = interrupt_after.empty();
  std::array<char, 4096> block{};
  for (ssize_t count = 0; (count = read(pipe, block.data(), block.size())) > 0;) {
    text.append(block.data(), static_cast<std::size_t>(count));
    if (interrupted || text.find(interrupt_after) == std::string::npos) continue;
    kill(child, SIGINT);
    interrupted = true;
  }
  return text;
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& arguments, const ProgramOptions& options) {
  const TemporaryFolder folder;
  const std::string out_file = (folder.path() / "out").string();
  std::vector<std::string> argv = {"stillpoint"};
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  // A small pipe blocks a verbose program, so that it cannot finish before the interrupt is sent.
  fcntl(pipe_ends[1], F_SETPIPE_SZ, kPipeBytes);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) exec_program(std::move(argv), options, out_file, pipe_ends[1]);
  close(pipe_ends[1]);
  ProgramResult result;
  result.err = read_err(pipe_ends[0], child, options.interrupt_after);
  close(pipe_ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  result.out = text_of(out_file);
  return result;
}

}  // namespace stillpoint
