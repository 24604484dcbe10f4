// SPDX-License-Identifier: BSD-3-Clause
/// Other machines that execute tasks of a plan: their list, the package of this program that is copied to
/// those which lack it, and the programs that reach them: sbatch, squeue, ssh, rsync, parallel.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

/// Result of a program of the system.
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

/// A machine that executes tasks of a plan over ssh.
struct Host {
  std::string name;
  std::string program;  ///< absolute path; not used if there is a package
  std::string package;  ///< absolute path on this machine, or empty
  std::string machine_class;
  int tasks = 1;
};

/// Parses the file of `bench --hosts`: one host per line; "#" begins a comment. The host is a name that ssh
/// resolves, `NAME` or `USER@NAME`; port, keys and aliases belong into the configuration of ssh. Optional
/// words follow, in any order:
///   program=/PATH  this program on the host; by default the path of the calling program
///   package=/FILE  a build for that host, on this machine, which is copied to it: a root file system
///                  (.tar.zst, scripts/image.sh) or, for hosts with its libraries, a Debian package (.deb)
///   class=NAME     machine class; timing runs are executed on hosts of one class only
///   tasks=N        concurrent tasks, 1 to 1000; by default 1
/// @param place name of the text in messages
/// @param program default of `Host::program`
/// @throws InputError with the line of the first error, for a repeated host, or if there is no host
[[nodiscard]] std::vector<Host> parse_hosts(std::string_view text, const std::string& place,
                                            const std::filesystem::path& program);

/// Whether a text can be the name of a host or of a machine class: letters, digits and `_ . -`, the first one
/// a letter or digit.
[[nodiscard]] bool is_host_word(std::string_view text);

/// A build of this program that is copied to hosts which lack it.
struct HostPackage {
  std::filesystem::path tree;  ///< the extracted files, on this machine
  std::string name;            ///< 16 digits that identify the content
  std::string program;         ///< path in the tree
};

/// Extracts a package below a folder, unless that was done before.
/// @param file a Debian package (.deb, scripts/package.sh), whose program requires the libraries that the
/// package depends on; or a root file system (.tar.zst, scripts/image.sh), which contains them, so that the
/// system of the host does not matter
/// @throws InputError if the file is neither, cannot be extracted, or lacks the program
[[nodiscard]] HostPackage extract_package(const std::filesystem::path& file,
                                          const std::filesystem::path& folder,
                                          const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
