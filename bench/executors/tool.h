// SPDX-License-Identifier: BSD-3-Clause
/// Programs of the system that the executors call: sbatch, squeue, ssh, rsync, parallel.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct ToolResult {
  int exit_code = 0;  ///< 128 + signal number if terminated by a signal
  std::string output;
  std::string messages;  ///< the last line of stderr
};

/// A call of a program by its argument vector; no shell reads the arguments.
struct ToolCall {
  std::string program;  ///< searched in PATH
  std::vector<std::string> arguments;
  std::function<bool()> stop_requested = {};  ///< on true the program gets SIGTERM
};

/// @throws InputError if the program is not installed
[[nodiscard]] ToolResult call_tool(const ToolCall& call);

/// As `call_tool`. @return its output
/// @throws InputError if it does not exit with 0
std::string require_tool(const ToolCall& call);

/// Whether a word has the same meaning in every shell: letters, digits and `_ . / + , = @ : -`, without a
/// dash at the beginning. GNU parallel and sshd give their commands to a shell; all words of them are
/// checked.
[[nodiscard]] bool is_plain_word(const std::string& word);

}  // namespace stillpoint::bench
