// SPDX-License-Identifier: BSD-3-Clause
/// The file of `bench --hosts`: machines that execute tasks of a plan over ssh.
///
/// One host per line; "#" begins a comment. The host is a name that ssh resolves, `NAME` or `USER@NAME`;
/// port, keys and aliases belong into the configuration of ssh. Optional words follow, in any order:
///   program=/PATH  this program on the host; by default the path of the calling program
///   package=/FILE  a build for that host, on this machine, which is copied to it: a root file system
///   (.tar.zst,
///                  scripts/image.sh) or, for hosts with its libraries, a Debian package (.deb)
///   class=NAME     machine class; timing runs are executed on hosts of one class only
///   tasks=N        concurrent tasks, 1 to 1000; by default 1
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::bench {

struct Host {
  std::string name;
  std::string program;  ///< absolute path; not used if there is a package
  std::string package;  ///< absolute path on this machine, or empty
  std::string machine_class;
  int tasks = 1;
};

/// @param place name of the text in messages
/// @param program default of `Host::program`
/// @throws InputError with the line of the first error, for a repeated host, or if there is no host
[[nodiscard]] std::vector<Host> parse_hosts(std::string_view text, const std::string& place,
                                            const std::filesystem::path& program);

/// Whether a text can be the name of a host or of a machine class: letters, digits and `_ . -`, the first one
/// a letter or digit.
[[nodiscard]] bool is_host_word(std::string_view text);

}  // namespace stillpoint::bench
