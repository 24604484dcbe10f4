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
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
}

[[noreturn]] void become_program(std::vector<std::string> words, const ProgramOptions& options,
                                 const std::string& out_file, int err_pipe) {
  dup2(open(out_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(err_pipe, STDERR_FILENO);
  for (std::string setting : options.environment) {
    const std::size_t equals = setting.find('=');
    setenv(setting.substr(0, equals).c_str(), setting.substr(equals + 1).c_str(), 1);
  }
  if (options.may_only_read && geteuid() == 0 && setuid(kNobody) != 0) _exit(127);
  if (options.file_limit_bytes) limit_files(*options.file_limit_bytes);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(kProgram, pointers.data());
  _exit(127);
}

/// Reads until the child closes its end; interrupts it on the way if so asked.
std::string read_err(int pipe, pid_t child, const std::string& interrupt_after) {
  std::string text;
  bool interrupted = interrupt_after.empty();
  std::array<char, 4096> block{};
  for (ssize_t got = 0; (got = read(pipe, block.data(), block.size())) > 0;) {
    text.append(block.data(), static_cast<std::size_t>(got));
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
  std::vector<std::string> words = {"stillpoint"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  // A small pipe holds a talkative program back, so that it cannot end before its interrupt is sent.
  fcntl(ends[1], F_SETPIPE_SZ, kPipeBytes);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_program(words, options, out_file, ends[1]);
  close(ends[1]);
  ProgramResult result;
  result.err = read_err(ends[0], child, options.interrupt_after);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  result.out = text_of(out_file);
  return result;
}

}  // namespace stillpoint
