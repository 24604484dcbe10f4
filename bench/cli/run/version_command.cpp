// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/record/run_environment.h"

namespace stillpoint::bench {
namespace {

/// Version and commit, then what the build depends on: what a report of an error needs.
int print_version() {
  const BuildInfo& build = build_info();
  std::cout << fmt::format("stillpoint {} ({}{}{})\n", build.version, build.git_commit,
                           build.git_dirty ? "+" : "", build.git_changes)
            << fmt::format("{:<12} {}, {}, {}\n", "compiler", build.compiler, build.build_type, build.flags);
  for (const auto& [library, version] : build.packages)
    std::cout << fmt::format("{:<12} {}\n", library, version);
  return kExitOk;
}

}  // namespace

Command version_command() {
  return {.name = "version",
          .summary = "Print version, commit, compiler with its instruction set, and libraries",
          .example = "version",
          .action = print_version};
}

}  // namespace stillpoint::bench
